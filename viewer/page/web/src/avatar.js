// A character that follows the session's joints.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { VRMLoaderPlugin } from '@pixiv/three-vrm';
import { lit } from './stage.js';
import { multiplyInto } from './wire.js';

const kClay = [0.62, 0.53, 0.46];
const kInside = 0.002; // of a hull, as exactly as it was sent [m]
const kLayers = { firstPerson: 9, thirdPerson: 10 }; // those of three-vrm

/// A skin whose triangles have the colours of parts: as the window mixes them, with the colour of clay.
function makePartsMaterial() {
  const material = lit(new THREE.MeshStandardMaterial({ roughness: 0.6 })),
    before = material.onBeforeCompile;
  material.onBeforeCompile = (shader) => {
    before(shader);
    const declared = '#include <common>\nflat varying vec3 ofPart;';
    shader.vertexShader = shader.vertexShader
      .replace('#include <common>', `${declared} attribute vec3 partColor;`)
      .replace('#include <begin_vertex>', '#include <begin_vertex>\nofPart = partColor;');
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', declared)
      .replace('#include <color_fragment>', 'diffuseColor.rgb = ofPart;');
  };
  return material;
}

/// The part that a point of the skin belongs to: of those that it is in, the one whose surface it is nearest to, since it
/// lies deep in neighbours that it is not of.
function partAt({ x, y, z }, parts) {
  let best = null,
    least = Infinity;
  for (const part of parts) {
    const { planes } = part;
    let out = -Infinity;
    for (let i = 0; i < planes.length && out < least; i += 4)
      out = Math.max(out, planes[i] * x + planes[i + 1] * y + planes[i + 2] * z + planes[i + 3]);
    const away = out < kInside ? Math.abs(out) : out + 10;
    if (away < least) [best, least] = [part, away];
  }
  return best;
}

function disposeOf(root) {
  root.traverse((object) => {
    object.geometry?.dispose();
    object.skeleton?.dispose();
    for (const material of [object.material ?? []].flat()) {
      for (const value of Object.values(material.uniforms ?? {})) if (value?.value?.isTexture) value.value.dispose();
      for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
      material.dispose();
    }
  });
}

export class Avatar {
  root = new THREE.Group();
  loaded = false;
  present = false;
  center = new THREE.Vector3(0, 0.95, 0); // of its joints
  box = new THREE.Box3();
  head = new THREE.Matrix4(); // world from model of the head joint; that of the first joint without a head
  vrm = null;
  #joints = []; // [object, joint, bind]
  #followers = []; // [object, parent]: nodes that no joint moves, parents first
  #bones = []; // pairs of objects
  #materials = [];
  #opacity = 1;
  #last = null; // pose from before the file was there
  #headless = null; // geometry with and without the head, of characters that are no VRM
  #weights = [];
  #shown = true;
  painted = 0; // number of parts that its skin has the colours of
  #meshes = []; // and their own materials
  #parts = makePartsMaterial();
  #byParts = false;
  #nodes = []; // by their number in the file
  #played = null; // of a mesh in several poses: { geometry, first, targets, weights }
  #scene = null;

  constructor(hello) {
    this.hello = hello;
    this.root.updateMatrixWorld = () => {}; // pose() sets all matrices
  }

