/// Lorica in JavaScript: convex parts of meshes, and live hulls of skinned characters. See README.md and lorica.d.ts.
/// What follows calls the C interface (lorica.h) of a WebAssembly module with 32-bit addresses.

const STATUS = ['ok', 'not found', 'unreadable', 'unwritable', 'bad format', 'bad mesh', 'invalid argument',
  'unsupported', 'cancelled', 'failure'];
const PRESETS = ['fast', 'paper', 'quality'];
const CLOSED = ['if needed', 'never', 'always'];
const WALLS = ['auto', 'solid', 'shell'];
const CHARACTER_WALLS = [undefined, 'auto', 'shell'];

/// What a call of Lorica refused, and `kind` of it, such as "bad mesh" or "cancelled".
export class LoricaError extends Error {
  constructor(kind, sentence) {
    super(sentence);
    this.name = 'LoricaError';
    this.kind = kind;
  }
}

/// A struct of lorica.h: its fields in order, as u (32 bits: int32_t, size_t, a pointer) or d (double).
const layout = (fields) => {
  const struct = { offsets: {}, kinds: fields, size: 0 };
  for (const [name, kind] of Object.entries(fields)) {
    const size = kind === 'd' ? 8 : 4;
    struct.size = Math.ceil(struct.size / size) * size;
    struct.offsets[name] = struct.size;
    struct.size += size;
  }
  if (Object.values(fields).includes('d')) struct.size = Math.ceil(struct.size / 8) * 8;
  return struct;
};
const MESH = layout({ size: 'u', vertices: 'u', vertexCount: 'u', triangles: 'u', triangleCount: 'u', frameCount: 'u' });
const DECOMPOSE = layout({ size: 'u', parts: 'u', preset: 'u', maxError: 'd', maxDistance: 'd', hullVertices: 'u',
  closedBody: 'u', threads: 'u', progress: 'u', user: 'u', maxConcavity: 'd', thickness: 'd', walls: 'u', keyframes: 'u',
  hullPlanes: 'u' });
const HULL = layout({ size: 'u', vertices: 'u', vertexCount: 'u', triangles: 'u', triangleCount: 'u', volume: 'd' });
const SKIN = layout({ size: 'u', name: 'u', vertices: 'u', vertexCount: 'u', triangles: 'u', triangleCount: 'u',
  joints: 'u', weights: 'u', jointsPerVertex: 'u', jointFromModel: 'u', jointCount: 'u', poses: 'u', poseCount: 'u' });
const CHARACTER = layout({ size: 'u', map: 'u', hidden: 'u', hiddenCount: 'u', expressions: 'u', expressionCount: 'u',
  bodyResolution: 'd', thickness: 'd', walls: 'u' });
const BODY = layout({ size: 'u', parts: 'u', hullVertices: 'u', cover: 'd', threads: 'u', progress: 'u', user: 'u' });

const indexOf = (list, value, name) => {
  const index = list.indexOf(value);
  if (index >= 0) return index;
  const known = list.filter((one) => one !== undefined).map((one) => `"${one}"`).join(', ');
  throw new LoricaError('invalid argument', `${name}: found ${JSON.stringify(value)}, expected one of ${known}`);
};

/// Frees what is not referred to any more; free() does so at once.
const release = ({ core, owned }) => {
  for (const [free, address] of owned) if (!core.broken) core.call(free, address);
};
const forgotten = new FinalizationRegistry(release);

class Handle {
  /// @param free  the function that frees it
  constructor(core, address, free) {
    this.core = core;
    this.address = address;
    this.owned = [[free, address]];
    forgotten.register(this, { core, owned: this.owned }, this);
  }
  get handle() {
    if (this.address === 0) throw new LoricaError('invalid argument', 'it was freed');
    return this.address;
  }
  /// Gives its memory back. Views of it must not be used any more.
  free() {
    if (this.address === 0) return;
    forgotten.unregister(this);
    release(this);
    this.address = 0;
  }
}

/// The module and its memory.
class Core {
  constructor() {
    this.progress = null;
    this.broken = null;
  }

