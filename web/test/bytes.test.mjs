// The module answers with the bytes of the native commands. MDLE_LONG=1 tries the whole corpus and more runs.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { begin, bytes } from "./module.mjs";

const { MDLEC, MDLE, MDLE_ROOT: root } = process.env;
const long = process.env.MDLE_LONG !== undefined;
const folder = mkdtempSync(join(tmpdir(), "mdle-web-"));
const worlds = Object.fromEntries(["office", "maze", "hall", "room"].map((name) => [name, readFileSync(join(root, `targets/sim/simulator/worlds/${name}.toml`), "utf8")]));
let ask;

before(async () => (ask = await begin()));
after(() => rmSync(folder, { recursive: true }));

function texts() {
  const plans = ["plans", "plans/paper"].flatMap((place) => readdirSync(join(root, place)).filter((name) => name.endsWith(".mdle")).map((name) => join(place, name)));
  const corpus = readdirSync(join(root, "tests/fuzz/corpus")).map((name) => join("tests/fuzz/corpus", name));
  const few = corpus.filter((_, number) => long || number % 10 === 0);
  const decoder = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });
  return [...plans, ...few].flatMap((name) => {
    try {
      return [[name, decoder.decode(readFileSync(join(root, name)))]];
    } catch {
      // A page has no text that is not UTF-8.
      return [];
    }
  }).filter(([, text]) => !text.includes('use "') && !text.startsWith("\ufeff"));
}

function native(program, args, text) {
  if (text !== undefined) writeFileSync(join(folder, "plan.mdle"), text);
  const { status, stdout, stderr, error } = spawnSync(program, args, { cwd: folder, encoding: "utf8", maxBuffer: 1 << 30, input: "" });
  if (error) throw error;
  return { status, stdout, stderr };
}

test("the module imports nothing", () => {
  assert.deepEqual(WebAssembly.Module.imports(new WebAssembly.Module(bytes)), []);
});

test("check and fmt have the bytes of mdlec", () => {
  const all = texts();
  assert.ok(all.length > 20, `${all.length} texts`);
  for (const [name, text] of all) {
    const checked = native(MDLEC, ["check", "--target", "sim", "--message-format", "json", "plan.mdle"], text);
    assert.equal(ask({ ask: "check", text }).output, checked.stderr, `check ${name}`);
    const formatted = native(MDLEC, ["fmt", "--message-format", "json", "plan.mdle"], text);
    const answer = ask({ ask: "fmt", text });
    if (formatted.status === 0) assert.equal(answer.output, readFileSync(join(folder, "plan.mdle"), "utf8"), `fmt ${name}`);
    else assert.equal(answer.messages, formatted.stderr, `fmt ${name}`);
  }
});

test("draw, analyze and trace have the bytes of mdlec", () => {
  let traced = 0;
  for (const [name, text] of texts()) {
    const drawn = native(MDLEC, ["draw", "--target", "sim", "plan.mdle"], text);
    const answer = ask({ ask: "draw", text });
    if (drawn.status !== 0) {
      assert.equal(typeof answer.error, "string", `draw ${name}`);
      continue;
    }
    assert.equal(answer.output, drawn.stdout, `draw ${name}`);
    assert.equal(ask({ ask: "analyze", text }).json, native(MDLEC, ["analyze", "--target", "sim", "--json", "plan.mdle"]).stdout, `analyze ${name}`);
    // Turns in which each interrupt with one operand fires once, and each law is done once.
    const { elements } = ask({ ask: "begin", text, world: worlds.office });
    const single = elements.map(({ condition }) => condition).filter((text) => text !== "" && !/\b(null|wait|way|t|OR|AND|NOT|RISING|after|stuck)\b/.test(text));
    const script = single.map((text, turn) => JSON.stringify({ t: turn, fired: [text] })).join("\n") + "\n";
    writeFileSync(join(folder, "script.jsonl"), script);
    const native_ = native(MDLEC, ["trace", "--target", "sim", "plan.mdle", "--script", "script.jsonl"]);
    const trace = ask({ ask: "trace", text, script });
    if (native_.status === 0) {
      assert.equal(trace.output, native_.stdout, `trace ${name}`);
      traced += native_.stdout.length > 0 ? 1 : 0;
    } else {
      assert.equal(typeof trace.error, "string", `trace ${name}: ${native_.stderr}`);
    }
  }
  assert.ok(traced >= 4, `${traced} traces`);
});

