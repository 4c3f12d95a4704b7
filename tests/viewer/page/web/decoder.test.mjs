// node --test decoder.test.mjs: frames made by hand, byte by byte.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import {
  FrameError,
  FrameReader,
  edgesOf,
  matrixOfPose,
  multiplyInto,
  readMesh,
} from '../../../../viewer/page/web/src/wire.js';

const write = {
  u8: [1, 'setUint8'],
  u16: [2, 'setUint16'],
  i16: [2, 'setInt16'],
  u32: [4, 'setUint32'],
  f32: [4, 'setFloat32'],
  f64: [8, 'setFloat64'],
};

/// bytes('u16', 1, 2, 'f32', 0.5): numbers in little-endian.
function bytes(...items) {
  const out = [];
  let type;
  for (const item of items) {
    if (typeof item === 'string') type = item;
    else {
      const view = new DataView(new ArrayBuffer(write[type][0]));
      view[write[type][1]](0, item, true);
      out.push(...new Uint8Array(view.buffer));
    }
  }
  return out;
}
const padded = (list) => [...list, ...Array((4 - (list.length % 4)) % 4).fill(0)];
const section = (kind, index, payload) => [...bytes('u16', kind, index, 'u32', payload.length), ...padded(payload)];
const frame = (...sections) =>
  Uint8Array.from([
    0x4c,
    0x52,
    0x43,
    0x46,
    ...bytes('u16', 1, sections.length, 'u32', 7, 3, 5, 1, 'f64', 2.5),
    ...sections.flat(),
  ]).buffer;
const pose = (x, y, z, ...q) => bytes('f32', x, y, z, 'i16', ...q);
const half = Math.round(32767 * Math.SQRT1_2);

const face = section(2, 0, bytes('f32', 0.25, 1));
const avatar = section(1, 2, [
  ...bytes('u8', 1, 0, 'u16', 2, 'f32', 0.5),
  ...pose(1, 2, 3, 0, 0, 0, 32767),
  ...pose(0, 0, 0, 0, half, 0, half),
]);
const affine = section(1, 1, [
  ...bytes('u8', 0, 1, 'u16', 1, 'f32', 1),
  ...bytes('f32', 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12),
]);
const props = section(3, 0, [...bytes('u32', 1, 'u16', 9, 0), ...pose(1, 0, -1, 32767, 0, 0, 0)]);
const tetrahedron = [
  ...bytes('u16', 1, 0),
  ...pose(0, 1, 0, 0, 0, 0, 32767),
  ...bytes('f32', 0.5, 'u8', 255, 128, 0, 255, 'u16', 4, 4),
  ...padded(bytes('i16', 0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0, -32767, 'u16', 0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2)),
];
const hulls = section(4, 0, tetrahedron);
const sameFaces = section(4, 0, [
  ...bytes('u16', 1, 0),
  ...pose(0, 1, 0, 0, 0, 0, 32767),
  ...bytes('f32', 0.5, 'u8', 1, 2, 3, 255, 'u16', 3, 0),
  ...padded(bytes('i16', 1, 2, 3, 4, 5, 6, 7, 8, 9)),
]);
const contacts = section(5, 0, bytes('u32', 1, 'f32', 1, 2, 3, 0, 1, 0, 0.75));
const particles = section(6, 0, [
  ...bytes('u32', 100, 2, 'f32', 0.02, 'u8', 255, 128, 0, 255, 'f32', 0, 1, 2, 3, 4, 5),
  ...bytes('u16', 0, 32768, 65535, 1, 2, 3),
]);
const depth = section(7, 0, [0xff, 0xd8, 0xff]);
const unknown = section(99, 0, [1, 2, 3, 4, 5]);
const all = { face, avatar, affine, props, hulls, sameFaces, contacts, particles, depth, unknown };

test('a frame without sections has its header', () => {
  const read = new FrameReader().read(frame());
  assert.deepEqual([read.run, read.version, read.number, read.time], [7, 3, 5 + 2 ** 32, 2.5]);
  assert.deepEqual([read.avatars, read.hulls, read.props, read.depth], [[], [], null, null]);
});

test('what is no frame is refused', () => {
  const changed = (at, value) => {
    const b = new Uint8Array(frame(face));
    b[at] = value;
    return b.buffer;
  };
  for (const buffer of [
    new ArrayBuffer(0),
    new ArrayBuffer(32),
    changed(0, 0),
    changed(4, 2),
    changed(6, 2),
    changed(6, 0),
    changed(36, 9),
    changed(39, 255),
  ]) {
    assert.throws(() => new FrameReader().read(buffer), FrameError);
  }
});

test('every truncated prefix is refused, and the reader still works', () => {
  const reader = new FrameReader();
  for (const [name, one] of Object.entries({ ...all, everything: Object.values(all).flat() })) {
    const whole = name === 'everything' ? frame(...Object.values(all)) : frame(one);
    for (let length = 0; length < whole.byteLength; ++length) {
      assert.throws(
        () => reader.read(whole.slice(0, length)),
        FrameError,
        `${name}, ${length} of ${whole.byteLength} bytes`,
      );
    }
    reader.read(whole);
  }
});