  /// Asks the module; what ends it (it has no memory left) is an error of all later calls too.
  call(name, ...args) {
    if (this.broken) throw this.broken;
    try {
      return this.exports[name](...args);
    } catch (error) {
      if (error === this.thrown) throw error;  // by the caller's own function
      this.broken = new LoricaError('failure', `Lorica ended, probably for want of memory; load it again (${error.message})`);
      throw this.broken;
    }
  }

  view() {
    if (this.data?.buffer !== this.exports.memory.buffer) this.data = new DataView(this.exports.memory.buffer);
    return this.data;
  }

  text(address) {
    if (address === 0) return '';
    const bytes = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(address, bytes.indexOf(0, address)));
  }

  check(status) {
    if (status !== 0) throw new LoricaError(STATUS[status] ?? 'failure', this.text(this.call('lorica_last_error')));
  }

  /// Runs `work` with memory that is given back after it: take(values, Type) is where they lie in the module.
  borrowing(work) {
    const taken = [];
    const room = (bytes) => {
      const address = this.call('malloc', Math.max(bytes, 8));
      if (address === 0) throw new LoricaError('failure', 'out of memory');
      taken.push(address);
      return address;
    };
    const take = (values, Type) => {
      const address = room(values.length * Type.BYTES_PER_ELEMENT);
      new Type(this.exports.memory.buffer, address, values.length).set(values);
      return address;
    };
    const pack = (struct, values) => {
      const address = room(struct.size);
      new Uint8Array(this.exports.memory.buffer, address, struct.size).fill(0);
      for (const [name, value] of Object.entries({ size: struct.size, ...values })) {
        if (struct.kinds[name] === 'd') this.view().setFloat64(address + struct.offsets[name], value, true);
        else this.view().setInt32(address + struct.offsets[name], value, true);
      }
      return address;
    };
    try {
      return work({ room, take, pack });
    } finally {
      if (!this.broken) for (const address of taken) this.call('free', address);
    }
  }

  /// A new handle: `make` gets where its address is to be written.
  made(make) {
    return this.borrowing((memory) => {
      const out = memory.room(4);
      this.check(make(memory, out));
      return this.view().getUint32(out, true);
    });
  }

  /// Runs work that reports: onProgress(done, wanted) returns false to cancel.
  reporting(onProgress, work) {
    const before = this.progress;
    this.progress = onProgress ?? null;
    try {
      return work(onProgress ? this.call('progress_function') : 0);
    } finally {
      this.progress = before;
    }
  }

  bytesOf(name, handle) {
    return this.borrowing(({ room }) => {
      const count = room(4);
      this.check(this.call(name, handle, 0, 0, count));
      const size = this.view().getUint32(count, true), bytes = room(size);
      this.check(this.call(name, handle, bytes, size, count));
      return new Uint8Array(this.exports.memory.buffer, bytes, size).slice();
    });
  }

  packedMesh({ take, pack }, positions, indices) {
    if (positions.length % 3 !== 0 || indices.length % 3 !== 0) {
      throw new LoricaError('invalid argument', `found ${positions.length} numbers of positions and ${indices.length} ` +
        'indices, expected multiples of 3');
    }
    return pack(MESH, { vertices: take(positions, Float64Array), vertexCount: positions.length / 3,
      triangles: take(indices, Int32Array), triangleCount: indices.length / 3 });
  }
}

const number = (options, name) => {
  const value = options[name] ?? 0;
  if (typeof value === 'number') return value;
  throw new LoricaError('invalid argument', `${name}: found ${JSON.stringify(value)}, expected a number`);
};

