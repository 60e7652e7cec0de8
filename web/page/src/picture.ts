// The picture of the plan, as `mdlec draw` makes it, with the active path and the number of times that atoms were entered.
import { button, element } from "./dom";
import type { Module } from "./module";
import { draftOf, type Settings } from "./settings";
import type { Run, Visits } from "./run";

const SVG = "http://www.w3.org/2000/svg";
/** Scale to which a picture that is wider than its panel is reduced at most: smaller words cannot be read. */
const SMALLEST = 0.6;
const STYLE = `
  svg { display: block; width: 100%; height: auto; min-width: calc(${SMALLEST} * var(--natural)); max-width: var(--natural) }
  :host(.full) svg { min-width: var(--natural) }
  g.path > rect:first-of-type { stroke-width: 3.5px }
  g.current > rect:first-of-type { stroke-width: 4px; stroke: var(--robot) }
  g.ended > rect:first-of-type { stroke: var(--bad) }
  .visits { font: 11px system-ui, sans-serif; fill: var(--quiet) }
  .skipped { fill: var(--warn) }
`;

export class Picture {
  private readonly host: HTMLElement;
  private readonly shadow: ShadowRoot;
  private atom: number | null = null;
  private boxes: Element[] = [];
  private visits: Element[] = [];
  private readonly caption = element("p", { class: "quiet" });
  private drawn = "";

  constructor(parent: HTMLElement, private module: Module) {
    this.host = element("div", { class: "scrolled", tabindex: "0", role: "group", "aria-label": "Picture of the plan" });
    const full: HTMLButtonElement = button("Full size", () => {
      full.setAttribute("aria-pressed", String(this.host.classList.toggle("full")));
      this.scroll();
    }, { "aria-pressed": "false", title: "Show the picture in its full size, or in the width of this panel" });
    parent.append(element("div", { class: "caption" }, this.caption, full), this.host);
    // The picture has a style of its own.
    this.shadow = this.host.attachShadow({ mode: "open" });
  }

  /** Draws a plan. */
  async draw(settings: Settings): Promise<void> {
    if (settings.text.trim() === "") return this.say("");
    const { output } = await this.module.ask<{ output: string }>({ ask: "draw", ...draftOf(settings), plan: settings.plan || null });
    if (output === this.drawn) return;
    const svg = document.importNode(new DOMParser().parseFromString(output, "image/svg+xml").documentElement, true);
    svg.style.setProperty("--natural", `${Number(svg.getAttribute("width"))}px`);
    this.drawn = output;
    this.shadow.replaceChildren(element("style", {}, STYLE), svg);
    this.atom = null;
    this.boxes = [...this.shadow.querySelectorAll("svg > g")];
    this.visits = this.boxes.map((box) => {
      const rect = box.querySelector("rect");
      const text = document.createElementNS(SVG, "text");
      const number = (name: string) => Number(rect?.getAttribute(name));
      text.setAttribute("class", "visits");
      text.setAttribute("text-anchor", "end");
      text.setAttribute("x", String(number("x") + number("width") - 2));
      text.setAttribute("y", String(number("y") + number("height") + 12));
      box.append(text);
      return text;
    });
  }

  /** Says why there is no picture. */
  say(sentence: string): void {
    this.drawn = "";
    [this.boxes, this.visits] = [[], []];
    this.shadow.replaceChildren(element("pre", {}, sentence));
  }

  /** Shows the picture without a run. */
  clear(caption: string): void {
    this.caption.textContent = caption;
    for (const box of this.boxes) box.classList.remove("path", "current", "ended");
    for (const label of this.visits) label.replaceChildren();
    this.atom = null;
  }

  /** Marks the path to the current atom of a turn, and what ended last. */
  at(run: Run, turn: number): void {
    const frame = run.frames[turn];
    if (!frame || this.boxes.length !== run.description.elements.length) return;
    const path = new Set(run.path(frame.atom));
    const ended = new Set(frame.fired.map(({ scope }) => scope));
    const visits = run.visits(turn);
    run.description.elements.forEach(({ kind, atom }, number) => {
      const box = this.boxes[number];
      box?.classList.toggle("path", path.has(number));
      box?.classList.toggle("current", kind === "atom" && path.has(number));
      box?.classList.toggle("ended", ended.has(number));
      const label = this.visits[number];
      if (label && atom !== null) showVisits(label, visits[atom]);
    });
    const last = run.last(turn);
    const by = last?.fired.at(-1);
    this.caption.textContent = last && by ? `Last transition, at ${last.t.toFixed(1)} s: ${run.named(by.scope)} ended: ${by.by}` : "No transition yet.";
    if (frame.atom !== this.atom) this.scroll();
    this.atom = frame.atom;
  }

  /** Brings the current atom into view, if another part of the picture is shown. */
  private scroll(): void {
    const box = this.shadow.querySelector("g.current > rect")?.getBoundingClientRect();
    if (!box) return;
    const around = this.host.getBoundingClientRect();
    const { host } = this;
    if (box.left < around.left || box.right > around.right) host.scrollLeft += (box.left + box.right - around.left - around.right) / 2;
    if (box.top < around.top || box.bottom > around.bottom) host.scrollTop += (box.top + box.bottom - around.top - around.bottom) / 2;
  }
}

/** Writes how often an atom ran, and how often it was skipped. */
function showVisits(label: Element, { ran, skipped }: Visits = { ran: 0, skipped: 0 }): void {
  const words = [ran > 0 ? `ran ${ran}×` : "", skipped > 0 ? `skipped ${skipped}×` : ""].filter((part) => part !== "").join(", ");
  if (label.textContent === words) return;
  label.textContent = words;
  label.classList.toggle("skipped", skipped > 0);
}
