// The page in Chromium, for tests.
import { accessSync } from "node:fs";
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { gunzipSync, gzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const page = readFileSync(process.env.MDLE_PAGE);
const packed = gzipSync(page, { level: 9 });
export const sizes = { page: page.length, packed: packed.length };

/** Returns the page with a module that may have less memory, in pages of 64 kB: it runs out. */
function withMemory(most) {
  const html = page.toString();
  const base64 = /id="module">([^<]*)</.exec(html)[1];
  const module = gunzipSync(Buffer.from(base64, "base64"));
  let at = 8;
  const number = () => {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = module[at++];
      value += (byte & 127) * 2 ** shift;
      if (byte < 128) return value;
    }
  };
  for (;;) {
    const [section, length] = [module[at++], number()];
    if (section === 5) break;
    at += length;
  }
  // One memory, with a limit; then its size at first, and the limit.
  if (number() !== 1 || number() !== 1 || number() > most) throw new Error("the module has another memory");
  const from = at;
  number();
  for (let byte = from, left = most; byte < at; byte++, left >>= 7) module[byte] = (left & 127) | (byte + 1 < at ? 128 : 0);
  return gzipSync(html.replace(base64, gzipSync(module).toString("base64")));
}

/** Serves the page, packed, on this machine alone, and as `small` with little memory; returns its address and what ends it. */
export async function serve() {
  const small = withMemory(400);
  const server = createServer((request, response) => {
    const found = { "/": packed, "/index.html": packed, "/small": small }[request.url];
    response.writeHead(found ? 200 : 404, found ? { "content-type": "text/html", "content-encoding": "gzip", "cache-control": "no-store" } : {});
    response.end(found ?? "");
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return { address: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}

export async function browser() {
  const known = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-headless-shell"].filter(Boolean);
  const executablePath = known.find((path) => {
    try {
      accessSync(path);
      return true;
    } catch {
      return false;
    }
  });
  return chromium.launch({ executablePath, args: ["--no-sandbox"] });
}

/** Opens a page and fails if it reports an error, or asks for anything that is not itself. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ acceptDownloads: true, viewport: { width: 1360, height: 900 }, ...options });
  const tab = await context.newPage();
  const faults = [];
  tab.on("pageerror", (error) => faults.push(String(error)));
  tab.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  tab.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(address.split("#")[0]) && !/^(data|blob):/.test(url)) faults.push(`asked for ${url}`);
  });
  await tab.goto(address);
  return { tab, faults, context };
}

/** Waits until the text of the editor was checked. */
export async function checked(tab) {
  await tab.waitForFunction(() => document.querySelector("#problems")?.textContent !== "");
}

/** Replaces the text of the editor by typing. */
export async function type(tab, text) {
  await tab.locator(".cm-content").click();
  await tab.keyboard.press("Control+A");
  await tab.keyboard.press("Delete");
  await tab.keyboard.insertText(text);
}

/** Runs the plan to its end at once. */
export async function run(tab) {
  await tab.evaluate(() => delete document.documentElement.dataset.simulated);
  await tab.getByRole("button", { name: "Run", exact: true }).click();
  await tab.waitForFunction(() => document.documentElement.dataset.simulated !== undefined || document.querySelector("#status.bad"), null, { timeout: 60_000 });
}

/** Shows a turn by its number. */
export async function goTo(tab, turn) {
  await tab.locator("#time").evaluate((slider, turn) => {
    slider.value = String(turn);
    slider.dispatchEvent(new Event("input"));
  }, turn);
}

/** Shows the last turn of a run, and returns what the page says of its end. */
export async function ended(tab) {
  await goTo(tab, 1e9);
  return tab.locator("#status").innerText();
}

export const tabOf = (tab, name) => tab.getByRole("tab", { name, exact: true });
