// Many runs with consecutive seeds, in workers of their own.
import type { Goal, Ready, Trial } from "./answers";
import { button, element } from "./dom";
import { Module, Refusal } from "./module";
import { distanceTo } from "./places";
import { JUDGED } from "./status";

/** Longest time for one run, in milliseconds. */
const PATIENCE = 60_000;

const OVER = "plan over";
const GOOD = `plan over, ${JUDGED.arrived}`;

/** How a run ended, for people. In the area of a goal only the heading can be wrong. */
function endOf({ end, judged, pose }: Trial, goal: Goal | null): string {
  if (end === "over" && judged === "astray" && goal && distanceTo(goal, pose) === 0) return "plan over, at the goal with a wrong heading";
  if (end === "over") return judged ? `plan over, ${JUDGED[judged]}` : OVER;
  return end === "limit" ? "time limit" : "fault";
}

export class Batch {
  private modules: Module[] = [];
  private readonly number = element("input", { id: "seeds", inputmode: "numeric", value: "100", autocomplete: "off" });
  private readonly bar = element("progress", { max: "1", value: "0", "aria-label": "Runs made", hidden: true });
  private readonly first = element("input", { id: "first-seed", inputmode: "numeric", placeholder: "seed above, or 1", autocomplete: "off" });
  private readonly line = element("p", { role: "status" });
  private readonly results = element("div");
  /** Makes the table that waits until the pointer and the keyboard have left it. */
  private waiting: (() => void) | undefined;
  /** The seed whose run is shown. */
  private opened: number | undefined;
  private readonly start: HTMLButtonElement;
  private readonly end = button("Stop", () => this.stop(), { disabled: true });

  constructor(panel: HTMLElement, private setup: () => object, private show: (seed: number) => void) {
    const wait = () => window.setTimeout(() => this.isInUse || this.waiting?.());
    this.results.addEventListener("pointerleave", wait);
    this.results.addEventListener("focusout", wait);
    this.start = button("Run the batch", () => void this.make(), { class: "primary" });
    const field = (title: string, input: HTMLInputElement) => element("label", { class: "field short", for: input.id }, element("span", {}, title), input);
    panel.append(
      element("p", { class: "quiet" }, "Runs with consecutive seeds. Choose the body Super Scout or ATRV-mini, or a start noise: else all runs are alike."),
      element("div", { class: "row" }, field("First seed", this.first), field("Seeds", this.number), this.start, this.end), this.bar, this.line, this.results,
    );
  }

  /** Forgets the first seed, which belongs to other settings. */
  clear(): void {
    this.first.value = "";
  }

  /** The pointer or the keyboard is in the table. */
  private get isInUse(): boolean {
    return this.results.matches(":hover, :focus-within");
  }

  private open(seed: number): void {
    this.opened = seed;
    this.mark();
    this.show(seed);
  }

  private mark(): void {
    for (const seed of this.results.querySelectorAll("button")) seed.setAttribute("aria-current", String(seed.textContent === String(this.opened)));
  }

  private refuse(sentence: string): void {
    this.waiting = undefined;
    this.line.textContent = sentence;
    this.results.replaceChildren();
  }

  private stop(): void {
    this.modules.forEach((module) => module.stop("stopped"));
    this.modules = [];
    [this.start.disabled, this.end.disabled] = [false, true];
  }

  private async make(): Promise<void> {
    this.stop();
    const runs = Number(this.number.value);
    if (!(Number.isInteger(runs) && runs >= 1 && runs <= 10_000)) return this.refuse("seeds: expected a whole number from 1 to 10000");
    const asked = this.first.value.trim();
    if (!/^\d{0,15}$/.test(asked)) return this.refuse("first seed: expected a whole number of at most 15 digits, or nothing");
    let setup: { seed?: number | null };
    try {
      setup = this.setup();
    } catch (error) {
      return this.refuse((error as Error).message);
    }
    const first = asked === "" ? setup.seed ?? 1 : Number(asked);
    // A seed that is opened goes into the field above: the next batch begins with the same seed nevertheless.
    this.first.value = String(first);
    this.opened = undefined;
    const trials: Trial[] = [];
    [this.start.disabled, this.end.disabled] = [true, false];
    [this.bar.hidden, this.bar.max, this.bar.value] = [false, runs, 0];
    let next = 0;
    const begun = performance.now();
    // One core is left for the page.
    const workers = Math.max(1, Math.min(8, runs, (navigator.hardwareConcurrency || 2) - 1));
    const modules = Array.from({ length: workers }, () => new Module());
    this.modules = modules;
    let goal: Goal | null = null;
    const report = () => this.report(trials, goal, `${trials.length} of ${runs} runs in ${((performance.now() - begun) / 1000).toFixed(1)} s`);
    try {
      goal = (await modules[0]?.ask<Ready>({ ask: "ready", ...setup, seed: first, text: "", files: {} }))?.floor.goal ?? null;
      await Promise.all(modules.map(async (module) => {
        while (next < runs && this.modules === modules) {
          trials.push(await module.ask<Trial>({ ask: "trial", ...setup, seed: first + next++ }, PATIENCE));
          this.bar.value = trials.length;
          if (trials.length % 10 === 0) report();
        }
      }));
      report();
    } catch (error) {
      report();
      if (error instanceof Refusal && error.message !== "stopped") this.line.textContent = error.message;
    }
    if (this.modules === modules) this.stop();
    modules.forEach((module) => module.stop("stopped"));
  }

  /** Tells how many runs are made, and makes their table anew unless somebody is in it. */
  private report(trials: Trial[], goal: Goal | null, progress: string): void {
    this.line.textContent = progress;
    this.waiting = () => {
      this.waiting = undefined;
      this.results.replaceChildren(this.table(trials, goal));
      this.mark();
    };
    if (!this.isInUse) this.waiting();
  }

  private table(trials: Trial[], goal: Goal | null): HTMLElement {
    const groups = new Map<string, Trial[]>();
    for (const trial of [...trials].sort((one, other) => one.seed - other.seed)) {
      const name = endOf(trial, goal);
      groups.set(name, [...(groups.get(name) ?? []), trial]);
    }
    const rows = [...groups].sort(([one], [other]) => one.localeCompare(other)).map(([name, group]) => this.row(name, group));
    const head = element("tr", {}, ...["End", "Runs", "Duration", "Seeds"].map((text) => element("th", { scope: "col" }, text)));
    return element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows));
  }

  private row(name: string, group: Trial[]): HTMLElement {
    const times = group.map(({ t }) => t);
    const [least, most] = [Math.min(...times).toFixed(1), Math.max(...times).toFixed(1)];
    const span = least === most ? `${least} s` : `${least} to ${most} s`;
    const isGood = name === GOOD || name === OVER;
    const seeds = element("div", { class: "seeds" });
    for (const { seed } of group.slice(0, 60)) seeds.append(button(String(seed), () => this.open(seed), { title: `Show the run of seed ${seed}` }));
    if (group.length > 60) seeds.append(`and ${group.length - 60} more`);
    return element("tr", {}, element("th", { scope: "row", class: isGood ? "good" : "bad" }, name), element("td", {}, String(group.length)), element("td", {}, span), element("td", {}, seeds));
  }
}
