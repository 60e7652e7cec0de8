// Bundles the page: `node build.mjs MODULE.wasm FOLDER` writes FOLDER/index.html, which contains everything it needs, so that it
// works from a folder, and without a network; and the licences of what it contains.
import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const [wasm, folder] = process.argv.slice(2);
const root = process.env.MDLE_ROOT;

// Files of the repository, as texts: `repository:plans/dock.mdle`.
const repository = {
  name: "repository",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^repository:/ }, ({ path }) => ({ path: path.slice("repository:".length), namespace: "repository" }));
    onLoad({ filter: /.*/, namespace: "repository" }, ({ path }) => ({ contents: readFileSync(join(root, path), "utf8"), loader: "text" }));
  },
};

// Packages whose code is in the page.
const packages = new Set();

async function bundled(entry, plugins = []) {
  const options = { bundle: true, minify: true, write: false, metafile: true, target: "es2022", format: "iife", charset: "utf8", legalComments: "none" };
  const { outputFiles, metafile } = await build({ entryPoints: [entry], ...options, plugins });
  for (const input of Object.keys(metafile.inputs)) {
    const [, name] = /node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input) ?? [];
    if (name) packages.add(name);
  }
  return outputFiles[0].text;
}

// The licence of a package, as it asks to be passed on.
function licence(name) {
  const folder = join("node_modules", name);
  const file = readdirSync(folder).find((file) => /^licen[sc]e/i.test(file));
  if (!file) throw new Error(`${name} has no licence`);
  const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
  return `${name} ${version}, ${license}\n\n${readFileSync(join(folder, file), "utf8").trim()}\n`;
}

const worker = await bundled("src/worker.ts");
const ofWorker = {
  name: "worker",
  setup({ onResolve, onLoad }) {
    onResolve({ filter: /^worker:text$/ }, () => ({ path: "text", namespace: "worker" }));
    onLoad({ filter: /.*/, namespace: "worker" }, () => ({ contents: worker, loader: "text" }));
  },
};
// In a script of HTML no text may end it.
const script = (await bundled("src/main.ts", [repository, ofWorker])).replaceAll("</script", "<\\/script");
const hash = createHash("sha256").update(script).digest("base64");
const policy = [
  "default-src 'none'", `script-src 'sha256-${hash}' blob: 'wasm-unsafe-eval'`, "style-src 'unsafe-inline'", "img-src blob: data:",
  "worker-src blob:", "base-uri 'none'", "form-action 'none'",
].join("; ");
const parts = {
  POLICY: policy,
  STYLE: readFileSync("src/style.css", "utf8"),
  SCRIPT: script,
  MODULE: gzipSync(readFileSync(wasm), { level: 9 }).toString("base64"),
};
const page = readFileSync("src/index.html", "utf8").replace(/\{\{([A-Z]+)\}\}/g, (_, name) => parts[name]);
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, "index.html"), page);
const line = `\n${"-".repeat(80)}\n\n`;
writeFileSync(join(folder, "THIRD-PARTY.txt"), `The page of the playground contains code of these packages.\n${line}${[...packages].sort().map(licence).join(line)}`);
const kilobytes = (bytes) => `${Math.round(bytes / 1000)} kB`;
console.log(`${join(folder, "index.html")}: ${kilobytes(page.length)}, compressed ${kilobytes(gzipSync(page, { level: 9 }).length)}`);