/// A decomposed mesh.
export class Parts extends Handle {
  constructor(core, address) {
    super(core, address, 'lorica_parts_free');
    this.count = core.call('lorica_parts_count', address);
    this.error = core.call('lorica_parts_error', address);
    this.repaired = core.text(core.call('lorica_parts_repaired', address));
    this.warning = core.text(core.call('lorica_parts_warning', address));
    this.hash = BigInt.asUintN(64, core.call('lorica_parts_hash', address)).toString(16).padStart(16, '0');
  }
  /// The hulls: positions (x y z of each vertex), indices (three of each triangle), volume; copies.
  get hulls() {
    const { core, handle } = this;
    return core.borrowing(({ pack }) => {
      const hull = pack(HULL, {});
      const field = (name) => core.view().getUint32(hull + HULL.offsets[name], true);
      return Array.from({ length: this.count }, (_, part) => {
        core.check(core.call('lorica_parts_hull', handle, part, hull));
        const { buffer } = core.exports.memory;
        return { positions: new Float64Array(buffer, field('vertices'), 3 * field('vertexCount')).slice(),
          indices: new Int32Array(buffer, field('triangles'), 3 * field('triangleCount')).slice(),
          volume: core.view().getFloat64(hull + HULL.offsets.volume, true) };
      });
    });
  }
  /// The bytes of a .lorica file.
  bytes() {
    return this.core.bytesOf('lorica_parts_bytes', this.handle);
  }
}

/// A decomposed character.
export class Body extends Handle {
  constructor(core, address, jointCount, notes) {
    super(core, address, 'lorica_body_free');
    this.jointCount = jointCount;
    this.notes = notes;
    this.partCount = core.call('lorica_body_part_count', address);
    this.warning = core.text(core.call('lorica_body_warning', address));
  }
  /// The bytes of a .lorica file.
  bytes() {
    return this.core.bytesOf('lorica_body_bytes', this.handle);
  }
  /// One that moves; any number may.
  live() {
    const address = this.core.made((_, out) => this.core.call('lorica_live_make', this.handle, out));
    return new Live(this.core, address, this);
  }
}

/// A body that moves. Each frame: update(), then `hulls`. Nothing is allocated in a frame.
export class Live extends Handle {
  constructor(core, address, body) {
    super(core, address, 'lorica_live_free');
    this.body = body;  // not freed before this
    const { partCount, jointCount } = body;
    this.scratch = core.call('malloc', 8 * (16 * jointCount + HULL.size / 8 + 16));
    this.owned.push(['free', this.scratch]);
    this.hullAt = this.scratch + 8 * 16 * jointCount;
    this.rayAt = this.hullAt + HULL.size;
    this.hulls = Array.from({ length: partCount }, () => ({ positions: new Float64Array(), vertexCount: 0,
      indices: new Int32Array(), triangleCount: 0 }));
    this.hit = { part: -1, distance: Infinity, position: new Float64Array(3), normal: new Float64Array(3) };
    this.refresh();
  }

  /// Views of the module's memory, which moves when it grows.
  refresh() {
    const { core } = this, { buffer } = core.exports.memory;
    if (this.buffer === buffer) return;
    this.buffer = buffer;
    core.view();
    this.matrices = new Float64Array(buffer, this.scratch, 16 * this.body.jointCount);
    this.ray = new Float64Array(buffer, this.rayAt, 14);
    for (const hull of this.hulls) hull.positions = hull.indices = null;
  }

  /// Moves it. @param worldFromJoint  16 numbers of each joint, by columns: three.js' bone.matrixWorld.elements
  update(worldFromJoint) {
    const { core, handle, body } = this;
    if (worldFromJoint.length !== 16 * body.jointCount) {
      throw new LoricaError('invalid argument', `found ${worldFromJoint.length} numbers, expected ${16 * body.jointCount}`);
    }
    this.refresh();
    this.matrices.set(worldFromJoint);
    core.check(core.call('lorica_live_pose', handle, this.scratch, body.jointCount));
    this.refresh();
    const data = core.view(), at = this.hullAt, { offsets } = HULL;
    data.setUint32(at, HULL.size, true);
    for (let p = 0; p < this.hulls.length; ++p) {
      core.check(core.call('lorica_live_hull', handle, p, at));
      const hull = this.hulls[p];
      hull.vertexCount = data.getUint32(at + offsets.vertexCount, true);
      hull.triangleCount = data.getUint32(at + offsets.triangleCount, true);
      const vertices = data.getUint32(at + offsets.vertices, true), triangles = data.getUint32(at + offsets.triangles, true);
      // A view of the whole room of a hull stays; only the first vertexCount and triangleCount count.
      if (hull.positions?.byteOffset !== vertices || hull.positions.length < 3 * hull.vertexCount) {
        hull.positions = new Float64Array(this.buffer, vertices, 3 * hull.vertexCount);
      }
      if (hull.indices?.byteOffset !== triangles || hull.indices.length < 3 * hull.triangleCount) {
        hull.indices = new Int32Array(this.buffer, triangles, 3 * hull.triangleCount);
      }
    }
  }

