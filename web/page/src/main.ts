// The page: editor, setup, run, and the views of a run.
import type { Floor, Ready } from "./answers";
import { Batch } from "./batch";
import { byId, element, later, oneAtATime } from "./dom";
import { Editor } from "./editor";
import { EXAMPLES, settingsOfExample } from "./examples";
import { copy, files } from "./files";
import { FloorView } from "./floor";
import { checkSetup, choiceOfPlan, field, FIELDS, forgetPlans, offerPlans, planToRun } from "./form";
import { fragmentOf, settingsIn } from "./link";
import { Module } from "./module";
import { tell } from "./notice";
import { Picture } from "./picture";
import { Player } from "./player";
import { showProblems } from "./problems";
import { Run } from "./run";
import { EMPTY, type Settings, settingsOf, setupOf, worldText, WORLDS } from "./settings";
import { Signals } from "./signals";
import { stateOf, status } from "./status";
import { kept, keep } from "./storage";
import { tabs } from "./tabs";
import { Transitions } from "./transitions";
import { Why } from "./why";

/** Time without a keystroke after which the text is kept and its picture is drawn, in milliseconds. */
const QUIET = 200;
/** What the picture shows while the text has errors. */
const LAST = "The last plan without errors.";
/** Time after which a check of an older text is given up, in milliseconds. */
const OLD = 2000;

const language = new Module();
const simulator = new Module();
const ownWorld = element("textarea", { id: "world-text", spellcheck: "false", "aria-label": "World as TOML" });
const worldError = element("p", { class: "bad", role: "status" });

let run: Run | undefined;
/** The settings of the run that is shown. */
let ranWith: Settings | undefined;
/** What has changed since. */
let stale: "" | "plan" | "fields" = "";
/** Number of runs begun. */
let runs = 0;
let hasErrors = false;
const editor = new Editor(byId("editor"), language, changed, () => void begin());
const floor = new FloorView(byId<HTMLCanvasElement>("floor"), byId("pointed"));
const picture = new Picture(byId("panel-plan"), language);
const why = new Why(byId("panel-why"), (line) => editor.goTo(line));
const signals = new Signals(byId("panel-signals"));
const player = new Player(show);
const transitions = new Transitions(byId("panel-transitions"), (turn) => player.go(turn));
const showTab = tabs(document.querySelector<HTMLElement>(".tabs") as HTMLElement, () => run && show(run, player.turn));

/** The settings, with the plan as it was chosen. */
function settings(): Settings {
  const fields = Object.fromEntries(FIELDS.map((name) => [name, field(name).value]));
  return { ...EMPTY, ...fields, text: editor.text, ownWorld: ownWorld.value };
}

/** The settings of a run, in which the plan is named if the text leaves it open. */
const toRun = (): Settings => ({ ...settings(), plan: planToRun() });

function set(next: Settings): void {
  clearRun();
  ownWorld.value = next.world === "own" ? next.ownWorld : (WORLDS[next.world] ?? "");
  forgetPlans(next.plan);
  for (const name of FIELDS) if (name !== "plan") field(name).value = next[name];
  editor.text = next.text;
  changed();
  void drawWorld();
}

/** Shows no run any more. */
function clearRun(): void {
  run?.stop({ how: "stopped" });
  [run, ranWith] = [undefined, undefined];
  player.clear();
  picture.clear("");
  for (const view of [why, signals, transitions]) view.clear();
  status("");
  showStale();
}

/** The text has changed. */
function changed(): void {
  if (checking > 0 && performance.now() - checking > OLD) language.stop("The text has changed.");
  check();
  showStale();
  settled();
}

/** Beginning of the check that goes on; 0 if there is none. */
let checking = 0;
const check = oneAtATime(async () => {
  const { text } = editor;
  checking = performance.now();
  try {
    const diagnosis = await editor.diagnose();
    if (!diagnosis) return;
    showProblems(byId("problems"), diagnosis, editor, language);
    hasErrors = diagnosis.diagnostics.some(({ error }) => error);
    if (!hasErrors) offerPlans(diagnosis.plans, diagnosis.roots);
    byId("choice").textContent = choiceOfPlan();
    document.documentElement.dataset.checked = String(performance.now());
  } catch (error) {
    // What an older text was refused for is of no use.
    if (editor.text === text) tell((error as Error).message, true);
  } finally {
    checking = 0;
  }
});

/** Keeps the settings and draws the plan once the reader pauses. */
const settled = later(QUIET, () => {
  keep(settings());
  void drawPlan();
});

async function drawPlan(): Promise<void> {
  const { text, plan } = toRun();
  // While the text has errors, the picture is that of the last one without.
  if (!hasErrors) await picture.draw(text, plan).catch((error: Error) => picture.say(error.message));
  if (run) show(run, player.turn);
  else picture.clear(hasErrors ? LAST : "");
}

/** Draws the world with the robot at its start, unless a run is shown in it; marks a field that is refused. */
async function drawWorld(): Promise<void> {
  const now = settings();
  const ready = await checkSetup(simulator, now);
  worldError.textContent = "";
  try {
    const shown = ready ?? (await worldAlone(now));
    if (!run) floor.show(shown);
  } catch (error) {
    worldError.textContent = (error as Error).message;
  }
}

async function worldAlone(now: Settings): Promise<Ready> {
  const drawn = await simulator.ask<Floor>({ ask: "floor", world: worldText(now) });
  return { floor: drawn, robot: { pose: drawn.start, round: true, length: 0.205, width: 0.205 } };
}

