// The list of all transitions of a run: each leads to its turn.
import { button, element } from "./dom";
import type { Run } from "./run";

/** Maximum number of turns that are listed, and of transitions of one of them. */
const MOST = 400;
const OF_A_TURN = 4;

export class Transitions {
  private run: Run | undefined;
  private shown = "";
  private rows = new Map<number, HTMLElement>();
  private current: HTMLElement | undefined;

  constructor(private panel: HTMLElement, private goTo: (turn: number) => void) {
    this.clear();
  }

  /** Lists nothing. */
  clear(): void {
    [this.run, this.shown] = [undefined, ""];
    this.panel.replaceChildren("Run the plan: this panel then lists its transitions.");
  }

  /** Lists the transitions around a turn, and marks the last one, if the panel can be seen. */
  at(run: Run, turn: number): void {
    if (this.panel.hidden) return;
    const place = run.transitions.findLastIndex((number) => number <= turn);
    const all = run.transitions.length;
    const from = all <= MOST ? 0 : Math.min(Math.max(0, MOST / 2 * (Math.floor(Math.max(place, 0) / (MOST / 2)) - 1)), all - MOST);
    const asked = `${from} ${Math.min(all, from + MOST)}`;
    if (this.run !== run || this.shown !== asked) this.list(run, from);
    [this.run, this.shown] = [run, asked];
    const row = this.rows.get(run.transitions[place] ?? -1);
    if (row === this.current) return;
    this.current?.removeAttribute("aria-current");
    row?.setAttribute("aria-current", "true");
    this.current = row;
    this.reveal(row);
  }

  /** Scrolls the list, and nothing else, to a row. */
  private reveal(row: HTMLElement | undefined): void {
    if (!row) return;
    const [box, around] = [row.getBoundingClientRect(), this.panel.getBoundingClientRect()];
    if (box.top < around.top || box.bottom > around.bottom) this.panel.scrollTop += box.top - around.top - around.height / 2;
  }

  private list(run: Run, from: number): void {
    const turns = run.transitions.slice(from, from + MOST);
    this.rows = new Map(turns.map((turn) => [turn, this.row(run, turn)]));
    this.current = undefined;
    const all = run.transitions.length;
    const count = all > turns.length ? `Turns with transitions ${from + 1} to ${from + turns.length} of ${all}.` : `${all} turns with transitions.`;
    const head = element("tr", {}, ...["Time", "What ended, and by what", "What followed"].map((text) => element("th", { scope: "col" }, text)));
    this.panel.replaceChildren(element("p", { class: "quiet" }, count), element("table", {}, element("thead", {}, head), element("tbody", {}, ...this.rows.values())));
  }

  private row(run: Run, turn: number): HTMLElement {
    const frame = run.frames[turn];
    const fired = frame?.fired ?? [];
    const ended = element("td");
    for (const { scope, by } of fired.slice(0, OF_A_TURN)) ended.append(element("div", {}, element("strong", {}, run.named(scope)), `: ${by}`));
    const more = (frame?.made ?? 0) - OF_A_TURN;
    if (more > 0) ended.append(element("div", { class: "quiet" }, `and ${more} more in this turn`));
    const to = fired.at(-1)?.to;
    const skipped = (frame?.skipped ?? []).slice(0, OF_A_TURN).map(([atom]) => run.atom(atom)?.law ?? "");
    if (skipped.length > 0) ended.append(element("div", { class: "skipped" }, `skipped: ${skipped.join(", ")}`));
    const time = `${(frame?.t ?? 0).toFixed(1)} s`;
    const go = button(time, () => this.goTo(turn), { class: "link", title: `Show the turn at ${time}` });
    return element("tr", {}, element("td", {}, go), ended, element("td", {}, to == null ? "plan over" : (run.atom(to)?.law ?? "")));
  }
}