  /// Where a ray enters the hulls, or a ball that is swept along it touches them. @return the same object each time, whose
  /// `part` is -1 if nothing is hit
  castRay(origin, direction, reach = Infinity, radius = 0) {
    this.refresh();
    const { core, ray, hit } = this, at = this.rayAt;
    ray.set(origin);
    ray.set(direction, 3);
    core.check(core.call('lorica_live_cast_rays', this.handle, at, 1, reach, radius, 0, at + 8 * 6, at + 8 * 7, at + 8 * 8,
      at + 8 * 11));
    hit.part = core.view().getInt32(at + 8 * 6, true);
    hit.distance = ray[7];
    hit.position.set(ray.subarray(8, 11));
    hit.normal.set(ray.subarray(11, 14));
    return hit;
  }
}

/// Lorica, loaded. See load().
export class Lorica {
  constructor(core) {
    this.core = core;
    this.version = core.text(core.call('lorica_version'));
  }

  /// Convex parts of a mesh that together hold every vertex of its surface.
  decompose(positions, indices, options = {}) {
    return this.parts(positions, indices, options, (mesh, settings, out) =>
      this.core.call('lorica_decompose', mesh, settings, out));
  }

  /// The parts in the bytes of a .lorica file that was made of this mesh.
  openParts(bytes, positions, indices, options = {}) {
    return this.parts(positions, indices, options, (mesh, settings, out, { take }) =>
      this.core.call('lorica_parts_from_bytes', take(bytes, Uint8Array), bytes.length, mesh, settings, out));
  }

  parts(positions, indices, options, make) {
    const { core } = this;
    return core.reporting(options.onProgress, (progress) => new Parts(core, core.made((memory, out) => {
      const settings = memory.pack(DECOMPOSE, { parts: number(options, 'parts'),
        preset: indexOf(PRESETS, options.preset ?? 'fast', 'preset'), maxError: number(options, 'maxError'),
        maxDistance: number(options, 'maxDistance'), hullVertices: number(options, 'hullVertices'),
        closedBody: indexOf(CLOSED, options.closedBody ?? 'if needed', 'closedBody'), progress,
        maxConcavity: number(options, 'concavity'), thickness: number(options, 'thickness'),
        walls: indexOf(WALLS, options.walls ?? 'auto', 'walls'), hullPlanes: number(options, 'hullPlanes') });
      return make(core.packedMesh(memory, positions, indices), settings, out, memory);
    })));
  }

  /// Parts of a skinned mesh, fitted to poses of it.
  makeBody(skin, options = {}) {
    const { core } = this;
    return core.reporting(options.onProgress, (progress) => this.body(skin, options, ({ pack }, character, out) =>
      core.call('lorica_body_make', character, pack(BODY, { parts: number(options, 'parts'),
        hullVertices: number(options, 'hullVertices'), cover: number(options, 'cover'), progress }), out)));
  }

  /// The body in the bytes of a .lorica file that was made of this skinned mesh.
  openBody(bytes, skin, options = {}) {
    return this.body(skin, options, ({ take }, character, out) =>
      this.core.call('lorica_body_from_bytes', character, take(bytes, Uint8Array), bytes.length, out));
  }

