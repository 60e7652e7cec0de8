// The page: editor, setup, run, and the views of a run.
import type { Floor } from "./answers";
import { Batch } from "./batch";
import { byId, element, later } from "./dom";
import { Editor } from "./editor";
import { EXAMPLES, settingsOfExample } from "./examples";
import { copy, files } from "./files";
import { FloorView } from "./floor";
import { fragmentOf, settingsIn } from "./link";
import { Module } from "./module";
import { Picture } from "./picture";
import { Player } from "./player";
import { showProblems } from "./problems";
import { Run } from "./run";
import { EMPTY, type Settings, settingsOf, setupOf, worldText, WORLDS } from "./settings";
import { Signals } from "./signals";
import { kept, keep } from "./storage";
import { tabs } from "./tabs";
import { Why } from "./why";

/** Time without a keystroke after which the text is checked, in milliseconds. */
const QUIET = 15;

const language = new Module();
const simulator = new Module();
const FIELDS = ["plan", "world", "body", "seed", "start", "noise", "without", "limit"] as const;
const field = (name: (typeof FIELDS)[number]) => byId<HTMLInputElement | HTMLSelectElement>(name);
const ownWorld = element("textarea", { id: "world-text", spellcheck: "false", "aria-label": "World as TOML" });
const worldError = element("p", { class: "bad", role: "status" });

let run: Run | undefined;
const editor = new Editor(byId("editor"), language, later(QUIET, () => void changed()), () => void begin());
const floor = new FloorView(byId<HTMLCanvasElement>("floor"));
const picture = new Picture(byId("panel-plan"), language);
const why = new Why(byId("panel-why"), (line) => editor.goTo(line));
const signals = new Signals(byId("panel-signals"));
const player = new Player(show);
const showTab = tabs(document.querySelector<HTMLElement>(".tabs") as HTMLElement, () => run && show(run, player.turn));

/** Tells the reader something; a text, never HTML. */
function tell(sentence: string, bad = false): void {
  const notice = byId("notice");
  notice.textContent = sentence;
  notice.classList.toggle("bad", bad);
  notice.hidden = sentence === "";
}

function status(text: string, bad = false): void {
  byId("status").textContent = text;
  byId("status").classList.toggle("bad", bad);
}

function settings(): Settings {
  const fields = Object.fromEntries(FIELDS.map((name) => [name, field(name).value]));
  return { ...EMPTY, ...fields, text: editor.text, ownWorld: ownWorld.value };
}

function set(next: Settings): void {
  run?.stop();
  run = undefined;
  ownWorld.value = next.world === "own" ? next.ownWorld : (WORLDS[next.world] ?? "");
  editor.text = next.text;
  choices([], next.plan);
  for (const name of FIELDS) if (name !== "plan") field(name).value = next[name];
  status("");
  void drawWorld();
}

/** Offers the plans of the text. */
function choices(plans: string[], chosen = field("plan").value): void {
  const names = ["", ...new Set([...plans, ...(chosen ? [chosen] : [])])];
  field("plan").replaceChildren(...names.map((name) => element("option", { value: name }, name === "" ? "auto" : name)));
  field("plan").value = plans.length === 0 || plans.includes(chosen) ? chosen : "";
}

/** Time after which a check of an older text is given up, in milliseconds. */
const OLD = 2000;
/** Beginning of the check that goes on; 0 if there is none. */
let checking = 0;

/** The text has changed: it is kept, checked and drawn. */
async function changed(): Promise<void> {
  keep(settings());
  const { text } = editor;
  const begun = performance.now();
  if (checking > 0 && begun - checking > OLD) language.stop("The text has changed.");
  checking = begun;
  try {
    const diagnosis = await editor.diagnose();
    if (!diagnosis) return;
    showProblems(byId("problems"), diagnosis, editor, language);
    choices(diagnosis.plans);
    document.documentElement.dataset.checked = String(performance.now());
    if (diagnosis.diagnostics.some(({ error }) => error)) return;
    await picture.draw(editor.text, field("plan").value).catch((error: Error) => picture.say(error.message));
    if (run) show(run, player.turn);
  } catch (error) {
    // What an older text was refused for is of no use.
    if (editor.text === text) tell((error as Error).message, true);
  } finally {
    if (checking === begun) checking = 0;
  }
}

