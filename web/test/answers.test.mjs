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

test("files that the plan uses are checked, run and named in messages", () => {
  const text = 'use "lib/leg.mdle"\n{ Main (bumper)\n  Leg\n}\n';
  const leg = 'use "./foot.mdle"\n{ Leg (null)\n  (Atom (wait 1s) (go 20 0))\n  Foot\n}\n';
  const foot = "{ Foot (null)\n  (Atom (wait 1s) (go 0 0.3))\n}\n";
  const draft = { text, files: { "lib/leg.mdle": leg, "lib/foot.mdle": foot } };
  assert.deepEqual(ask({ ask: "diagnose", ...draft }).diagnostics, []);
  const { elements } = ask({ ask: "begin", ...draft, world: office });
  assert.deepEqual(elements.filter(({ kind }) => kind === "atom").map(({ file, line }) => [file, line]), [["lib/leg.mdle", 3], ["lib/foot.mdle", 2]]);
  assert.equal(ask({ ask: "step", turns: 100 }).end.how, "over");
  // The file in the editor is checked for the plan, and has its own colours and proposals.
  const broken = { ...draft, files: { ...draft.files, "lib/foot.mdle": foot.replace("wait", "wayt") }, file: "lib/foot.mdle" };
  const { diagnostics, tokens } = ask({ ask: "diagnose", ...broken });
  assert.deepEqual(diagnostics.map(({ file, range }) => [file, range[0]]), [["lib/foot.mdle", 1]]);
  assert.deepEqual(diagnostics[0].fixes.map(({ insert }) => insert), ["wait"]);
  assert.ok(tokens.every(([range]) => range[0] <= 3) && tokens.length > 0);
  const { items } = ask({ ask: "complete", ...broken, at: { line: 0, character: 0 } });
  assert.ok(items.length > 0);
  // A file that nothing uses yet is checked by itself.
  const alone = ask({ ask: "diagnose", text: dock, files: { "a.mdle": "{ A (bumbper)\n  (Atom (null) stop)\n}\n" }, file: "a.mdle" });
  assert.deepEqual(alone.diagnostics.map(({ code, file }) => [code, file]), [["E0201", "a.mdle"]]);
  // Paths that lead nowhere, and circles.
  const message = (text, files = {}) => ask({ ask: "diagnose", text, files }).diagnostics[0]?.message ?? "";
  assert.match(message(text.replace("lib/leg", "lib/lek"), draft.files), /^there is no file `lib\/lek\.mdle`; did you mean `lib\/leg\.mdle`\?/);
  assert.match(message('use "../../etc/passwd"\n{ A (null) (Atom (null) stop) }\n'), /^there is no file/);
  assert.match(message('use "plan.mdle"\n{ A (null) (Atom (null) stop) }\n'), /^this file uses itself/);
});

test("a plan is checked for the robot that is chosen, and run on the simulated one", () => {
  const text = "{ Fast (bumper)\n  (Atom (wait 1s) (go 150 0))\n}\n";
  const codes = (robot) => ask({ ask: "diagnose", text, robot }).diagnostics.map(({ code }) => code);
  assert.deepEqual([codes("ros2"), codes("sim"), codes("scout"), codes("atrv")], [[], ["E0402"], ["E0402"], ["E0402"]]);
  assert.match(ask({ ask: "draw", text, robot: "ros2" }).output, /^<svg/);
  assert.match(ask({ ask: "begin", text, robot: "ros2", world: office }).error, /E0402/);
  assert.equal(ask({ ask: "begin", text: dock, robot: "scout", world: office }).error, undefined);
  assert.match(ask({ ask: "check", text, robot: "skout" }).error, /^robot: there is no robot "skout"; did you mean `scout`\?/);
});

test("a setup that cannot be names its field", () => {
  const refused = (setup) => ask({ ask: "begin", text: dock, world: office, ...setup }).error;
  assert.match(refused({ world: "[[wall]]\npoints = 7" }), /^world:2:/);
  assert.match(refused({ start: "1,2" }), /^start: expected x,y,heading/);
  assert.match(refused({ start: "100,100,0" }), /^start: the robot would stand outside the walls/);
  assert.match(refused({ start_noise: "0.1,5" }), /^start noise: it needs a seed/);
  assert.match(refused({ body: "fish" }), /^body: expected/);
  assert.match(refused({ without: "wings" }), /^without: "wings"/);
  assert.match(refused({ limit: 1e9 }), /^time limit/);
  assert.match(refused({ battery: 101 }), /^battery: expected/);
  assert.match(refused({ goal: "1,2" }), /^goal: expected/);
  assert.match(ask({ ask: "ready", text: "", world: office, start: "1,2" }).error, /^start: expected/);
  assert.deepEqual(ask({ ask: "ready", text: "", world: office, start: "1,0.1,90" }).robot.pose.slice(0, 2), [1, 0.1]);
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
  for (const times of [2, 9]) assert.match(ask({ ask: "floor", world: walls.repeat(times) }).error, /too large/);
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