/** Begins a run, and plays it while it is being made. */
async function begin(): Promise<void> {
  clearRun();
  status("Compiling …");
  byId<HTMLButtonElement>("stop").disabled = false;
  const number = ++runs;
  const given = toRun();
  const begun = performance.now();
  let next: Run | undefined;
  try {
    next = await Run.begin(simulator, setupOf(given));
    if (number !== runs) return;
    [run, ranWith] = [next, given];
    // The text may have changed while it was compiled.
    showStale();
    player.begin(next);
    await next.make(() => run === next && player.more());
    document.documentElement.dataset.simulated = String(performance.now() - begun);
  } catch (error) {
    if (number === runs) broken(next, (error as Error).message);
  }
}

/** A run could not be begun, or the module stopped while it was made. */
function broken(made: Run | undefined, sentence: string): void {
  if (made && made.frames.length > 0) {
    made.stop({ how: "broken", by: sentence });
    return player.go(made.frames.length - 1);
  }
  clearRun();
  status(sentence, true);
  void drawWorld();
}

/** Ends the run that is being made, and its playback. */
function stop(): void {
  if (!run) return simulator.stop("Stopped by you.");
  run.stop({ how: "stopped" });
  player.pause();
  show(run, player.turn);
}

/** Says that the run that is shown is not that of the text and the fields. */
function showStale(): void {
  const now = run && toRun();
  const differs = (names: readonly (keyof Settings)[]) => now !== undefined && names.some((name) => now[name] !== ranWith?.[name]);
  stale = differs(["text", "plan"]) ? "plan" : differs(FIELDS) ? "fields" : "";
  byId("stale").hidden = stale === "";
  byId("stale").textContent = stale === "" ? "" : `This run is of the ${stale} before your change. Run again to see the change.`;
  byId("floor").parentElement?.classList.toggle("stale", stale !== "");
}

/** Shows a turn in all views. */
function show(shown: Run, turn: number): void {
  floor.at(shown, turn, stale === "plan");
  if (stale === "plan") picture.clear(`${hasErrors ? LAST : "The plan as it is now."} The run above is of the plan before your change.`);
  else picture.at(shown, turn);
  signals.at(shown, turn);
  transitions.at(shown, turn);
  void why.at(shown, turn);
  status(...stateOf(shown, turn));
  const frame = shown.frames[turn];
  const law = shown.atom(frame?.atom)?.law ?? "plan over";
  byId("floor").setAttribute("aria-label", frame
    ? `Floor of the world. At ${frame.t.toFixed(1)} s the robot is at ${frame.pose[0].toFixed(2)}, ${frame.pose[1].toFixed(2)} m; ${law}`
    : "Floor of the world");
}

async function share(): Promise<void> {
  const fragment = await fragmentOf(toRun());
  history.replaceState(null, "", fragment);
  await copy(location.href, (sentence) => tell(sentence === "Copied." ? "The link is copied. The plan is in it: nothing was sent anywhere." : sentence));
}

/** Takes the settings of the link, or those that were kept, or the first example. */
async function open(): Promise<void> {
  try {
    const linked = await settingsIn(location.hash);
    if (linked) return set(linked);
  } catch (error) {
    tell((error as Error).message, true);
  }
  const first = EXAMPLES[0];
  set(kept(settingsOf) ?? (first ? settingsOfExample(first) : EMPTY));
}

/** The world has changed: a run in another one is not shown in it. */
function worldChanged(): void {
  clearRun();
  settled();
  void drawWorld();
}

function wire(): void {
  const examples = byId<HTMLSelectElement>("example");
  examples.append(element("option", { value: "" }, "choose one …"), ...EXAMPLES.map(({ name }, number) => element("option", { value: String(number) }, name)));
  examples.addEventListener("change", () => {
    const example = EXAMPLES[Number(examples.value)];
    if (examples.value !== "" && example) set(settingsOfExample(example));
    tell("");
  });
  byId("run").addEventListener("click", () => void begin());
  byId("stop").addEventListener("click", stop);
  byId("share").addEventListener("click", () => void share());
  byId("format").addEventListener("click", () => void editor.format().then((done) => tell(done ? "" : "A plan with errors is not formatted.", !done)));
  byId("setup").addEventListener("submit", (event) => event.preventDefault());
  byId("setup").addEventListener("input", later(QUIET, () => {
    byId("choice").textContent = choiceOfPlan();
    showStale();
    settled();
    void drawWorld();
  }));
  field("world").addEventListener("change", () => {
    if (field("world").value !== "own") ownWorld.value = worldText(settings());
    worldChanged();
  });
  ownWorld.addEventListener("input", later(QUIET, () => {
    field("world").value = "own";
    worldChanged();
  }));
  byId("panel-world").append(element("p", { class: "quiet" }, "Change the text, and the floor is drawn again. Lengths are in metres; the book has the format."), worldError, ownWorld);
  new Batch(byId("panel-batch"), () => setupOf(toRun()), (seed) => {
    field("seed").value = String(seed);
    void begin();
  });
  files(byId("files"), toRun, tell);
  window.addEventListener("hashchange", () => void open());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && keep(settings()));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey && event.key === "Enter" && !event.defaultPrevented) void begin();
  });
}

wire();
showTab("plan");
// The module is in the page below this script.
document.addEventListener("DOMContentLoaded", () => void open());
