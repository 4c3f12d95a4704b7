// Runs in the browser: draws one shot of one character and says where its joints and vertices are. Options: README.md.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { VRMLoaderPlugin, VRMUtils } from '@pixiv/three-vrm';

// A VRM 0.x file faces -Z and is turned by half a turn about Y. Rotations and movements are given for a figure that
// faces +Z, so in such a file's own axes x and z change sign.
const turned = (vrm) => vrm.meta?.metaVersion === '0';
const rotationInFile = (vrm, [x, y, z, w]) => (turned(vrm) ? [-x, y, -z, w] : [x, y, z, w]);
const translationInFile = (vrm, [x, y, z]) => (turned(vrm) ? [-x, y, -z] : [x, y, z]);

async function load(bytes, { metresPerUnit }) {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  const gltf = await loader.parseAsync(bytes.buffer.slice(0), '');
  const { vrm } = gltf.userData;
  if (vrm) VRMUtils.rotateVRM0(vrm);
  const nodes = await Promise.all((gltf.parser.json.nodes ?? []).map((_, i) => gltf.parser.getDependency('node', i)));
  const scene = new THREE.Scene();
  gltf.scene.scale.setScalar(metresPerUnit);
  scene.add(gltf.scene);
  scene.updateMatrixWorld(true);
  vrm?.springBoneManager?.reset(); // the tails were taken before the turn
  return { gltf, vrm, nodes, scene };
}

function setHumanoid({ vrm }, pose, hipsAtRest) {
  for (const [bone, q] of Object.entries(pose.rotations ?? {})) {
    const node = vrm.humanoid.getNormalizedBoneNode(bone);
    if (!node) throw new Error(`the character has no bone ${bone}`);
    node.quaternion.set(...rotationInFile(vrm, q)).normalize();
  }
  const hips = vrm.humanoid.getNormalizedBoneNode('hips');
  hips.position.fromArray(translationInFile(vrm, pose.hips ?? [0, 0, 0])).add(hipsAtRest);
}

/// The primitives of a node: the node itself if its mesh has one, else children that are no nodes of the file.
function meshesOf({ gltf }, node) {
  const { associations } = gltf.parser;
  const parts = node.isMesh ? [node] : node.children.filter((child) => child.isMesh && associations.get(child)?.nodes === undefined);
  return parts.sort((a, b) => associations.get(a).primitives - associations.get(b).primitives);
}

/// The pose of a still. Springs keep their rest rotations: a step of theirs would start from the bind pose.
function pose(character, options) {
  const { vrm, nodes, scene } = character;
  if (vrm) {
    for (const [name, weight] of Object.entries(options.expressions ?? {})) {
      if (!vrm.expressionManager?.getExpression(name)) throw new Error(`the character has no expression ${name}`);
      vrm.expressionManager.setValue(name, weight);
    }
    setHumanoid(character, options, vrm.humanoid.getNormalizedBoneNode('hips').position.clone());
    vrm.humanoid.update();
    if (options.lookAt) {
      scene.updateMatrixWorld(true);
      vrm.lookAt.lookAt(new THREE.Vector3(...options.lookAt));
      vrm.lookAt.update(0);
    }
    vrm.expressionManager?.update();
    vrm.materials?.forEach((material) => material.update?.(0)); // takes the offsets of textures over
    vrm.nodeConstraintManager?.update();
  }
  for (const [index, change] of Object.entries(options.nodes ?? {})) {
    if (change.rotation) nodes[index].quaternion.set(...change.rotation).normalize();
    if (change.translation) nodes[index].position.set(...change.translation);
    if (change.scale) nodes[index].scale.set(...change.scale);
    nodes[index].updateMatrix(); // spring bones are not updated by themselves
  }
  if (options.clip !== undefined) {
    const mixer = new THREE.AnimationMixer(character.gltf.scene);
    const action = mixer.clipAction(character.gltf.animations[0]);
    action.setLoop(THREE.LoopOnce).clampWhenFinished = true;
    action.play();
    mixer.setTime(options.clip);
  }
  for (const [index, weights] of Object.entries(options.morphs ?? {})) {
    for (const mesh of meshesOf(character, nodes[index])) weights.forEach((w, i) => { mesh.morphTargetInfluences[i] = w; });
  }
  scene.updateMatrixWorld(true);
}

