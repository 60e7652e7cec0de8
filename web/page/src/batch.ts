// Many runs with consecutive seeds, in workers of their own.
import type { Trial } from "./answers";
import { button, element } from "./dom";
import { Module, Refusal } from "./module";
import { JUDGED } from "./status";

/** Longest time for one run, in milliseconds. */
const PATIENCE = 60_000;

const OVER = "plan over";
const GOOD = `plan over, ${JUDGED.arrived}`;

/** How a run ended, for people. */
function endOf({ end, judged }: Trial): string {
  if (end === "over") return judged ? `plan over, ${JUDGED[judged]}` : OVER;
  return end === "limit" ? "time limit" : "fault";
}

export class Batch {
  private modules: Module[] = [];
  private readonly number = element("input", { id: "seeds", inputmode: "numeric", value: "100", autocomplete: "off" });
  private readonly bar = element("progress", { max: "1", value: "0", "aria-label": "Runs made", hidden: true });
  private readonly results = element("div", { "aria-live": "polite" });
  private readonly start: HTMLButtonElement;
  private readonly end = button("Stop", () => this.stop(), { disabled: true });

  constructor(panel: HTMLElement, private setup: () => object, private show: (seed: number) => void) {
    this.start = button("Run the batch", () => void this.make(), { class: "primary" });
    const label = element("label", { class: "field short", for: "seeds" }, element("span", {}, "Seeds"), this.number);
    panel.append(
      element("p", { class: "quiet" }, "Runs with consecutive seeds, from the seed above or 1. Choose the body Super Scout or ATRV-mini, or a start noise: else all runs are alike."),
      element("div", { class: "row" }, label, this.start, this.end), this.bar, this.results,
    );
  }

  private stop(): void {
    this.modules.forEach((module) => module.stop("stopped"));
    this.modules = [];
    [this.start.disabled, this.end.disabled] = [false, true];
  }

  private async make(): Promise<void> {
    this.stop();
    const runs = Number(this.number.value);
    if (!(Number.isInteger(runs) && runs >= 1 && runs <= 10_000)) return this.results.replaceChildren("seeds: expected a whole number from 1 to 10000");
    let setup: { seed?: number | null };
    try {
      setup = this.setup();
    } catch (error) {
      return this.results.replaceChildren((error as Error).message);
    }
    const first = setup.seed ?? 1;
    const trials: Trial[] = [];
    [this.start.disabled, this.end.disabled] = [true, false];
    [this.bar.hidden, this.bar.max, this.bar.value] = [false, runs, 0];
    let next = 0;
    const begun = performance.now();
    // One core is left for the page.
    const workers = Math.max(1, Math.min(8, runs, (navigator.hardwareConcurrency || 2) - 1));
    const modules = Array.from({ length: workers }, () => new Module());
    this.modules = modules;
    try {
      await Promise.all(modules.map(async (module) => {
        while (next < runs && this.modules === modules) {
          trials.push(await module.ask<Trial>({ ask: "trial", ...setup, seed: first + next++ }, PATIENCE));
          this.bar.value = trials.length;
          if (trials.length % 10 === 0) this.report(trials, runs, begun);
        }
      }));
      this.report(trials, runs, begun);
    } catch (error) {
      this.report(trials, runs, begun);
      if (error instanceof Refusal && error.message !== "stopped") this.results.prepend(element("pre", { class: "bad" }, error.message));
    }
    if (this.modules === modules) this.stop();
    modules.forEach((module) => module.stop("stopped"));
  }

  private report(trials: Trial[], runs: number, begun: number): void {
    const groups = new Map<string, Trial[]>();
    for (const trial of [...trials].sort((one, other) => one.seed - other.seed)) {
      const name = endOf(trial);
      groups.set(name, [...(groups.get(name) ?? []), trial]);
    }
    const rows = [...groups].sort(([one], [other]) => one.localeCompare(other)).map(([name, group]) => {
      const times = group.map(({ t }) => t);
      const [least, most] = [Math.min(...times).toFixed(1), Math.max(...times).toFixed(1)];
      const span = least === most ? `${least} s` : `${least} to ${most} s`;
      const isGood = name === GOOD || name === OVER;
      const seeds = element("div", { class: "seeds" });
      for (const { seed } of group.slice(0, 60)) seeds.append(button(String(seed), () => this.show(seed), { title: `Show the run of seed ${seed}` }));
      if (group.length > 60) seeds.append(`and ${group.length - 60} more`);
      return element("tr", {}, element("th", { scope: "row", class: isGood ? "good" : "bad" }, name), element("td", {}, String(group.length)), element("td", {}, span), element("td", {}, seeds));
    });
    const head = element("tr", {}, ...["End", "Runs", "Duration", "Seeds"].map((text) => element("th", { scope: "col" }, text)));
    const seconds = ((performance.now() - begun) / 1000).toFixed(1);
    this.results.replaceChildren(element("p", {}, `${trials.length} of ${runs} runs in ${seconds} s`), element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)));
  }
}
