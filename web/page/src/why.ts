// Explains a turn: which conditions held, with their values, and which atoms were skipped.
import type { Moment } from "./answers";
import { button, element } from "./dom";
import type { Run } from "./run";
import { FILE } from "./settings";

export class Why {
  private shown = "";
  /** The run whose turn is shown: its turns have the same numbers as those of another. */
  private run: Run | undefined;

  constructor(private panel: HTMLElement, private goTo: (file: string, line: number) => void) {
    this.clear();
  }

  /** Explains nothing. */
  clear(): void {
    [this.shown, this.run] = ["", undefined];
    this.panel.replaceChildren("Run the plan: this panel then explains the turn that is shown.");
  }

  /** Explains a turn, if the panel can be seen. */
  async at(run: Run, turn: number): Promise<void> {
    const frame = run.frames[turn];
    const asked = String(turn);
    if (this.panel.hidden || !frame || (this.run === run && this.shown === asked)) return;
    [this.shown, this.run] = [asked, run];
    const title = element("h2", {}, `Turn ${turn}, at ${frame.t.toFixed(1)} s`);
    let moments: Moment[];
    try {
      moments = await run.why(turn);
    } catch (error) {
      if (this.run === run && this.shown === asked) {
        this.panel.replaceChildren(title, element("p", {}, `This turn cannot be explained: ${(error as Error).message}. Run the plan again.`));
      }
      return;
    }
    if (this.run !== run || this.shown !== asked) return;
    const parts: HTMLElement[] = [title];
    if (frame.made > moments.length) parts.push(element("p", { class: "bad" }, `${frame.made} transitions in this turn; not all are shown.`));
    moments.forEach((moment, place) => parts.push(this.moment(run, moment, frame.fired[place]?.by, moments.length === place + 1)));
    if (frame.atom === null) parts.push(element("p", {}, "The plan was over."));
    this.panel.replaceChildren(...parts);
  }

  private moment(run: Run, moment: Moment, by: string | undefined, isLast: boolean): HTMLElement {
    const atom = run.atom(moment.atom);
    const skipped = moment.ends && moment.is_new;
    const step = element("div", { class: skipped ? "step skipped" : "step" });
    const what = skipped ? "was skipped" : moment.ends ? "ended" : "runs";
    const cause = moment.ends && !(isLast && !by) ? `: ${by ?? ""}` : "";
    const { line = 1, file = FILE } = atom ?? {};
    const place = file === FILE ? `line ${line}` : `${file}, line ${line}`;
    step.append(element("p", {}, element("strong", {}, atom?.law ?? ""), ` (`, button(place, () => this.goTo(file, line), { class: "link" }), `) ${what}${cause}`));
    for (const { element: number, since, fired, operands } of moment.scopes) {
      const scope = run.description.elements[number];
      if (!scope) continue;
      const name = scope.kind === "atom" ? "the atom itself" : scope.name !== "" ? scope.name : "scope";
      step.append(element("div", {}, `${name}, for ${since.toFixed(1)} s: ${operands.length === 0 ? "no interrupt" : fired ? "its interrupt has fired" : "its interrupt has not fired"}`));
      const list = element("ul");
      for (const { fired, words } of operands) list.append(element("li", { class: fired ? "yes" : "no" }, words ?? scope.condition));
      if (operands.length > 0) step.append(list);
    }
    if (!moment.ends || moment.completed) step.append(element("div", { class: "quiet" }, moment.completed ? "Its law is done." : "Its law is not done."));
    return step;
  }
}
