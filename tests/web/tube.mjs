/// The tube of tests/consumer/core/interface.c, number by number.
export const RINGS = 24, SIDES = 16, JOINTS = 3, POSES = 8;

export function poseAt(tangent, out = new Float64Array(16 * JOINTS)) {
  out.fill(0);
  for (let j = 0; j < JOINTS; ++j) {
    const t = j * tangent, cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t), m = out.subarray(16 * j);
    m[0] = m[15] = 1;
    m[5] = m[10] = cosine;
    m[6] = sine;
    m[9] = -sine;
    m[14] = 0.8 * j;
  }
  return out;
}

export function makeTube() {
  const count = RINGS * SIDES + 2;
  const positions = new Float64Array(3 * count), joints = new Int32Array(4 * count), weights = new Float64Array(4 * count);
  const indices = [];
  for (let r = 0; r < RINGS; ++r) {
    const radius = 0.2 + 0.04 * (r % 6), aside = 0.01 * r * (RINGS - r) / 4;
    for (let s = 0; s < SIDES; ++s) {
      const v = r * SIDES + s, next = r * SIDES + (s + 1) % SIDES, quarter = Math.floor(s / 4);
      const t = s % 4 * 0.25, c = (1 - t * t) / (1 + t * t), d = 2 * t / (1 + t * t);
      positions.set([radius * [c, -d, -c, d][quarter] + aside, radius * [d, c, -d, -c][quarter], 0.1 * r], 3 * v);
      const joint = Math.floor(r / 8);
      joints.set([joint, Math.max(joint - 1, 0)], 4 * v);
      weights.set([0.5 + 0.0625 * (r % 8), 0.5 - 0.0625 * (r % 8)], 4 * v);
      if (r + 1 < RINGS) indices.push(v, next, next + SIDES, v, next + SIDES, v + SIDES);
    }
  }
  for (let end = 0; end < 2; ++end) {
    const middle = RINGS * SIDES + end, first = end * (RINGS - 1) * SIDES;
    positions[3 * middle + 2] = 0.1 * end * (RINGS - 1);
    positions[3 * middle] = 0.01 * end * (RINGS - 1) / 4;
    joints[4 * middle] = 2 * end;
    weights[4 * middle] = 1;
    for (let s = 0; s < SIDES; ++s) {
      const a = first + s, b = first + (s + 1) % SIDES;
      indices.push(middle, end ? a : b, end ? b : a);
    }
  }
  const inverseBind = new Float64Array(16 * JOINTS);
  for (let j = 0; j < JOINTS; ++j) {
    for (const i of [0, 5, 10, 15]) inverseBind[16 * j + i] = 1;
    inverseBind[16 * j + 14] = -0.8 * j;
  }
  const poses = new Float64Array(16 * JOINTS * POSES);
  for (let p = 0; p < POSES; ++p) poses.set(poseAt(0.05 * p), 16 * JOINTS * p);
  return { name: 'tube', positions, indices, joints, weights, inverseBind, poses };
}

/// FNV-1a of 32 bits of the bytes of typed arrays, after others.
export function fnv(array, hash = 2166136261) {
  for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength)) hash = Math.imul(hash ^ byte, 16777619);
  return hash >>> 0;
}

export const hex = (hash) => (hash >>> 0).toString(16).padStart(8, '0');
