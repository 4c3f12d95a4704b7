// Decodes the frames of docs/WIRE.md. Without a page and without three.js, so that Node tests it.

/// A frame that is not as docs/WIRE.md says; it is refused as a whole.
export class FrameError extends Error {}

const kMagic = 0x4643524c; // "LRCF"
const kHeaderBytes = 32;
const kPoseBytes = 20;
const kPartBytes = 32; // of a hull, before its vertices
const kind = { avatar: 1, face: 2, props: 3, hulls: 4, contacts: 5, particles: 6, depth: 7 };

/// An array of at least this length; a new one is half again as long.
const grown = (array, length) => (array.length >= length ? array : new array.constructor(Math.ceil(length * 1.5)));

/// A pose as 7 numbers: position, quaternion of length 1 (x, y, z, w).
function readPose(view, at, out, to) {
  for (let i = 0; i < 3; ++i) out[to + i] = view.getFloat32(at + 4 * i, true);
  let lengthSq = 0;
  for (let i = 0; i < 4; ++i) {
    const q = view.getInt16(at + 12 + 2 * i, true);
    out[to + 3 + i] = q;
    lengthSq += q * q;
  }
  const scale = lengthSq > 0 ? 1 / Math.sqrt(lengthSq) : 0;
  for (let i = 3; i < 7; ++i) out[to + i] *= scale;
  if (lengthSq === 0) out[to + 6] = 1;
}

/// The 3 x 4 matrix, row by row, of a pose of 7 numbers.
export function matrixOfPose(pose, from, out, to) {
  const x = pose[from + 3],
    y = pose[from + 4],
    z = pose[from + 5],
    w = pose[from + 6];
  out[to] = 1 - 2 * (y * y + z * z);
  out[to + 1] = 2 * (x * y - z * w);
  out[to + 2] = 2 * (x * z + y * w);
  out[to + 3] = pose[from];
  out[to + 4] = 2 * (x * y + z * w);
  out[to + 5] = 1 - 2 * (x * x + z * z);
  out[to + 6] = 2 * (y * z - x * w);
  out[to + 7] = pose[from + 1];
  out[to + 8] = 2 * (x * z - y * w);
  out[to + 9] = 2 * (y * z + x * w);
  out[to + 10] = 1 - 2 * (x * x + y * y);
  out[to + 11] = pose[from + 2];
}

/// out = a * b: 3 x 4 matrices, row by row, as a 4 x 4 matrix, column by column. `a` starts at `from`.
export function multiplyInto(out, a, from, b) {
  for (let row = 0; row < 3; ++row) {
    const a0 = a[from + 4 * row],
      a1 = a[from + 4 * row + 1],
      a2 = a[from + 4 * row + 2];
    for (let column = 0; column < 4; ++column) {
      out[4 * column + row] = a0 * b[column] + a1 * b[4 + column] + a2 * b[8 + column];
    }
    out[12 + row] += a[from + 4 * row + 3];
  }
  out[3] = out[7] = out[11] = 0;
  out[15] = 1;
}

/// Reads frames into one object that is used again: what is needed after the next read() has to be copied.
export class FrameReader {
  frame = {
    run: 0,
    version: 0,
    number: 0,
    time: 0,
    avatars: [],
    faces: [],
    props: null,
    hulls: [],
    contacts: null,
    particles: null,
    depth: null,
  };
  #avatars = []; // by index, used again
  #props = { count: 0, indices: new Uint16Array(64), poses: new Float32Array(7 * 64) };
  #pose = new Float32Array(7);