const worldPositions = (nodes) => nodes.map((node) => new THREE.Vector3().setFromMatrixPosition(node.matrixWorld).toArray());

/// Steps time: each frame sets the pose, then lets springs and constraints move by its dt.
function step(character, frames) {
  const { vrm, nodes, scene } = character;
  const hipsAtRest = vrm.humanoid.getNormalizedBoneNode('hips').position.clone();
  // Springs start at rest in the first pose, as if it had been held before.
  setHumanoid(character, frames[0], hipsAtRest);
  vrm.humanoid.update();
  scene.updateMatrixWorld(true);
  vrm.springBoneManager?.reset();
  return frames.map((frame) => {
    setHumanoid(character, frame, hipsAtRest);
    vrm.update(frame.dt);
    scene.updateMatrixWorld(true);
    return worldPositions(nodes);
  });
}

/// How far each point is outside the nearest collider of the springs; negative inside.
function depths({ vrm }, points) {
  const target = new THREE.Vector3();
  const colliders = [...vrm.springBoneManager.colliders];
  for (const collider of colliders) collider.updateWorldMatrix(true, true);
  return points.map((p) => Math.min(...colliders.map((collider) => collider.shape.calculateCollision(
    collider.colliderMatrix, new THREE.Vector3(...p), 0, target))));
}

/// World positions of all vertices after morphs and skinning: nodes in the file's order, then primitives, then vertices.
function vertices(character) {
  const p = new THREE.Vector3();
  return character.nodes.flatMap((node, index) => meshesOf(character, node).map((mesh, primitive) => {
    const count = mesh.geometry.attributes.position.count;
    const positions = new Float32Array(count * 3);
    for (let i = 0; i < count; ++i) mesh.getVertexPosition(i, p).applyMatrix4(mesh.matrixWorld).toArray(positions, i * 3);
    return { node: index, primitive, count, positions };
  }));
}

function base64(bytes) {
  let text = '';
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
}

/// Lorica's lights. A white surface that faces the key light gets `key`; ambient light depends on the normal's height.
function light(scene, { direction, key, sky, ground, environment, shadows }) {
  const lamp = new THREE.DirectionalLight(new THREE.Color(...key), Math.PI);
  const around = new THREE.Box3().setFromObject(scene, true).getBoundingSphere(new THREE.Sphere());
  lamp.target.position.copy(around.center);
  lamp.position.set(...direction).setLength(2 * around.radius).add(around.center);
  scene.add(lamp, lamp.target);
  if (shadows) castShadows(scene, lamp, around.radius);
  scene.add(new THREE.HemisphereLight(new THREE.Color(...sky), new THREE.Color(...ground), Math.PI));
  if (!environment) return;
  // The diffuse light of a sky over a ground is that of the hemisphere light.
  const table = environment === 'sky over ground' ? [...Array(64).fill(ground), ...Array(64).fill(sky)] : environment;
  scene.environment = environmentOf(table);
  // The environment replaces the hemisphere for materials that use one. MToon uses none.
  const lights = THREE.ShaderChunk.lights_fragment_begin.replaceAll('NUM_HEMI_LIGHTS', '0');
  scene.traverse((object) => {
    for (const material of [object.material ?? []].flat()) {
      if (!material.isMeshStandardMaterial) continue;
      material.onBeforeCompile = (shader) => {
        shader.fragmentShader = shader.fragmentShader.replace('#include <lights_fragment_begin>', lights);
      };
    }
  });
}

/// Everything casts shadows; they fall on all but toon materials.
function castShadows(scene, lamp, radius) {
  lamp.castShadow = true;
  lamp.shadow.mapSize.set(2048, 2048);
  lamp.shadow.normalBias = radius / 200;
  Object.assign(lamp.shadow.camera, { left: -radius, right: radius, bottom: -radius, top: radius, near: 0, far: 4 * radius });
  scene.traverse((object) => {
    if (!object.isMesh) return;
    object.castShadow = true;
    object.receiveShadow = ![object.material].flat().some((material) => material.isMToonMaterial);
  });
}