test('a byte changed anywhere is read or refused', () => {
  const reader = new FrameReader(),
    whole = new Uint8Array(frame(...Object.values(all)));
  for (let at = 0; at < whole.length; ++at) {
    for (const value of [0, 1, 127, 255]) {
      const changed = whole.slice();
      changed[at] = value;
      try {
        reader.read(changed.buffer);
      } catch (error) {
        assert(error instanceof FrameError, `byte ${at} = ${value}: ${error.stack}`);
      }
    }
  }
});

test('joints of both forms become matrices', () => {
  const [first, second] = new FrameReader().read(frame(avatar, affine)).avatars;
  assert.deepEqual([first.index, first.present, first.joints, first.opacity], [2, true, 2, 0.5]);
  assert.deepEqual([...first.worldFromModel.slice(0, 12)], [1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3]);
  // A quarter turn about y moves z to x.
  [0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0].forEach((x, i) =>
    assert(Math.abs(first.worldFromModel[12 + i] - x) < 1e-4, `${i}`),
  );
  assert.deepEqual([second.index, second.present], [1, false]);
  assert.deepEqual([...second.worldFromModel.slice(0, 12)], [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]);
});

test('the product of two affine matrices is that of their points', () => {
  const a = Float32Array.of(0, 9, 9, 1, 0, -1, 0, 2, 1, 0, 0, 3, 0, 0, 1),
    b = [1, 2, 0, 5, 0, 1, 0, 6, 0, 0, 2, 7];
  const quarter = Float32Array.of(0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3),
    out = new Array(16);
  multiplyInto(out, quarter, 0, b);
  // b takes (1, 1, 1) to (8, 7, 9); a takes that to (-7 + 1, 8 + 2, 9 + 3).
  assert.deepEqual(
    [0, 1, 2, 3].map((row) => out[row] + out[4 + row] + out[8 + row] + out[12 + row]),
    [-6, 10, 12, 1],
  );
  multiplyInto(out, a, 3, b); // from an offset
  assert.equal(out[12], a[3] * 5 + a[4] * 6 + a[5] * 7 + a[6]);
});

test('props, faces, contacts, particles and the depth image', () => {
  const read = new FrameReader().read(frame(props, face, contacts, particles, depth, unknown));
  assert.deepEqual(
    [read.props.count, read.props.indices[0], ...read.props.poses.slice(0, 7)],
    [1, 9, 1, 0, -1, 1, 0, 0, 0],
  );
  assert.deepEqual([read.faces[0].index, ...read.faces[0].weights], [0, 0.25, 1]);
  assert.deepEqual([read.contacts.count, ...read.contacts.values], [1, 1, 2, 3, 0, 1, 0, 0.75]);
  const { all: number, sent, color, lowest, size, places } = read.particles;
  assert.deepEqual(
    [number, sent, ...color, ...lowest, ...size, ...places],
    [100, 2, 255, 128, 0, 255, 0, 1, 2, 3, 4, 5, 0, 32768, 65535, 1, 2, 3],
  );
  assert.deepEqual([...read.depth], [0xff, 0xd8, 0xff]);
});

test('hulls have faces, or those from before', () => {
  const reader = new FrameReader();
  const [part] = reader.read(frame(hulls)).hulls[0].parts;
  assert.deepEqual([part.extent, part.vertices.length, part.triangles.length, part.pose[1]], [0.5, 12, 12, 1]);
  assert.deepEqual([...part.color], [255, 128, 0, 255]);
  const [same] = reader.read(frame(sameFaces)).hulls[0].parts;
  assert.deepEqual([same.vertices.length, same.triangles.length], [9, 0]);
});

test('a face beyond the vertices is refused', () => {
  const wrong = tetrahedron.slice();
  wrong[wrong.length - 2] = 4;
  assert.throws(() => new FrameReader().read(frame(section(4, 0, wrong))), FrameError);
});

test('edges within a plane are not seen', () => {
  const square = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1];
  const cube = [
    0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7,
  ];
  assert.equal(edgesOf(square, cube).length, 2 * 12);
});

test('a quaternion of zeros is no rotation', () => {
  const read = new FrameReader().read(
    frame(section(3, 0, [...bytes('u32', 1, 'u16', 0, 0), ...pose(0, 0, 0, 0, 0, 0, 0)])),
  );
  const out = new Float32Array(12);
  matrixOfPose(read.props.poses, 0, out, 0);
  assert.deepEqual([...out], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]);
});

test('meshes of props', () => {
  const mesh = Uint8Array.from(bytes('u32', 3, 1, 'f32', 0, 0, 0, 1, 0, 0, 0, 1, 0, 'u32', 0, 1, 2)).buffer;
  assert.deepEqual([...readMesh(mesh).indices], [0, 1, 2]);
  for (let length = 0; length < mesh.byteLength; ++length)
    assert.throws(() => readMesh(mesh.slice(0, length)), FrameError);
  new Uint32Array(mesh)[11] = 3;
  assert.throws(() => readMesh(mesh), FrameError);
});
