/** Numbers of any kind: three.js' Float32Array, or an Array. */
export type Numbers = ArrayLike<number>;

/** What a call refused. */
export class LoricaError extends Error {
  readonly kind: 'bad format' | 'bad mesh' | 'invalid argument' | 'unsupported' | 'cancelled' | 'failure';
}

/** Return false to cancel. `wanted` is how many parts it will be, or 0 if unknown. */
export type Progress = (done: number, wanted: number) => boolean | void;

/** How a mesh is divided. Lengths are in the mesh's unit. */
export interface DecomposeOptions {
  /** At most; without it and without a limit below, 16. */
  parts?: number;
  /** The fewest parts whose concavity, as CoACD measures it, is at most this, such as 0.05. */
  concavity?: number;
  /** Stop when the hulls have at most this much more volume, relative to the mesh. */
  maxError?: number;
  /** The fewest parts with no point of a hull farther than this from the surface. */
  maxDistance?: number;
  /** Hulls with more vertices are enclosed in larger ones with at most so many. At least 4. */
  hullVertices?: number;
  /** The same for planes: flat faces, of any number of corners. */
  hullPlanes?: number;
  /** How hard it tries: 'fast' unless given; 'paper' is the algorithm as published. */
  preset?: 'fast' | 'paper' | 'quality';
  /** What an open surface is: 'auto' makes thin walls where space behind it can be reached. */
  walls?: 'auto' | 'solid' | 'shell';
  /** Of thin walls; else 1 % of the longest side. */
  thickness?: number;
  /** When a closed surface takes the place of the mesh's own. */
  closedBody?: 'if needed' | 'never' | 'always';
  onProgress?: Progress;
}

/** A convex polyhedron; triangles run counter-clockwise seen from outside. */
export interface Hull {
  /** x y z of each vertex. */
  positions: Float64Array;
  /** Three vertices of each triangle. */
  indices: Int32Array;
  volume: number;
}

/** A decomposed mesh. */
export class Parts {
  readonly count: number;
  /** Copies, which stay. */
  readonly hulls: Hull[];
  /** (volume of the hulls - volume of the mesh) / volume of the mesh. */
  readonly error: number;
  /** What was done to the mesh before; '' = nothing. */
  readonly repaired: string;
  /** A sentence if the hulls are more than 50 % larger than the mesh; '' if not. */
  readonly warning: string;
  /** The same on every system: what `lorica decompose` prints. */
  readonly hash: string;
  /** A .lorica file. */
  bytes(): Uint8Array;
  free(): void;
}

/** A skinned mesh in its bind pose [m]. Matrices have 16 numbers, by columns, as glTF and three.js have them. */
export interface Skin {
  name?: string;
  positions: Numbers;
  indices: Numbers;
  /** Joints that move a vertex, jointsPerVertex for each. */
  joints: Numbers;
  weights: Numbers;
  /** 4 unless given. */
  jointsPerVertex?: number;
  inverseBind: Numbers;
  /** World from joint, a matrix of each joint, pose after pose: what the parts are fitted to; else the bind pose. */
  poses?: Numbers;
}

export interface BodyOptions {
  /** At most; 16 unless given. */
  parts?: number;
  /** At most so many in each hull and frame, at least 4. */
  hullVertices?: number;
  /** Use fewer points, so that the surface sticks out by at most this before hulls are enlarged to hold it [m]. */
  cover?: number;
  /** An open surface is a solid, or gets thin walls. */
  walls?: 'auto' | 'shell';
  thickness?: number;
  onProgress?: Progress;
}

/** A decomposed character. */
export class Body {
  readonly partCount: number;
  readonly jointCount: number;
  /** What was repaired in its mesh. */
  readonly notes: string[];
  readonly warning: string;
  /** A .lorica file. */
  bytes(): Uint8Array;
  live(): Live;
  free(): void;
}

/** A hull of this frame: views of memory that the next update() writes. Only the first vertexCount and triangleCount count. */
export interface LiveHull {
  positions: Float64Array;
  vertexCount: number;
  indices: Int32Array;
  triangleCount: number;
}

export interface Hit {
  /** -1 = nothing is hit. */
  part: number;
  distance: number;
  position: Float64Array;
  /** Unit, outward. */
  normal: Float64Array;
}

/** A body that moves. After the first frames nothing is allocated. */
export class Live {
  /** One of each part, in world space [m]. */
  readonly hulls: LiveHull[];
  /** @param worldFromJoint 16 numbers of each joint, by columns */
  update(worldFromJoint: Numbers): void;
  /** The nearest hull on the way of a ray, or of a ball that is swept along it. The same object each time. */
  castRay(origin: Numbers, direction: Numbers, reach?: number, radius?: number): Hit;
  free(): void;
}

export class Lorica {
  readonly version: string;
  decompose(positions: Numbers, indices: Numbers, options?: DecomposeOptions): Parts;
  openParts(bytes: Uint8Array, positions: Numbers, indices: Numbers, options?: DecomposeOptions): Parts;
  makeBody(skin: Skin, options?: BodyOptions): Body;
  openBody(bytes: Uint8Array, skin: Skin, options?: BodyOptions): Body;
}

/** @param wasm bytes, a module, or an address; else lorica.wasm beside this file */
export function load(wasm?: BufferSource | WebAssembly.Module | string | URL): Promise<Lorica>;
