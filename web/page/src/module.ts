// The module in workers, so that nothing that it computes stops the page.
import workerText from "worker:text";

/** A request that the module refused, or could not answer. */
export class Refusal extends Error {}

/** Longest time for one answer, in milliseconds. */
const PATIENCE = 20_000;

let compiled: Promise<WebAssembly.Module> | undefined;

/** Unpacks and compiles the module, once for all workers. */
export function compile(): Promise<WebAssembly.Module> {
  compiled ??= (async () => {
    if (typeof WebAssembly !== "object" || typeof DecompressionStream !== "function") {
      throw new Refusal("This browser cannot run the playground: it has no WebAssembly, or cannot unpack it. Take a newer one.");
    }
    const base64 = document.getElementById("module")?.textContent ?? "";
    const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  })().catch((error: unknown) => {
    throw error instanceof Refusal ? error : new Refusal(`The page is damaged: load it again. (${String(error)})`);
  });
  return compiled;
}

interface Waiting {
  resolve: (answer: never) => void;
  reject: (refusal: Refusal) => void;
  timer: number;
}

/** A worker that answers requests in their order. If it stops, the next request begins another one. */
export class Module {
  private worker: Worker | undefined;
  private waiting = new Map<number, Waiting>();
  private next = 0;

  /** Asks the module; a refusal is thrown. */
  async ask<T>(request: object, patience = PATIENCE): Promise<T> {
    const module = await compile();
    this.worker ??= this.begin(module);
    const id = this.next++;
    const answer = await new Promise<T & { error?: string }>((resolve, reject) => {
      const timer = window.setTimeout(() => this.stop("This takes too long and was stopped."), patience);
      this.waiting.set(id, { resolve, reject, timer });
      this.worker?.postMessage({ id, request: JSON.stringify(request) });
    });
    if (answer !== null && typeof answer === "object" && typeof answer.error === "string") throw new Refusal(answer.error);
    return answer;
  }

  /** Ends the worker with all its memory; requests that wait are refused. */
  stop(sentence: string): void {
    this.worker?.terminate();
    this.worker = undefined;
    for (const { reject, timer } of this.waiting.values()) {
      clearTimeout(timer);
      reject(new Refusal(sentence));
    }
    this.waiting.clear();
  }

  private begin(module: WebAssembly.Module): Worker {
    const address = URL.createObjectURL(new Blob([workerText], { type: "text/javascript" }));
    const worker = new Worker(address);
    URL.revokeObjectURL(address);
    worker.postMessage(module);
    worker.onmessage = ({ data }: MessageEvent<{ id: number; answer?: never; trap?: string }>) => {
      const waiting = this.waiting.get(data.id);
      if (data.trap !== undefined) {
        this.stop(`The module stopped, perhaps because it needs more than its 1 GB of memory (${data.trap}). Your text is kept.`);
      } else if (waiting) {
        clearTimeout(waiting.timer);
        this.waiting.delete(data.id);
        waiting.resolve(data.answer as never);
      }
    };
    worker.onerror = () => this.stop("The worker with the module could not run.");
    return worker;
  }
}
