// Files of the plan and of its run, with the bytes that the native commands write.
import { button, byId, element, save } from "./dom";
import { Module } from "./module";
import { command, draftOf, FILE, setupOf, type Settings, worldText } from "./settings";

/** Longest time to make a file, in milliseconds. */
const PATIENCE = 60_000;

/** Fills the menu of exports. */
export function files(menu: HTMLElement, settings: () => Settings, tell: (sentence: string, bad?: boolean) => void): void {
  // In a module of its own: the run that is shown goes on.
  const module = new Module();
  const offer = (name: string, type: string, text: () => Promise<string>) => async () => {
    tell("");
    byId<HTMLDetailsElement>("export").open = false;
    try {
      save(name, type, await text());
    } catch (error) {
      tell((error as Error).message, true);
    }
  };
  const exported = (what: string) => async () => {
    const { output } = await module.ask<{ output: string }>({ ask: "export", what, ...setupOf(settings()) }, PATIENCE);
    return output;
  };
  const drawn = async () => {
    const now = settings();
    return (await module.ask<{ output: string }>({ ask: "draw", ...draftOf(now), plan: now.plan || null })).output;
  };
  const item = (title: string, name: string, type: string, text: () => Promise<string>) => {
    const act = offer(name, type, text);
    return button(title, () => void act());
  };
  const shown = element("code");
  const plans = element("div", { class: "plans" });
  const offerPlans = () => plans.replaceChildren(...Object.keys({ [FILE]: "", ...settings().files }).map((name) =>
    item(`Plan (${name})`, name.replace(/^.*\//, ""), "text/plain", async () => ({ ...settings().files, [FILE]: settings().text })[name] ?? "")));
  menu.append(
    plans,
    item("World (world.toml)", "world.toml", "text/plain", async () => worldText(settings())),
    item("Picture of the plan (SVG)", "plan.svg", "image/svg+xml", drawn),
    item("Picture of the run (SVG)", "run.svg", "image/svg+xml", exported("plot")),
    item("Moving picture of the run (SVG)", "run_moving.svg", "image/svg+xml", exported("record")),
    item("Log of the run (JSON lines)", "run.jsonl", "application/json", exported("log")),
    item("Way of the run (CSV)", "run.csv", "text/csv", exported("trail")),
    element("div", { class: "quiet" }, "The same run natively:"), shown,
    button("Copy the command", () => void copy(command(settings()), tell)),
  );
  const whole = byId<HTMLDetailsElement>("export");
  whole.addEventListener("toggle", () => {
    shown.textContent = command(settings());
    offerPlans();
  });
  // A menu closes when something else is meant.
  document.addEventListener("pointerdown", ({ target }) => {
    if (!(target instanceof Node && whole.contains(target))) whole.open = false;
  });
  whole.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget instanceof Node && !whole.contains(relatedTarget)) whole.open = false;
  });
  whole.addEventListener("keydown", ({ key }) => {
    if (key !== "Escape" || !whole.open) return;
    whole.open = false;
    whole.querySelector("summary")?.focus();
  });
}

/** Copies a text, or shows it where that is not allowed. */
export async function copy(text: string, tell: (sentence: string) => void): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
    tell("Copied.");
  } catch {
    tell(`Copy this: ${text}`);
  }
}