  /// @throws FrameError
  read(buffer) {
    const view = new DataView(buffer),
      frame = this.frame;
    const need = (at, bytes, end, what) => {
      if (at + bytes > end) throw new FrameError(`${what} ends ${at + bytes - end} bytes early`);
    };
    need(0, kHeaderBytes, buffer.byteLength, 'the header');
    if (view.getUint32(0, true) !== kMagic) throw new FrameError('this is no frame');
    if (view.getUint16(4, true) !== 1)
      throw new FrameError(`a frame of version ${view.getUint16(4, true)}, known is 1`);
    frame.run = view.getUint32(8, true);
    frame.version = view.getUint32(12, true);
    frame.number = view.getUint32(16, true) + view.getUint32(20, true) * 2 ** 32;
    frame.time = view.getFloat64(24, true);
    frame.avatars.length = frame.faces.length = frame.hulls.length = 0;
    frame.props = frame.contacts = frame.particles = frame.depth = null;
    let at = kHeaderBytes;
    for (let left = view.getUint16(6, true); left > 0; --left) {
      need(at, 8, buffer.byteLength, 'a section');
      const bytes = view.getUint32(at + 4, true);
      need(at + 8, (bytes + 3) & ~3, buffer.byteLength, 'a section');
      if (bytes > buffer.byteLength) throw new FrameError(`a section of ${bytes} bytes`);
      this.#section(view, view.getUint16(at, true), view.getUint16(at + 2, true), at + 8, at + 8 + bytes, need);
      at += 8 + ((bytes + 3) & ~3);
    }
    if (at !== buffer.byteLength) throw new FrameError(`${buffer.byteLength - at} bytes behind the last section`);
    return frame;
  }