test("plans in several files, and for every robot, have the bytes of mdlec", () => {
  const files = { "leg.mdle": "{ Leg (null)\n  (Atom (wait 1s) (go 20 0))\n}\n", "bad.mdle": "{ Bad (bumbper)\n  (Atom (null) (go 150 0))\n}\n" };
  for (const [name, text] of Object.entries(files)) writeFileSync(join(folder, name), text);
  const plans = ['use "leg.mdle"\n{ Main (bumper)\n  Leg\n}\n', 'use "leg.mdle" use "bad.mdle"\n{ Main (bumper)\n  Leg\n  Bad\n}\n', 'use "lek.mdle"\n{ Main (bumper)\n  Leg\n}\n', "{ Fast (bumper)\n  (Atom (wait 1s) (go 150 0))\n}\n"];
  for (const text of plans) {
    for (const robot of ["sim", "scout", "atrv", "ros2"]) {
      const checked = native(MDLEC, ["check", "--target", robot, "--message-format", "json", "plan.mdle"], text);
      assert.equal(ask({ ask: "check", text, files, robot }).output, checked.stderr, `${robot} ${text}`);
      const drawn = native(MDLEC, ["draw", "--target", robot, "plan.mdle"]);
      if (drawn.status === 0) assert.equal(ask({ ask: "draw", text, files, robot }).output, drawn.stdout);
    }
  }
  const ran = native(MDLE, ["run", "plan.mdle", "--target", "sim", "--speed", "max", "--timeout=5", "--log", "run.jsonl"], plans[0]);
  assert.equal(ran.status, 0, ran.stderr);
  const { output } = ask({ ask: "export", what: "log", text: plans[0], files, world: worlds.office, world_name: "office", limit: 5 });
  assert.equal(output, readFileSync(join(folder, "run.jsonl"), "utf8"));
});

test("runs have the bytes of mdle run", () => {
  const plan = (name) => readFileSync(join(root, `plans/${name}.mdle`), "utf8");
  const every = [];
  const of = (name, world, start, limit, more = {}) => every.push({ text: plan(name), world, start, limit, ...more });
  const seeds = long ? [1, 2, 3, 4, 5, 6] : [4];
  of("lab_tour", "office", "", 300);
  of("dock", "room", "0.7,0.7,0", 60);
  of("branching", "hall", "1.5,5,0", 130);
  for (const seed of seeds) {
    for (const body of ["scout", "atrv"]) {
      of("lab_tour", "office", "", 200, { body, seed });
      of("retreat", "room", "", 60, { body, seed, start_noise: "0.1,20" });
      of("wall_following", "room", "1,0.8,0", 70, { body, seed, without: "slip,outliers" });
      of("patrol", "hall", "3,5,0", 60, { body, seed });
    }
  }
  for (const run of every) {
    const { text, world, start, limit, body, seed, start_noise, without } = run;
    const options = Object.entries({ world, start, timeout: limit, body, seed, "start-noise": start_noise, without }).filter(([, value]) => value !== undefined && value !== "");
    const args = ["run", "plan.mdle", "--target", "sim", "--speed", "max", ...options.map(([name, value]) => `--${name}=${value}`)];
    const ran = native(MDLE, [...args, "--log", "run.jsonl", "--trail", "run.csv", "--plot", "run.svg", "--record", "moving.svg"], text);
    assert.ok(ran.status !== 2 && ran.stdout !== "", ran.stderr);
    const setup = { ...run, world: worlds[world], world_name: world };
    for (const [what, file] of [["log", "run.jsonl"], ["trail", "run.csv"], ["plot", "run.svg"], ["record", "moving.svg"]]) {
      const { output, error } = ask({ ask: "export", what, ...setup });
      assert.equal(error, undefined);
      assert.ok(output === readFileSync(join(folder, file), "utf8"), `${what} of ${args.join(" ")}`);
    }
    // The turns that a page draws are those of the log.
    ask({ ask: "begin", ...setup });
    let turns = 0;
    for (let end = null; end === null; ) {
      const steps = ask({ ask: "step", turns: 500 });
      turns += steps.turns.length;
      end = steps.end;
    }
    assert.equal(turns, readFileSync(join(folder, "run.jsonl"), "utf8").trimEnd().split("\n").length);
  }
  console.log(`${every.length} runs`);
});

test("a batch judges its runs as mdle run does", () => {
  const text = readFileSync(join(root, "plans/lab_tour.mdle"), "utf8");
  const ends = [1, 2, 3].map((seed) => ask({ ask: "trial", text, world: worlds.office, body: "scout", seed, start_noise: "0.05,5", limit: 300 }));
  const args = ["run", "plan.mdle", "--target", "sim", "--speed", "max", "--body", "scout", "--start-noise=0.05,5", "--timeout=300", "--goal=world"];
  for (const [number, { judged, t }] of ends.entries()) {
    const { stdout } = native(MDLE, [...args, `--seed=${number + 1}`], text);
    assert.match(stdout, new RegExp(`\\b${judged}\\b`), stdout);
    assert.ok(stdout.includes(`${t.toFixed(1)} s`), `${t} s in ${stdout}`);
  }
  // A goal of one's own, and a battery.
  const low = "{ Low (bumper)\n  (Atom (lowBattery) (go 20 0))\n}\n";
  for (const [goal, battery] of [["0,0,0.5", 5], ["9,9,0.5", 5], ["0,0,0.5", 90]]) {
    const { judged, end } = ask({ ask: "trial", text: low, world: worlds.office, goal, battery, limit: 3 });
    const { stdout, stderr } = native(MDLE, ["run", "plan.mdle", "--target", "sim", "--speed", "max", `--goal=${goal}`, `--battery=${battery}`, "--timeout=3"], low);
    assert.equal(end, battery === 5 ? "over" : "limit");
    // A plan that is not over is not judged on a terminal.
    assert.match(stdout + stderr, end === "over" ? new RegExp(`\\b${judged}\\b`) : /stopped by --timeout/);
  }
});
