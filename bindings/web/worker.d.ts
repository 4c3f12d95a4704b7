import type { BodyOptions, DecomposeOptions, Hull, Numbers, Skin } from './lorica.js';

export interface MadeParts {
  hulls: Hull[];
  /** A .lorica file. */
  bytes: Uint8Array;
  error: number;
  repaired: string;
  warning: string;
  hash: string;
}

export interface MadeBody {
  /** A .lorica file, for Lorica.openBody(). */
  bytes: Uint8Array;
  partCount: number;
  notes: string[];
  warning: string;
}

/** Ends the Worker at once when it is aborted; the promise is rejected with a LoricaError of kind 'cancelled'. */
interface Cancellable {
  signal?: AbortSignal;
}

/** Each call runs in a Worker of its own, in browsers and in Node. */
export function startWorker(wasm?: BufferSource | WebAssembly.Module | string | URL): {
  decompose(positions: Numbers, indices: Numbers, options?: DecomposeOptions & Cancellable): Promise<MadeParts>;
  makeBody(skin: Skin, options?: BodyOptions & Cancellable): Promise<MadeBody>;
};
