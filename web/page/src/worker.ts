// A worker with the module: it answers one request after the other. A trap of the module ends it.

interface Exports {
  memory: WebAssembly.Memory;
  mdle_room(length: number): number;
  mdle_answer(): number;
  mdle_answer_at(): number;
}

const encoder = new TextEncoder();
const decoder = new TextDecoder();
let exports: Promise<Exports>;

function answer(module: Exports, request: string): string {
  const bytes = encoder.encode(request);
  const at = module.mdle_room(bytes.length);
  new Uint8Array(module.memory.buffer, at, bytes.length).set(bytes);
  const length = module.mdle_answer();
  return decoder.decode(new Uint8Array(module.memory.buffer, module.mdle_answer_at(), length));
}

self.onmessage = async ({ data }: MessageEvent<WebAssembly.Module | { id: number; request: string }>) => {
  if (data instanceof WebAssembly.Module) {
    exports = WebAssembly.instantiate(data, {}).then((instance) => instance.exports as unknown as Exports);
    return;
  }
  const { id, request } = data;
  try {
    postMessage({ id, answer: JSON.parse(answer(await exports, request)) });
  } catch (error) {
    postMessage({ id, trap: String(error) });
  }
};
