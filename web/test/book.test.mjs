// A book with the playground in it: each plan has a link that opens it there.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { browser, checked, open } from "./page.mjs";

const { MDLE_BOOK: book, MDLE_ROOT: root } = process.env;

test("plans of the book open in the playground", async () => {
  const chromium = await browser();
  for (const page of ["first_plan", "loops"]) {
    const source = readFileSync(join(root, `docs/src/${page}.md`), "utf8");
    const plans = [...source.matchAll(/^```mdle.*\n([\s\S]*?)^```$/gm)].map(([, text]) => text).filter((text) => !/^\s*use\s/m.test(text));
    const { tab, context } = await open(chromium, pathToFileURL(join(book, `${page}.html`)).href);
    const links = tab.locator(".try-it a");
    assert.ok(plans.length > 1);
    assert.equal(await links.count(), plans.length, page);
    await links.first().click();
    await tab.waitForURL(/playground\/index\.html#plan=/);
    await checked(tab);
    const lines = await tab.locator(".cm-line").allInnerTexts();
    assert.equal(lines.map((line) => line.replace(/\n/g, "")).join("\n").trim(), plans[0].trim());
    await tab.getByText("Five words to begin with").click();
    await tab.getByRole("link", { name: "the book" }).click();
    assert.equal(tab.url(), pathToFileURL(join(book, "index.html")).href);
    await context.close();
  }
  await chromium.close();
});
