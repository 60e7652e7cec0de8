// The page: its parts, and what connects them.
import { Address } from "./address";
import { Batch } from "./batch";
import { Checking, QUIET } from "./checking";
import { Documents } from "./documents";
import { byId, element, later } from "./dom";
import { Editor } from "./editor";
import { EXAMPLES, settingsOfExample } from "./examples";
import { copy, files } from "./files";
import { FloorView } from "./floor";
import { choices, field, FIELDS, forgetPlans, planToRun } from "./form";
import { Module } from "./module";
import { tell } from "./notice";
import { Picture } from "./picture";
import { Replaced } from "./replaced";
import { Running } from "./running";
import { EMPTY, type Settings, settingsOf, setupOf } from "./settings";
import { Signals } from "./signals";
import { kept } from "./storage";
import { tabs } from "./tabs";
import { Transitions } from "./transitions";
import { Views } from "./views";
import { Why } from "./why";
import { World } from "./world";

const language = new Module();
const simulator = new Module();

const editor: Editor = new Editor(byId("editor"), language, draft, () => checking.changed(), () => void running.begin());
const documents: Documents = new Documents(byId("documents"), editor, () => checking.changed());
const picture = new Picture(byId("panel-plan"), language);
const floor = new FloorView(byId<HTMLCanvasElement>("floor"), byId("pointed"));
const views = new Views(
  floor, picture,
  new Why(byId("panel-why"), (file, line) => {
    documents.show(file);
    editor.goTo(line);
  }),
  new Signals(byId("panel-signals")), new Transitions(byId("panel-transitions"), (turn) => running.go(turn)),
);
const running: Running = new Running(simulator, views, { settings: toRun, hasErrors: () => checking.hasErrors, drawWorld: () => void world.draw() });
const world: World = new World(floor, simulator, settings, () => running.hasFloor, () => {
  running.showStale();
  keepSoon();
  checking.settled();
  void world.draw();
}, () => {
  const before = settings();
  queueMicrotask(() => replaced.offer(before, "Your own world was replaced by the one that you edit."));
});
const batch = new Batch(byId("panel-batch"), () => setupOf(toRun()), (seed) => {
  field("seed").value = String(seed);
  void running.begin();
});
const address = new Address(settings);
const replaced = new Replaced(settings, set);
const checking: Checking = new Checking(editor, documents, picture, language, {
  settings: toRun,
  changed: () => {
    running.showStale();
    keepSoon();
  },
  settled: () => running.refresh(),
});
const keepSoon = later(QUIET, () => address.keep());

/** The plan files as they are typed, and the one in the editor. */
function draft() {
  return { text: documents.text, files: documents.files, file: documents.shown, robot: field("robot").value };
}

/** The settings, with the plan as it was chosen. */
function settings(): Settings {
  const fields = Object.fromEntries(FIELDS.map((name) => [name, field(name).value]));
  return { ...EMPTY, ...fields, text: documents.text, files: documents.files, ownWorld: world.text };
}

/** The settings of a run, in which the plan is named if the text leaves it open. */
function toRun(): Settings {
  return { ...settings(), plan: planToRun() };
}

/** The robot for which the plan was checked before another one was chosen. */
let robotBefore = EMPTY.robot;

function set(next: Settings): void {
  robotBefore = next.robot;
  running.clear();
  batch.clear();
  world.set(next);
  forgetPlans(next.plan);
  for (const name of FIELDS) if (name !== "plan") field(name).value = next[name];
  documents.set(next.text, next.files);
  checking.changed();
  void world.draw();
}

async function share(): Promise<void> {
  const link = await address.linkOf(toRun());
  await copy(link, (sentence) => tell(sentence === "Copied." ? "The link is copied. The plan is in it: nothing was sent anywhere." : sentence));
}

/** Takes the settings of the link, or those that were kept, or the first example. */
async function open(): Promise<void> {
  const mine = kept(settingsOf);
  const linked = await address.opened();
  const first = EXAMPLES[0];
  set(linked ?? mine ?? (first ? settingsOfExample(first) : EMPTY));
  replaced.offerAgain();
  if (linked && mine) replaced.offer(mine, "The plan of the link replaced your plan.");
}

/** Takes the settings of another link in the address, while the page is open. */
async function openAnother(): Promise<void> {
  const linked = await address.opened();
  if (linked) replaced.by(linked, "The plan of the link replaced your plan.");
}

function wireExamples(): void {
  const examples = byId<HTMLSelectElement>("example");
  examples.append(element("option", { value: "" }, "choose one …"), ...EXAMPLES.map(({ name }, number) => element("option", { value: String(number) }, name)));
  // A key that moves the choice on opens nothing yet.
  let byKey = false;
  const choose = () => {
    const example = EXAMPLES[Number(examples.value)];
    tell("");
    if (examples.value === "" || !example) return;
    if (byKey) return tell("Enter opens this example.");
    replaced.by(settingsOfExample(example), `The example “${example.name}” replaced your plan.`);
  };
  examples.addEventListener("change", choose);
  examples.addEventListener("pointerdown", () => (byKey = false));
  examples.addEventListener("keydown", (event) => {
    byKey = event.key !== "Enter" && event.key !== " " && !event.altKey;
    if (event.key !== "Enter") return;
    event.preventDefault();
    choose();
  });
}

function wireFields(): void {
  byId("setup").addEventListener("submit", (event) => event.preventDefault());
  const changed = () => {
    byId("choice").textContent = choices();
    running.showStale();
    keepSoon();
    checking.settled();
    void world.draw();
  };
  byId("setup").addEventListener("input", later(QUIET, changed));
  field("robot").addEventListener("change", () => {
    const robot = field("robot").value;
    // The simulated robot gets the body of the one that the plan is for, and gives it up with that robot.
    if (robot === "scout" || robot === "atrv") field("body").value = robot;
    else if (field("body").value === robotBefore) field("body").value = EMPTY.body;
    robotBefore = robot;
    changed();
    checking.changed();
  });
}

function wire(): void {
  wireExamples();
  wireFields();
  byId("run").addEventListener("click", () => void running.begin());
  byId("stop").addEventListener("click", () => running.stop());
  byId("share").addEventListener("click", () => void share());
  byId("format").addEventListener("click", () => void editor.format().then((done) => tell(done ? "" : "A plan with errors is not formatted.", !done)));
  files(byId("files"), toRun, tell);
  window.addEventListener("hashchange", () => void openAnother());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && address.keep());
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey && event.key === "Enter" && !event.defaultPrevented) void running.begin();
  });
  tabs(byId("views"), () => running.refresh());
}

wire();
// The module is in the page below this script.
document.addEventListener("DOMContentLoaded", () => void open());
