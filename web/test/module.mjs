// The module in Node.js, for tests: `ask(request)` returns its answer.
import { readFileSync } from "node:fs";

const encoder = new TextEncoder();
const decoder = new TextDecoder();

export const bytes = readFileSync(process.env.MDLE_MODULE);

export async function begin() {
  const { instance } = await WebAssembly.instantiate(bytes, {});
  const { memory, mdle_room, mdle_answer, mdle_answer_at } = instance.exports;
  return (request) => {
    const text = encoder.encode(typeof request === "string" ? request : JSON.stringify(request));
    const at = mdle_room(text.length);
    new Uint8Array(memory.buffer, at, text.length).set(text);
    const length = mdle_answer();
    return JSON.parse(decoder.decode(new Uint8Array(memory.buffer, mdle_answer_at(), length)));
  };
}