/// A panorama whose radiance depends on the direction's height only: `table` has linear RGB from y = -1 to y = 1.
function environmentOf(table) {
  const width = 512;
  const height = 256;
  const texels = new Float32Array(width * height * 4);
  for (let row = 0; row < height; ++row) {
    const y = Math.sin(((row + 0.5) / height - 0.5) * Math.PI); // row 0 is the lowest
    const at = ((y + 1) / 2) * (table.length - 1);
    const below = Math.min(Math.floor(at), table.length - 2);
    const color = [0, 1, 2].map((c) => table[below][c] + (at - below) * (table[below + 1][c] - table[below][c]));
    for (let column = 0; column < width; ++column) texels.set([...color, 1], (row * width + column) * 4);
  }
  const texture = new THREE.DataTexture(texels, width, height, THREE.RGBAFormat, THREE.FloatType);
  texture.mapping = THREE.EquirectangularReflectionMapping;
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/// PNG of the canvas. The mask is the alpha of the picture drawn on nothing: the share of each pixel that is covered.
function png(gl, width, height, asMask) {
  const bottomUp = new Uint8Array(width * height * 4);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bottomUp);
  const image = new ImageData(width, height);
  for (let y = 0; y < height; ++y) {
    for (let x = 0; x < width; ++x) {
      const from = ((height - 1 - y) * width + x) * 4;
      for (let c = 0; c < 3; ++c) image.data[(y * width + x) * 4 + c] = bottomUp[from + (asMask ? 3 : c)];
      image.data[(y * width + x) * 4 + 3] = 255;
    }
  }
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  canvas.getContext('2d').putImageData(image, 0, 0);
  return canvas.toDataURL('image/png').split(',')[1];
}

function picture({ scene }, options) {
  const { width, height } = options;
  const canvas = document.createElement('canvas');
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  renderer.setSize(width, height, false);
  renderer.shadowMap.enabled = true;
  light(scene, options.lights);
  const camera = new THREE.PerspectiveCamera(options.fov, width / height);
  camera.position.set(...options.eye);
  const distance = camera.position.distanceTo(new THREE.Vector3(...options.target));
  camera.near = distance / 50;
  camera.far = distance * 10;
  camera.updateProjectionMatrix();
  camera.lookAt(...options.target);
  const gl = renderer.getContext();
  // Twice: textures that become ready during the first drawing are in the second.
  renderer.setClearColor(0x000000, 0);
  renderer.render(scene, camera);
  renderer.render(scene, camera);
  const mask = png(gl, width, height, true);
  renderer.setClearColor(new THREE.Color(options.background), 1);
  renderer.render(scene, camera);
  const drawn = { picture: png(gl, width, height, false), mask, renderer: gl.getParameter(gl.VERSION) };
  renderer.dispose();
  renderer.forceContextLoss();
  return drawn;
}

function joints({ vrm }) {
  const positions = {};
  for (const name of Object.keys(vrm?.humanoid.humanBones ?? {})) {
    const bone = vrm.humanoid.getRawBoneNode(name);
    if (bone) positions[name] = new THREE.Vector3().setFromMatrixPosition(bone.matrixWorld).toArray();
  }
  return positions;
}

window.shoot = async (bytes, options) => {
  const character = await load(bytes, options);
  const { vrm, nodes, gltf } = character;
  if (!vrm) {
    for (const key of ['rotations', 'hips', 'expressions', 'lookAt', 'frames']) {
      if (options[key]) throw new Error(`${key} needs a VRM character`);
    }
  }
  const shot = {};
  if (options.frames) shot.frames = step(character, options.frames);
  else pose(character, options);
  shot.joints = joints(character);
  shot.nodes = worldPositions(nodes);
  shot.nodeRotations = nodes.map((node) => node.getWorldQuaternion(new THREE.Quaternion()).toArray());
  shot.nodeNames = (gltf.parser.json.nodes ?? []).map((node) => node.name ?? '');
  shot.expressions = vrm?.expressionManager?.expressions.map((expression) => expression.expressionName) ?? [];
  shot.expressionWeights = Object.fromEntries((vrm?.expressionManager?.expressions ?? []).map((e) => [e.expressionName, e.weight]));
  if (options.probes) shot.depths = depths(character, options.probes);
  if (options.vertices) {
    shot.meshes = vertices(character).map((mesh) => ({ ...mesh, positions: base64(new Uint8Array(mesh.positions.buffer)) }));
  }
  if (options.picture) Object.assign(shot, picture(character, options));
  return shot;
};
