/// Lorica beside the page: decompositions run in a Worker, so that nothing waits for them, and can be cancelled at any time.
/// The same in Node. `startWorker()` is for the page; the other half of this file is the Worker itself.
import { load, LoricaError } from './lorica.js';

const inNode = typeof process === 'object' && process.versions?.node !== undefined;
const threads = inNode ? await import('node:worker_threads') : null;

/// What is asked of the Worker.
const answers = {
  decompose(lorica, { positions, indices, options }) {
    const parts = lorica.decompose(positions, indices, options);
    const { error, repaired, warning, hash } = parts;
    const result = { hulls: parts.hulls, bytes: parts.bytes(), error, repaired, warning, hash };
    parts.free();
    return result;
  },
  makeBody(lorica, { skin, options }) {
    const body = lorica.makeBody(skin, options);
    const { notes, warning, partCount } = body;
    const result = { bytes: body.bytes(), notes, warning, partCount };
    body.free();
    return result;
  },
};

const answer = async (port, { wasm, what, given }) => {
  try {
    const lorica = await load(wasm);
    const onProgress = (done, wanted) => { port.postMessage({ done, wanted }); };
    port.postMessage({ result: answers[what](lorica, { ...given, options: { ...given.options, onProgress } }) });
  } catch (error) {
    port.postMessage({ problem: error.message, kind: error.kind ?? 'failure' });
  }
};
if (threads && !threads.isMainThread && threads.workerData === 'lorica') {
  threads.parentPort.once('message', (message) => answer(threads.parentPort, message));
} else if (!inNode && typeof WorkerGlobalScope === 'function' && globalThis instanceof WorkerGlobalScope &&
           globalThis.name === 'lorica') {
  globalThis.onmessage = ({ data }) => answer(globalThis, data);
}

const start = (wasm, what, given, { onProgress, signal } = {}) => new Promise((resolve, reject) => {
  const cancelled = () => new LoricaError('cancelled', 'cancelled');
  if (signal?.aborted) { reject(cancelled()); return; }
  const url = new URL('./worker.js', import.meta.url);
  const worker = threads ? new threads.Worker(url, { workerData: 'lorica' })
    : new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'lorica' });
  const listen = (name, act) => {
    if (threads) worker.on(name, act);
    else worker.addEventListener(name, (event) => act(name === 'message' ? event.data : event));
  };
  const end = (settle, value) => {
    signal?.removeEventListener('abort', stop);
    worker.terminate();
    settle(value);
  };
  const stop = () => end(reject, cancelled());
  signal?.addEventListener('abort', stop);
  listen('message', (message) => {
    if (message.result) end(resolve, message.result);
    else if (message.problem) end(reject, new LoricaError(message.kind, message.problem));
    else onProgress?.(message.done, message.wanted);
  });
  listen('error', (error) => end(reject, new LoricaError('failure', error.message ?? 'the Worker cannot be started')));
  worker.postMessage({ wasm, what, given });
});

/// Each call has a Worker of its own. @param wasm  as load() takes it
export function startWorker(wasm) {
  const module = wasm instanceof URL ? wasm.href : wasm;
  return {
    /// As Lorica.decompose(), but the result is data: hulls, bytes of the .lorica file, error, repaired, warning, hash.
    decompose: (positions, indices, { onProgress, signal, ...options } = {}) =>
      start(module, 'decompose', { positions, indices, options }, { onProgress, signal }),
    /// As Lorica.makeBody(), but the result is the bytes for Lorica.openBody().
    makeBody: (skin, { onProgress, signal, ...options } = {}) =>
      start(module, 'makeBody', { skin, options }, { onProgress, signal }),
  };
}
