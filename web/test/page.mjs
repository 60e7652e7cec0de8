// The page in Chromium, for tests.
import { accessSync } from "node:fs";
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const page = readFileSync(process.env.MDLE_PAGE);
const packed = gzipSync(page, { level: 9 });
export const sizes = { page: page.length, packed: packed.length };

/** Serves the page, packed, on this machine alone; returns its address and what ends it. */
export async function serve() {
  const server = createServer((request, response) => {
    const found = request.url === "/" || request.url === "/index.html";
    response.writeHead(found ? 200 : 404, found ? { "content-type": "text/html", "content-encoding": "gzip", "cache-control": "no-store" } : {});
    response.end(found ? packed : "");
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

export const tabOf = (tab, name) => tab.getByRole("tab", { name, exact: true });