  #section(view, what, index, at, end, need) {
    const { frame } = this,
      { buffer } = view;
    // The rest of a section: this many items of this size.
    const rest = (from, count, size, name) => {
      if (count * size !== end - from)
        throw new FrameError(`${name}: ${count} take ${count * size} bytes, here are ${end - from}`);
    };
    if (what === kind.avatar) {
      need(at, 8, end, 'an avatar');
      const count = view.getUint16(at + 2, true),
        form = view.getUint8(at + 1);
      if (form > 1) throw new FrameError(`joints of form ${form}`);
      rest(at + 8, count, form === 0 ? kPoseBytes : 48, 'joints');
      const avatar = (this.#avatars[index] ??= { index, worldFromModel: new Float32Array(0) });
      avatar.worldFromModel = grown(avatar.worldFromModel, 12 * count);
      Object.assign(avatar, {
        present: view.getUint8(at) !== 0,
        joints: count,
        opacity: view.getFloat32(at + 4, true),
      });
      if (form === 1) avatar.worldFromModel.set(new Float32Array(buffer, at + 8, 12 * count));
      for (let i = 0; form === 0 && i < count; ++i) {
        readPose(view, at + 8 + kPoseBytes * i, this.#pose, 0);
        matrixOfPose(this.#pose, 0, avatar.worldFromModel, 12 * i);
      }
      frame.avatars.push(avatar);
    } else if (what === kind.face) {
      rest(at, (end - at) >> 2, 4, 'weights');
      frame.faces.push({ index, weights: new Float32Array(buffer, at, (end - at) >> 2) });
    } else if (what === kind.props) {
      need(at, 4, end, 'props');
      const props = this.#props,
        count = view.getUint32(at, true);
      rest(at + 4, count, 4 + kPoseBytes, 'props');
      props.count = count;
      props.indices = grown(props.indices, count);
      props.poses = grown(props.poses, 7 * count);
      for (let i = 0, from = at + 4; i < count; ++i, from += 4 + kPoseBytes) {
        props.indices[i] = view.getUint16(from, true);
        readPose(view, from + 4, props.poses, 7 * i);
      }
      frame.props = props;
    } else if (what === kind.hulls) {
      frame.hulls.push({ index, parts: this.#hulls(view, at, end, need) });
    } else if (what === kind.contacts) {
      need(at, 4, end, 'contacts');
      const count = view.getUint32(at, true);
      rest(at + 4, count, 28, 'contacts');
      frame.contacts = { count, values: new Float32Array(buffer, at + 4, 7 * count) };
    } else if (what === kind.particles) {
      need(at, 40, end, 'particles');
      const sent = view.getUint32(at + 4, true);
      rest(at + 40, sent, 6, 'particles');
      frame.particles = {
        all: view.getUint32(at, true),
        sent,
        radius: view.getFloat32(at + 8, true),
        color: new Uint8Array(buffer, at + 12, 4),
        lowest: new Float32Array(buffer, at + 16, 3),
        size: new Float32Array(buffer, at + 28, 3),
        places: new Uint16Array(buffer, at + 40, 3 * sent),
      };
    } else if (what === kind.depth) {
      frame.depth = new Uint8Array(buffer, at, end - at);
    }
  }

  /// Of each part: `pose` (7 numbers), `extent`, `color` (sRGB), `vertices` (shares of the extent times 32767),
  /// `triangles`; no triangles but vertices = those from before.
  #hulls(view, at, end, need) {
    need(at, 4, end, 'hulls');
    const parts = [];
    let from = at + 4;
    for (let left = view.getUint16(at, true); left > 0; --left) {
      need(from, kPartBytes, end, 'a part');
      const vertexCount = view.getUint16(from + 28, true),
        triangleCount = view.getUint16(from + 30, true);
      const bytes = 6 * (vertexCount + triangleCount);
      need(from + kPartBytes, (bytes + 3) & ~3, end, 'a part');
      const part = {
        pose: new Float32Array(7),
        extent: view.getFloat32(from + 20, true),
        color: new Uint8Array(view.buffer, from + 24, 4),
        vertices: new Int16Array(view.buffer, from + kPartBytes, 3 * vertexCount),
        triangles: new Uint16Array(view.buffer, from + kPartBytes + 6 * vertexCount, 3 * triangleCount),
      };
      readPose(view, from, part.pose, 0);
      if (part.triangles.some((v) => v >= vertexCount))
        throw new FrameError(`a face has a vertex beyond the ${vertexCount} of its part`);
      parts.push(part);
      from += kPartBytes + ((bytes + 3) & ~3);
    }
    if (from !== end) throw new FrameError(`${end - from} bytes behind the last part`);
    return parts;
  }
}

/// A prop's mesh: `u32` vertices, `u32` triangles, positions, indices. @throws FrameError
export function readMesh(buffer) {
  if (buffer.byteLength < 8) throw new FrameError('the mesh has no header');
  const [vertices, triangles] = new Uint32Array(buffer, 0, 2);
  if (buffer.byteLength !== 8 + 12 * (vertices + triangles)) {
    throw new FrameError(`a mesh of ${vertices} vertices and ${triangles} triangles in ${buffer.byteLength} bytes`);
  }
  const mesh = {
    positions: new Float32Array(buffer, 8, 3 * vertices),
    indices: new Uint32Array(buffer, 8 + 12 * vertices, 3 * triangles),
  };
  if (mesh.indices.some((v) => v >= vertices))
    throw new FrameError(`a face has a vertex beyond the ${vertices} of the mesh`);
  return mesh;
}

/// Edges of a hull that are seen: pairs of vertices between two faces that do not lie in one plane.
export function edgesOf(vertices, triangles) {
  const faces = new Map(),
    edges = []; // first face of an edge: its normal
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const u = [0, 1, 2].map((k) => vertices[b + k] - vertices[a + k]),
      v = [0, 1, 2].map((k) => vertices[c + k] - vertices[a + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n) || 1;
    for (let k = 0; k < 3; ++k) {
      const p = triangles[t + k],
        q = triangles[t + ((k + 1) % 3)],
        key = Math.min(p, q) * 65536 + Math.max(p, q);
      const other = faces.get(key);
      if (!other)
        faces.set(
          key,
          n.map((x) => x / length),
        );
      else if ((other[0] * n[0] + other[1] * n[1] + other[2] * n[2]) / length < 0.97) edges.push(p, q);
    }
  }
  return new Uint16Array(edges);
}