  /// @param fetchBytes  async (path) => ArrayBuffer
  async load(fetchBytes) {
    const loader = new GLTFLoader();
    loader.register((parser) => new VRMLoaderPlugin(parser));
    const gltf = await loader.parseAsync(await fetchBytes(this.hello.character), '');
    if (this.disposed) return disposeOf(gltf.scene);
    this.vrm = gltf.userData.vrm ?? null;
    this.#nodes = await Promise.all((gltf.parser.json.nodes ?? []).map((_, i) => gltf.parser.getDependency('node', i)));
    this.#scene = gltf.scene;
    this.#adopt(!gltf.parser.json.materials);
    this.root.add(gltf.scene);
    this.loaded = true;
    if (this.#last) this.pose(this.#last);
    this.face(this.#weights);
  }

  #adopt(unpainted) {
    const driven = new Map([[this.#scene, null]]),
      needed = new Set();
    this.hello.joints.forEach(({ node, bind }, joint) => {
      const object = node >= 0 ? this.#nodes[node] : bind && this.#scene;
      if (object && bind) driven.set(object, [object, joint, bind]);
    });
    this.#joints = [...driven.values()].filter(Boolean);
    this.#scene.traverse((object) => {
      object.matrixAutoUpdate = object.matrixWorldAutoUpdate = false;
      object.frustumCulled = false;
      if (object.isMesh) this.#adoptMesh(object, unpainted);
      if (object.isBone || (object.isMesh && !object.isSkinnedMesh))
        for (let o = object; o && !needed.has(o); o = o.parent) needed.add(o);
      if (object.isSkinnedMesh) {
        // its vertices are placed by the bones alone
        object.matrixWorld.identity();
        object.bindMatrixInverse.identity();
        object.bindMode = THREE.DetachedBindMode;
      }
    });
    this.#followers = [];
    this.#scene.matrixWorld.identity();
    this.#scene.traverse((object) => {
      if (!needed.has(object) || driven.has(object) || object.isSkinnedMesh) return;
      object.updateMatrix();
      this.#followers.push([object, object.parent]);
    });
    this.#bones = this.#joints.flatMap(([object]) => {
      let above = object.parent;
      while (above && !driven.get(above)) above = above.parent;
      return above && above !== this.#scene && object !== this.#scene ? [[above, object]] : [];
    });
  }

  #adoptMesh(mesh, unpainted) {
    if (this.hello.plain && !mesh.geometry.attributes.normal) {
      // glTF means flat faces then; a mannequin is round
      mesh.geometry.computeVertexNormals();
      mesh.material.flatShading = false;
    }
    if (unpainted) {
      mesh.material.dispose();
      mesh.material = new THREE.MeshStandardMaterial({ color: new THREE.Color(...kClay), roughness: 0.6 });
    }
    const { position: targets } = mesh.geometry.morphAttributes;
    if (this.hello.played && targets) {
      // few of very many have weight: blended here, not by the GPU
      const { geometry } = mesh;
      this.#played = {
        geometry,
        first: geometry.attributes.position.array.slice(),
        targets: targets.map((t) => t.array),
        weights: targets.map(() => 0),
      };
      delete geometry.morphAttributes.position;
      mesh.morphTargetInfluences = mesh.morphTargetDictionary = undefined;
    }
    if (!this.#meshes.some((m) => m.mesh === mesh)) {
      const targets = []; // of each morph target, the expression that is named after it
      for (const [name, target] of Object.entries(mesh.morphTargetDictionary ?? {}))
        targets[target] = this.hello.expressions.indexOf(name);
      this.#meshes.push({ mesh, material: mesh.material, targets });
    }
    const materials = [mesh.material, this.#parts].flat();
    mesh.castShadow = true;
    mesh.receiveShadow = !materials.some((material) => material.isMToonMaterial);
    for (const material of materials) {
      if (this.#materials.some((m) => m.material === material)) continue;
      this.#materials.push({ material, transparent: material.transparent, opacity: material.opacity });
      if (material !== this.#parts) lit(material);
      material.toneMapped = material.isMeshStandardMaterial === true;
    }
  }

  /// @param pose  of FrameReader; what is kept of it is copied
  pose(pose) {
    if (!this.loaded) {
      this.#last = { ...pose, worldFromModel: pose.worldFromModel.slice() };
      return;
    }
    this.present = pose.present;
    this.root.visible = this.present && this.#shown;
    if (!pose.present) return;
    this.box.makeEmpty();
    for (const [object, joint, bind] of this.#joints) {
      if (joint >= pose.joints) continue;
      const m = object.matrixWorld.elements;
      multiplyInto(m, pose.worldFromModel, 12 * joint, bind);
      if (object === this.#scene && this.#joints.length > 1) continue;
      this.box.expandByPoint(point.set(m[12], m[13], m[14]));
    }
    if (this.#played) this.#deform(pose);
    for (const [object, parent] of this.#followers)
      object.matrixWorld.multiplyMatrices(parent.matrixWorld, object.matrix);
    this.box.getCenter(this.center);
    const head = Math.max(this.hello.head, 0);
    if (head < pose.joints) multiplyInto(this.head.elements, pose.worldFromModel, 12 * head, kUnit);
    if (pose.opacity !== this.#opacity) this.#fade(pose.opacity);
  }

  #deform({ joints, worldFromModel: m }) {
    const { geometry, first, targets, weights } = this.#played;
    const scale = (joint) => Math.hypot(m[12 * joint], m[12 * joint + 4], m[12 * joint + 8]);
    let changed = false;
    for (let t = 0; t < weights.length && t + 1 < joints; ++t) {
      const weight = scale(t + 1) / scale(0) - 1;
      if (Math.abs(weight - weights[t]) < 1e-4) continue;
      weights[t] = Math.abs(weight) < 1e-4 ? 0 : weight;
      changed = true;
    }
    if (!changed) return;
    const { array } = geometry.attributes.position;
    array.set(first);
    targets.forEach((target, t) => {
      if (weights[t] !== 0) for (let i = 0; i < array.length; ++i) array[i] += weights[t] * target[i];
    });
    geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
  }

  /// @param take  gets the place of each joint
  eachJoint(take) {
    for (const [object] of this.#joints)
      if (object !== this.#scene || this.#joints.length === 1) take(point.setFromMatrixPosition(object.matrixWorld));
  }

  show(shown) {
    this.#shown = shown;
    this.root.visible = this.present && shown;
  }

  /// Gives each vertex the colour of the hull that it is in now. Both have to be of one frame.
  paint(parts) {
    if (!this.loaded || !this.present || parts.length === 0) return;
    for (const { mesh } of this.#meshes) {
      const count = mesh.geometry.attributes.position.count,
        colors = new Float32Array(3 * count);
      for (let i = 0; i < count; ++i) {
        mesh.getVertexPosition(i, point);
        if (!mesh.isSkinnedMesh) point.applyMatrix4(mesh.matrixWorld);
        const { color } = partAt(point, parts);
        for (let k = 0; k < 3; ++k) colors[3 * i + k] = 0.22 * kClay[k] + 0.72 * color[k];
      }
      mesh.geometry.setAttribute('partColor', new THREE.BufferAttribute(colors, 3));
    }
    this.painted = parts.length;
    this.colorByParts(this.#byParts);
  }

  colorByParts(on) {
    this.#byParts = on;
    for (const { mesh, material } of this.#meshes) mesh.material = on && this.painted > 0 ? this.#parts : material;
  }

  #fade(opacity) {
    this.#opacity = opacity;
    for (const own of this.#materials) {
      own.material.transparent = own.transparent || opacity < 1;
      own.material.opacity = own.opacity * opacity;
      own.material.needsUpdate = true;
    }
  }

  face(weights) {
    this.#weights = weights;
    const manager = this.vrm?.expressionManager;
    const count = Math.min(weights.length, this.hello.expressions.length);
    if (manager) {
      for (let i = 0; i < count; ++i) manager.setValue(this.hello.expressions[i], weights[i]);
      manager.update();
    } else {
      for (const { mesh, targets } of this.#meshes)
        targets.forEach((i, target) => {
          if (i >= 0 && i < count) mesh.morphTargetInfluences[target] = weights[i];
        });
    }
  }

  /// Textures that move.
  advance(seconds) {
    for (const material of this.vrm?.materials ?? []) material.update?.(seconds);
  }

  /// Where the head joint is, and where the face looks along the ground.
  eye(out) {
    const object = this.#nodes[this.hello.joints[this.hello.head]?.node];
    if (object) out.setFromMatrixPosition(object.matrixWorld);
    else out.set(this.center.x, this.box.max.y, this.center.z);
    return out.addScaledVector(this.facing(point), 0.09).setY(out.y + 0.07);
  }

  facing(out) {
    out.setFromMatrixColumn(this.head, 2).setY(0);
    return out.lengthSq() > 1e-6 ? out.normalize() : out.set(0, 0, 1);
  }

  /// Two points a bone. @return how many numbers were written
  bones(out) {
    let at = 0;
    for (const pair of this.#bones)
      for (const { matrixWorld: m } of pair) {
        if (at + 3 > out.length) return at;
        out.set(m.elements.slice(12, 15), at);
        at += 3;
      }
    return at;
  }

  /// As its owner sees it, without a head in the way. Layers of the camera choose in VRM files; others leave faces out.
  wear(camera, on) {
    if (this.vrm?.firstPerson) {
      if (on) {
        this.vrm.firstPerson.setup(kLayers);
        this.#adopt(false);
        this.painted = 0; // its meshes are others
        this.colorByParts(this.#byParts);
      }
      camera.layers[on ? 'enable' : 'disable'](kLayers.firstPerson);
      camera.layers[on ? 'disable' : 'enable'](kLayers.thirdPerson);
      return;
    }
    if (on && !this.#headless) this.#headless = this.#meshesWithoutHead();
    for (const { mesh, whole, without } of this.#headless ?? []) mesh.geometry.setIndex(on ? without : whole);
  }

  #meshesWithoutHead() {
    const head = this.#nodes[this.hello.joints[this.hello.head]?.node],
      list = [];
    const onHead = (object) => {
      for (let o = object; o; o = o.parent) if (o === head) return true;
      return false;
    };
    this.#scene.traverse((mesh) => {
      const { index, attributes } = mesh.geometry ?? {};
      if (!head || !index) return;
      const hides = mesh.isSkinnedMesh ? mesh.skeleton.bones.map(onHead) : null;
      const hidden = (v) =>
        hides
          ? [0, 1, 2, 3].reduce(
              (sum, k) =>
                sum + (hides[attributes.skinIndex.getComponent(v, k)] ? attributes.skinWeight.getComponent(v, k) : 0),
              0,
            ) > 0.3
          : onHead(mesh);
      const kept = [];
      for (let t = 0; t + 2 < index.count; t += 3) {
        const face = [index.getX(t), index.getX(t + 1), index.getX(t + 2)];
        if (!face.some(hidden)) kept.push(...face);
      }
      list.push({ mesh, whole: index, without: new THREE.Uint32BufferAttribute(kept, 1) });
    });
    return list;
  }

  dispose() {
    this.disposed = true;
    this.root.removeFromParent();
    this.colorByParts(false);
    this.#parts.dispose();
    if (this.#scene) disposeOf(this.#scene);
  }
}

const point = new THREE.Vector3();
const kUnit = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
