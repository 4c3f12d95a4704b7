/// Lorica and three.js. Nothing of three is imported: what is needed comes from the objects that are given.

/// A skinned mesh for Lorica.makeBody(). Its own geometry, in its bind pose.
/// @param poses  from posesOf(), or none: the bind pose
export function skinOf(mesh, poses) {
  const { geometry, skeleton, bindMatrix } = mesh;
  const { position, skinIndex, skinWeight } = geometry.attributes;
  const read = (attribute, size, out) => {
    for (let i = 0; i < attribute.count; ++i) {
      for (let k = 0; k < size; ++k) out[size * i + k] = attribute.getComponent(i, k);
    }
    return out;
  };
  const positions = read(position, 3, new Float64Array(3 * position.count));
  const m = bindMatrix.elements;  // to where the bones are
  for (let i = 0; i < positions.length; i += 3) {
    const [x, y, z] = positions.subarray(i, i + 3);
    for (let k = 0; k < 3; ++k) positions[i + k] = m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k];
  }
  const indices = geometry.index ? Int32Array.from(geometry.index.array)
    : Int32Array.from({ length: position.count }, (_, i) => i);
  return { name: mesh.name || 'mesh', positions, indices, joints: read(skinIndex, 4, new Int32Array(4 * position.count)),
    weights: read(skinWeight, 4, new Float64Array(4 * position.count)),
    inverseBind: Float64Array.from(skeleton.boneInverses.flatMap((inverse) => inverse.elements)), poses };
}

/// Where the bones are, for Live.update(). @param out  16 numbers of each, or none
export function bonesOf(mesh, out = new Float64Array(16 * mesh.skeleton.bones.length)) {
  mesh.skeleton.bones.forEach((bone, j) => out.set(bone.matrixWorld.elements, 16 * j));
  return out;
}

/// Poses of clips at even intervals: what a body is fitted to.
/// @param root   that the mixer moves, and that the bones hang at
/// @param mixer  an AnimationMixer of it
export function posesOf(mesh, root, mixer, clips, count = 24) {
  const poses = [];
  for (const clip of clips) {
    const action = mixer.clipAction(clip).play();
    const own = Math.max(1, Math.ceil(count / clips.length));
    for (let i = 0; i < own; ++i) {
      mixer.setTime(clip.duration * i / own);
      root.updateMatrixWorld(true);
      poses.push(bonesOf(mesh));
    }
    action.stop();
  }
  return Float64Array.from(poses.flatMap((pose) => [...pose]));
}

/// Lines of all hulls, to be added to a scene; call the returned `update` after each Live.update().
export function hullLines(THREE, live, material = new THREE.LineBasicMaterial({ color: 0x2fb5a6 })) {
  const geometry = new THREE.BufferGeometry(), lines = new THREE.LineSegments(geometry, material);
  lines.frustumCulled = false;
  const update = () => {
    let count = 0;
    for (const hull of live.hulls) count += 3 * hull.triangleCount;
    if (!geometry.attributes.position || geometry.attributes.position.count < count) {
      geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6 * count), 3));
    }
    const { array } = geometry.attributes.position;
    let at = 0;
    for (const { positions, indices, triangleCount } of live.hulls) {
      for (let e = 0; e < 3 * triangleCount; ++e) {
        const a = indices[e], b = indices[e % 3 === 2 ? e - 2 : e + 1];
        if (a > b) continue;  // its other triangle draws it
        for (const v of [a, b]) for (let k = 0; k < 3; ++k) array[at++] = positions[3 * v + k];
      }
    }
    geometry.setDrawRange(0, at / 3);
    geometry.attributes.position.needsUpdate = true;
  };
  return { lines, update };
}