  body(skin, options, make) {
    const { core } = this, { positions, indices, joints, weights, inverseBind, jointsPerVertex = 4 } = skin;
    const jointCount = inverseBind.length / 16, vertexCount = positions.length / 3;
    const poses = skin.poses ?? inverseOf(inverseBind);
    for (const [name, found, wanted] of [['joints', joints.length, vertexCount * jointsPerVertex],
      ['weights', weights.length, vertexCount * jointsPerVertex], ['inverseBind', inverseBind.length, 16 * Math.round(jointCount)],
      ['poses', poses.length, 16 * jointCount * Math.max(1, Math.round(poses.length / 16 / jointCount))]]) {
      if (found !== wanted) throw new LoricaError('invalid argument', `${name}: found ${found} numbers, expected ${wanted}`);
    }
    const character = core.made((memory, out) => {
      const { take, pack } = memory;
      const name = new TextEncoder().encode(`${skin.name ?? 'character'}\0`);
      const given = pack(SKIN, { name: take(name, Uint8Array), vertices: take(positions, Float64Array), vertexCount,
        triangles: take(indices, Int32Array), triangleCount: indices.length / 3, joints: take(joints, Int32Array),
        weights: take(weights, Float64Array), jointsPerVertex, jointFromModel: take(inverseBind, Float64Array), jointCount,
        poses: take(poses, Float64Array), poseCount: poses.length / 16 / jointCount });
      return core.call('lorica_character_make', given, pack(CHARACTER, { thickness: number(options, 'thickness'),
        walls: indexOf(CHARACTER_WALLS, options.walls, 'walls') }), out);
    });
    try {
      const notes = core.text(core.call('lorica_character_notes', character)).split('\n').filter(Boolean);
      return new Body(core, core.made((memory, out) => make(memory, character, out)), jointCount, notes);
    } finally {
      if (!core.broken) core.call('lorica_character_free', character);
    }
  }
}

/// The bind pose, if a program gives no poses. @param matrices  affine, by columns
const inverseOf = (matrices) => {
  const inverse = new Float64Array(matrices.length);
  for (let i = 0; i < matrices.length; i += 16) {
    const m = matrices.subarray ? matrices.subarray(i, i + 16) : matrices.slice(i, i + 16), out = inverse.subarray(i, i + 16);
    const cross = (a, b) => [m[a + 1] * m[b + 2] - m[a + 2] * m[b + 1], m[a + 2] * m[b] - m[a] * m[b + 2],
      m[a] * m[b + 1] - m[a + 1] * m[b]];
    const rows = [cross(4, 8), cross(8, 0), cross(0, 4)];
    const determinant = m[0] * rows[0][0] + m[1] * rows[0][1] + m[2] * rows[0][2];
    rows.forEach((row, r) => {
      row.forEach((value, c) => { out[4 * c + r] = value / determinant; });
      out[12 + r] = -(row[0] * m[12] + row[1] * m[13] + row[2] * m[14]) / determinant;
    });
    out[15] = 1;
  }
  return inverse;
};

/// Loads Lorica: compiles its module, which lies beside this file. Each is a memory of its own.
/// @param wasm  bytes, a WebAssembly.Module, or an address to fetch; none = lorica.wasm beside this file
export async function load(wasm = new URL('./lorica.wasm', import.meta.url)) {
  let module = wasm;
  if (typeof wasm === 'string' || wasm instanceof URL) {
    const address = new URL(wasm, import.meta.url);
    module = address.protocol === 'file:' ? await (await import('node:fs/promises')).readFile(address)
      : await (await fetch(address)).arrayBuffer();
  }
  if (!(module instanceof WebAssembly.Module)) module = await WebAssembly.compile(module);
  const core = new Core();
  const given = {
    progress: (done, wanted) => {
      try {
        return core.progress(done, wanted) === false ? 0 : 1;
      } catch (error) {
        core.thrown = error;
        throw error;
      }
    },
    clock_time_get: (id, precision, out) => {
      core.view().setBigUint64(out, BigInt(Math.round(1e6 * performance.now())), true);
      return 0;
    },
    proc_exit: (status) => { throw new Error(`ended with ${status}`); },
  };
  // All else that the C library asks of a system is not there: 52 = ENOSYS.
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] = given[name] ?? (() => 52);
  }
  core.exports = (await WebAssembly.instantiate(module, imports)).exports;
  core.exports._initialize?.();
  return new Lorica(core);
}
