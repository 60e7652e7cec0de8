// Whatever a page asks, the module answers, or stops alone: never the page.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { begin, bytes } from "./module.mjs";

const root = process.env.MDLE_ROOT;
const office = readFileSync(join(root, "targets/sim/simulator/worlds/office.toml"), "utf8");
const dock = readFileSync(join(root, "plans/dock.mdle"), "utf8");
let ask;
before(async () => (ask = await begin()));

test("requests of other versions are refused", () => {
  for (const request of ["", "{}", "[]", "null", '{"ask":"fly"}', '{"ask":"check"}', '{"ask":"step","turns":-1}', '{"ask":"check","text":7}']) {
    assert.match(ask(request).error, /^the request is not one of this version/, request);
  }
  assert.equal(ask({ ask: "step", turns: 1 }).error, "no run has begun");
});

test("a setup that cannot be names its field", () => {
  const refused = (setup) => ask({ ask: "begin", text: dock, world: office, ...setup }).error;
  assert.match(refused({ world: "[[wall]]\npoints = 7" }), /^world:2:/);
  assert.match(refused({ start: "1,2" }), /^start: expected x,y,heading/);
  assert.match(refused({ start: "100,100,0" }), /^start: that is off the floor/);
  assert.match(refused({ start_noise: "0.1,5" }), /^start noise: it needs a seed/);
  assert.match(refused({ body: "fish" }), /^body: expected/);
  assert.match(refused({ without: "wings" }), /^without: "wings"/);
  assert.match(refused({ limit: 1e9 }), /^time limit/);
  assert.match(refused({ battery: 101 }), /^battery: expected/);
  assert.match(refused({ goal: "1,2" }), /^goal: expected/);
  assert.match(ask({ ask: "ready", world: office, start: "1,2" }).error, /^start: expected/);
  assert.deepEqual(ask({ ask: "ready", world: office, start: "1,0.1,90" }).robot.pose.slice(0, 2), [1, 0.1]);
  assert.match(refused({ text: "{ Dock (bumper)" }), /E0\d\d\d/);
});

test("a plan that makes 4,096 transitions in each turn is run", () => {
  const text = "{ Spin (wait 1h)\n  ExecPlan inf {\n    (Atom (NOT bumper) stop)\n    (Atom (r0 > 0m OR r0 < 1m OR wait 0s) stop)\n  }\n}\n";
  assert.equal(ask({ ask: "begin", text, world: office, limit: 600 }).error, undefined);
  const { turns } = ask({ ask: "step", turns: 100 });
  assert.ok(turns.length > 0 && turns.length < 100, `${turns.length} turns`);
  assert.deepEqual([turns[0].skipped, turns[1].skipped], [[[0, 2048], [1, 2048]], [[0, 2047], [1, 2048]]]);
  assert.ok(turns.every(({ made, fired }) => made === 4096 && fired.length <= 41));
  assert.ok(ask({ ask: "why", turn: 0 }).moments.length <= 42);
  const { end } = ask({ ask: "trial", text, world: office, limit: 10 });
  assert.equal(end, "limit");
  // What is kept of ten minutes of it has room.
  let made = turns.length;
  while (process.env.MDLE_LONG !== undefined && made < 6001) {
    const { turns, end } = ask({ ask: "step", turns: 100 });
    made += turns.length;
    assert.equal(end === null, made < 6001);
  }
});

test("a plan that never ends is ended by the limit", () => {
  const text = "{ Sit (bumper) (Atom (wait inf) stop) }";
  ask({ ask: "begin", text, world: office, limit: 3600 });
  const { turns, end } = ask({ ask: "step", turns: 1e9 });
  assert.deepEqual([turns.length, end], [36001, { how: "limit", judged: "astray" }]);
});

test("texts and worlds that are too large are refused with a sentence", () => {
  const started = performance.now();
  const text = "{ A (bumper) (Atom (wait 1) stop) }\n".repeat(140_000);
  assert.ok(text.length > 5_000_000);
  const { diagnostics } = ask({ ask: "diagnose", text });
  assert.ok(diagnostics.length > 0 && diagnostics.length <= 101);
  // A wall in each of many squares.
  const walls = Array.from({ length: 120_000 }, (_, n) => `[[wall]]\npoints = [[${n % 400}, ${Math.floor(n / 400)}], [${(n % 400) + 0.5}, ${Math.floor(n / 400)}]]\n`).join("");
  assert.match(ask({ ask: "floor", world: walls.repeat(2) }).error, /too large/);
  assert.match(ask({ ask: "floor", world: walls }).error, /corners are too many to be drawn/);
  console.log(`${((performance.now() - started) / 1000).toFixed(1)} s`);
});

test("deep brackets do not overflow the stack", () => {
  const text = "{ A (bumper) " + "(".repeat(100_000) + ")".repeat(100_000) + " }";
  assert.ok(ask({ ask: "diagnose", text }).diagnostics.length > 0);
});

test("the editor is told edits, words and texts", () => {
  const { diagnostics, plans, tokens } = ask({ ask: "diagnose", text: "{ Dock (bumbper)\n  (Atom (wait 1) stop)\n}\n" });
  assert.deepEqual([diagnostics[0].code, diagnostics[0].range, plans], ["E0201", [0, 8, 0, 15], ["Dock"]]);
  const used = ask({ ask: "diagnose", text: "{ Outer (bumper) Inner }\n{ Inner (wait 1) (Atom (null) stop) }\n" });
  assert.deepEqual([used.plans, used.roots], [["Outer", "Inner"], ["Outer"]]);
  assert.deepEqual(diagnostics[0].fixes[0].insert, "bumper");
  assert.ok(tokens.length > 0);
  const { items, range } = ask({ ask: "complete", text: "{ Dock (bum", at: { line: 0, character: 11 } });
  assert.deepEqual([items.some(({ label }) => label === "bumper"), range], [true, [0, 8, 0, 11]]);
  assert.match(ask({ ask: "hover", text: dock, at: { line: 3, character: 9 } }).text, /bumper/);
  assert.equal(ask({ ask: "hover", text: dock, at: { line: 0, character: 0 } }), null);
  assert.deepEqual(ask({ ask: "format", text: "{  A (bumper) (Atom (wait 1) stop) }\n" }).length, 1);
  assert.equal(ask({ ask: "format", text: "{" }), null);
  assert.ok(ask({ ask: "quarks" }).length > 10);
  assert.match(ask({ ask: "explain", code: "E0201" }).output, /^E0201: /);
});

test("the explanation of a turn has the values of its operands", () => {
  ask({ ask: "begin", text: dock, world: office, seed: 1 });
  const { turns } = ask({ ask: "step", turns: 400 });
  const first = turns.findIndex(({ made }) => made > 0);
  const { moments } = ask({ ask: "why", turn: first });
  assert.equal(moments.at(-1).ends, false);
  const operands = moments[0].scopes.flatMap(({ operands }) => operands);
  assert.ok(operands.some(({ fired, words }) => fired && /^wait 20s$|atIsection/.test(words)), JSON.stringify(operands));
  assert.equal(turns[first].fired[0].by.includes("plan.mdle:5"), true, turns[first].fired[0].by);
});

test("a module has at most a gigabyte of memory, and stops beyond", async () => {
  const { instance } = await WebAssembly.instantiate(bytes, {});
  assert.throws(() => instance.exports.mdle_room(1_100_000_000), WebAssembly.RuntimeError);
});
