// A run that the module makes in pieces, all of whose turns are kept.
import type { Description, Element, End, Frame, Moment, Steps } from "./answers";
import type { Module } from "./module";

/** Number of turns of one request: small enough that a run can be stopped between two. */
const PIECE = 100;

/** How often an atom was entered. */
export interface Visits {
  /** Times its law was applied. */
  ran: number;
  /** Times it ended before that. */
  skipped: number;
}

export class Run {
  readonly frames: Frame[] = [];
  /** Turns in which the law of an atom was applied first. */
  readonly beginnings: number[] = [];
  /** Turns with transitions. */
  readonly transitions: number[] = [];
  end: End | undefined;
  private readonly atoms: Element[];
  /** Visits up to the turn before `counted`. */
  private counts: Visits[] = [];
  private counted = 0;

  private constructor(readonly description: Description, private module: Module) {
    this.atoms = description.elements.filter(({ kind }) => kind === "atom");
  }

  /** Puts the robot at its start. */
  static async begin(module: Module, setup: object): Promise<Run> {
    return new Run(await module.ask<Description>({ ask: "begin", ...setup }), module);
  }

  /** Makes the turns to the end, and calls `made` after each piece. */
  async make(made: () => void): Promise<void> {
    while (!this.end) {
      const { turns, end } = await this.module.ask<Steps>({ ask: "step", turns: PIECE });
      if (this.end) return;
      for (const frame of turns) {
        if (frame.began) this.beginnings.push(this.frames.length);
        if (frame.made > 0) this.transitions.push(this.frames.length);
        this.frames.push(frame);
      }
      this.end = end ?? undefined;
      made();
    }
  }

  /** Makes no more turns. */
  stop(how: End): void {
    this.end ??= how;
  }

  /** Time of the last turn in seconds. */
  get duration(): number {
    return this.frames.at(-1)?.t ?? 0;
  }

  /** Explains a turn. */
  async why(turn: number): Promise<Moment[]> {
    return (await this.module.ask<{ moments: Moment[] }>({ ask: "why", turn })).moments;
  }

  /** The atom of this number. */
  atom(number: number | null | undefined): Element | undefined {
    return number == null ? undefined : this.atoms[number];
  }

  /** Numbers of the elements that enclose an atom, itself first. */
  path(atom: number | null): number[] {
    const path: number[] = [];
    let number: number | null = this.description.elements.findIndex((element) => atom !== null && element.atom === atom);
    while (number !== null && number >= 0) {
      path.push(number);
      number = this.description.elements[number]?.parent ?? null;
    }
    return path;
  }

  /** How often each atom ran and was skipped up to a turn. */
  visits(turn: number): Visits[] {
    if (turn + 1 < this.counted || this.counts.length === 0) {
      this.counts = this.atoms.map(() => ({ ran: 0, skipped: 0 }));
      this.counted = 0;
    }
    for (; this.counted <= turn; this.counted++) {
      const frame = this.frames[this.counted];
      if (!frame) break;
      const ran = frame.began && frame.atom !== null ? this.counts[frame.atom] : undefined;
      if (ran) ran.ran++;
      for (const [atom, times] of frame.skipped) {
        const skipped = this.counts[atom];
        if (skipped) skipped.skipped += times;
      }
    }
    return this.counts;
  }

  /** The last transition up to a turn. */
  last(turn: number): Frame | undefined {
    const found = this.transitions.findLast((number) => number <= turn);
    return found === undefined ? undefined : this.frames[found];
  }

  /** A name of an element for people. */
  named(number: number): string {
    const element = this.description.elements[number];
    if (!element) return "";
    return element.law ?? (element.name !== "" ? element.name : element.kind);
  }
}