/** Draws the world, unless a run is shown in it. */
async function drawWorld(): Promise<void> {
  try {
    const drawn = await simulator.ask<Floor>({ ask: "floor", world: worldText(settings()) });
    worldError.textContent = "";
    if (!run) floor.show(drawn);
  } catch (error) {
    worldError.textContent = (error as Error).message;
  }
}

/** Begins a run, and plays it while it is being made. */
async function begin(): Promise<void> {
  run?.stop();
  run = undefined;
  status("…");
  const begun = performance.now();
  try {
    const next = await Run.begin(simulator, setupOf(settings()));
    run = next;
    player.begin(next);
    await next.make(() => {
      if (run !== next) return;
      player.more();
      status(ended(next));
    });
    document.documentElement.dataset.simulated = String(performance.now() - begun);
  } catch (error) {
    status((error as Error).message, true);
  }
}

/** How a run has ended, for people. */
function ended({ end, frames }: Run): string {
  const time = `${(frames.at(-1)?.t ?? 0).toFixed(1)} s`;
  if (!end) return `Simulated ${time} …`;
  if (end.how === "over") return `The plan is over after ${time}: ${end.by ?? ""}`;
  return end.how === "limit" ? `Stopped after ${time} by the time limit; the plan is not over.` : `A fault after ${time}: ${end.by ?? ""}`;
}

/** Shows a turn in all views. */
function show(shown: Run, turn: number): void {
  floor.at(shown, turn);
  picture.at(shown, turn);
  signals.at(shown, turn);
  void why.at(shown, turn);
  const frame = shown.frames[turn];
  const law = shown.atom(frame?.atom)?.law ?? "plan over";
  byId("floor").setAttribute("aria-label", frame
    ? `Floor of the world. At ${frame.t.toFixed(1)} s the robot is at ${frame.pose[0].toFixed(2)}, ${frame.pose[1].toFixed(2)} m; ${law}`
    : "Floor of the world");
}

async function share(): Promise<void> {
  const fragment = await fragmentOf(settings());
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

function wire(): void {
  const examples = byId<HTMLSelectElement>("example");
  examples.append(element("option", { value: "" }, "choose one …"), ...EXAMPLES.map(({ name }, number) => element("option", { value: String(number) }, name)));
  examples.addEventListener("change", () => {
    const example = EXAMPLES[Number(examples.value)];
    if (examples.value !== "" && example) set(settingsOfExample(example));
    tell("");
  });
  byId("run").addEventListener("click", () => void begin());
  byId("share").addEventListener("click", () => void share());
  byId("format").addEventListener("click", () => void editor.format().then((done) => tell(done ? "" : "A plan with errors is not formatted.", !done)));
  byId("setup").addEventListener("submit", (event) => event.preventDefault());
  byId("setup").addEventListener("change", () => {
    keep(settings());
    void changed();
  });
  field("world").addEventListener("change", () => {
    if (field("world").value !== "own") ownWorld.value = worldText(settings());
    run?.stop();
    run = undefined;
    void drawWorld();
  });
  ownWorld.addEventListener("input", later(150, () => {
    field("world").value = "own";
    run?.stop();
    run = undefined;
    keep(settings());
    void drawWorld();
  }));
  byId("panel-world").append(element("p", { class: "quiet" }, "Change the text, and the floor is drawn again. Lengths are in metres; the book has the format."), worldError, ownWorld);
  new Batch(byId("panel-batch"), () => setupOf(settings()), (seed) => {
    field("seed").value = String(seed);
    void begin();
  });
  files(byId("files"), settings, tell);
  window.addEventListener("hashchange", () => void open());
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey && event.key === "Enter" && !event.defaultPrevented) void begin();
  });
}

wire();
showTab("plan");
// The module is in the page below this script.
document.addEventListener("DOMContentLoaded", () => void open());
