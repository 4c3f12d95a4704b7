// What is dropped, as three.js reads it and as Lorica takes it.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { OBJLoader } from 'three/addons/loaders/OBJLoader.js';
import { STLLoader } from 'three/addons/loaders/STLLoader.js';

const kPoses = 12; // of all clips

/// @return root, clips, and what it is called
export async function readModel(name, bytes) {
  const ending = name.split('.').pop().toLowerCase();
  if (ending === 'glb' || ending === 'vrm' || ending === 'gltf') {
    const { scene, animations } = await new GLTFLoader().parseAsync(bytes, '');
    return { name, root: scene, clips: animations };
  }
  if (ending === 'obj') return { name, root: new OBJLoader().parse(new TextDecoder().decode(bytes)), clips: [] };
  if (ending === 'stl') {
    const root = new THREE.Mesh(new STLLoader().parse(bytes), new THREE.MeshStandardMaterial({ color: 0xb9b2a6 }));
    return { name, root, clips: [] };
  }
  throw new Error(`${name}: expected a .glb, .vrm, .gltf, .obj or .stl file`);
}

/// To begin with: a snake of six bones, from nothing but numbers.
export function makeSnake() {
  const rings = 24, sides = 12, bones = 6, length = 1.8;
  const positions = [], indices = [], joints = [], weights = [];
  for (let r = 0; r <= rings; ++r) {
    const share = r / rings, along = (r === 0 ? 0 : r === rings ? 1 : share) * length;
    const radius = r === 0 || r === rings ? 1e-3 : 0.16 * Math.sqrt(Math.min(1, 5 * share) * Math.min(1, 1.4 - share)) +
      0.05 * Math.exp(-(((share - 0.9) / 0.06) ** 2));
    const at = Math.min(share * (bones - 1), bones - 1.001), first = Math.floor(at);
    for (let s = 0; s < sides; ++s) {
      const angle = (2 * Math.PI * s) / sides;
      positions.push(radius * Math.cos(angle), radius * Math.sin(angle), along);
      joints.push(first, first + 1, 0, 0);
      weights.push(1 - (at - first), at - first, 0, 0);
      const a = r * sides + s, b = r * sides + ((s + 1) % sides);
      if (r < rings) indices.push(a, b, b + sides, a, b + sides, a + sides);
    }
  }
  for (const [ring, turned] of [[0, true], [rings, false]]) {
    for (let s = 1; s + 1 < sides; ++s) {
      const a = ring * sides, b = a + s, c = b + 1;
      indices.push(...(turned ? [a, c, b] : [a, b, c]));
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('skinIndex', new THREE.Uint16BufferAttribute(joints, 4));
  geometry.setAttribute('skinWeight', new THREE.Float32BufferAttribute(weights, 4));
  geometry.setIndex(indices);
  geometry.computeVertexNormals();
  const mesh = new THREE.SkinnedMesh(geometry, new THREE.MeshStandardMaterial({ color: 0x7f9a5a, roughness: 0.7 }));
  const chain = Array.from({ length: bones }, (_, j) => Object.assign(new THREE.Bone(), { name: `bone${j}` }));
  chain.forEach((bone, j) => {
    if (j === 0) return;
    bone.position.z = length / (bones - 1);
    chain[j - 1].add(bone);
  });
  const root = new THREE.Group();
  mesh.name = 'snake';
  mesh.position.set(0, 0.3, -length / 2);
  mesh.add(chain[0]);
  root.add(mesh);
  root.updateMatrixWorld(true);
  mesh.bind(new THREE.Skeleton(chain));
  const times = Array.from({ length: 25 }, (_, i) => i / 8), turn = new THREE.Quaternion();
  const tracks = chain.map((bone, j) => new THREE.QuaternionKeyframeTrack(`${bone.name}.quaternion`, times, times.flatMap((t) => {
    const phase = (2 * Math.PI * t) / 3 - 0.9 * j;
    return turn.setFromEuler(new THREE.Euler(j > 3 ? -0.25 : 0, 0.42 * Math.sin(phase) * (j === 0 ? 0.5 : 1), 0)).toArray();
  })));
  return { name: 'snake', root, clips: [new THREE.AnimationClip('wriggle', 3, tracks)] };
}

/// What of a model Lorica gets: all meshes as one, corners at the same place joined. If anything moves it, as a skin whose
/// joints are bones, or the meshes themselves where they have none.
export class Subject {
  joints = []; // { node, inverse }
  constructor({ name, root, clips }) {
    root.updateMatrixWorld(true);
    const positions = [], indices = [], joints = [], weights = [], known = new Map(), point = new THREE.Vector3();
    const jointOf = (node, inverse) => {
      const found = this.joints.findIndex((joint) => joint.node === node && joint.inverse.equals(inverse));
      return found >= 0 ? found : this.joints.push({ node, inverse: inverse.clone() }) - 1;
    };
    root.traverse((mesh) => {
      if (!mesh.isMesh || !mesh.visible) return;
      const { position, skinIndex, skinWeight } = mesh.geometry.attributes, { index } = mesh.geometry;
      const own = mesh.isSkinnedMesh ? mesh.skeleton.bones.map((bone, b) => jointOf(bone, mesh.skeleton.boneInverses[b]))
        : [jointOf(mesh, mesh.matrixWorld.clone().invert())];
      const place = mesh.isSkinnedMesh ? mesh.bindMatrix : mesh.matrixWorld;
      const vertexOf = Array.from({ length: position.count }, (_, v) => {
        point.fromBufferAttribute(position, v).applyMatrix4(place);
        const pull = [0, 0, 0, 0], which = [0, 0, 0, 0];
        if (mesh.isSkinnedMesh) {
          for (let k = 0; k < 4; ++k) [which[k], pull[k]] = [own[skinIndex.getComponent(v, k)], skinWeight.getComponent(v, k)];
        } else [which[0], pull[0]] = [own[0], 1];
        const key = [point.x, point.y, point.z, ...(mesh.isSkinnedMesh ? [] : which)].join();
        if (!known.has(key)) {
          known.set(key, positions.length / 3);
          positions.push(point.x, point.y, point.z);
          joints.push(...which);
          weights.push(...pull);
        }
        return known.get(key);
      });
      const count = index ? index.count : position.count;
      for (let i = 0; i + 2 < count; i += 3) {
        const corners = [0, 1, 2].map((k) => vertexOf[index ? index.getX(i + k) : i + k]);
        if (new Set(corners).size === 3) indices.push(...corners);
      }
    });
    if (indices.length === 0) throw new Error(`${name}: no triangles`);
    this.moves = clips.length > 0 || this.joints.some(({ node }) => node.isBone);
    this.mesh = { positions: Float64Array.from(positions), indices: Int32Array.from(indices) };
    this.skin = { name, ...this.mesh, joints: Int32Array.from(joints), weights: Float64Array.from(weights),
      inverseBind: Float64Array.from(this.joints.flatMap(({ inverse }) => inverse.elements)) };
    this.bones = new Float64Array(16 * this.joints.length);
  }

  /// Where the joints are now.
  place() {
    this.joints.forEach(({ node }, j) => this.bones.set(node.matrixWorld.elements, 16 * j));
    return this.bones;
  }

  /// Poses of all clips, which the parts are fitted to; of none, the pose that it stands in.
  pose(root, mixer, clips) {
    const poses = [];
    for (const clip of clips) {
      const action = mixer.clipAction(clip).reset().play();
      const count = Math.max(2, Math.ceil(kPoses / clips.length));
      for (let i = 0; i < count; ++i) {
        mixer.setTime((clip.duration * i) / count);
        root.updateMatrixWorld(true);
        poses.push(...this.place());
      }
      action.stop();
    }
    root.updateMatrixWorld(true);
    if (poses.length === 0) poses.push(...this.place());
    this.skin.poses = Float64Array.from(poses);
  }
}
