// A run that the module makes in pieces, all of whose turns are kept.
import type { Description, Element, End, Frame, Moment, Steps } from "./answers";
import type { Module } from "./module";

/** Number of turns of one request: small enough that a run can be stopped between two. */
const PIECE = 100;

export class Run {
  readonly frames: Frame[] = [];
  /** Turns in which the law of an atom was applied first. */
  readonly beginnings: number[] = [];
  /** Turns with transitions. */
  readonly transitions: number[] = [];
  end: End | undefined;
  private stopped = false;
  private readonly atoms: Element[];

  private constructor(readonly description: Description, private module: Module) {
    this.atoms = description.elements.filter(({ kind }) => kind === "atom");
  }

  /** Puts the robot at its start. */
  static async begin(module: Module, setup: object): Promise<Run> {
    return new Run(await module.ask<Description>({ ask: "begin", ...setup }), module);
  }

  /** Makes the turns to the end, and calls `made` after each piece. */
  async make(made: () => void): Promise<void> {
    while (!this.end && !this.stopped) {
      const { turns, end } = await this.module.ask<Steps>({ ask: "step", turns: PIECE });
      if (this.stopped) return;
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
  stop(): void {
    this.stopped = true;
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

  /** How often each atom was entered up to a turn; skipped atoms count. */
  visits(turn: number): number[] {
    const visits = this.atoms.map(() => 0);
    const count = (atom: number | null) => {
      if (atom !== null) visits[atom] = (visits[atom] ?? 0) + 1;
    };
    if (this.frames.length > 0) count(0);
    for (const number of this.transitions) {
      if (number > turn) break;
      for (const { to } of this.frames[number]?.fired ?? []) count(to);
    }
    return visits;
  }

  /** The last transition up to a turn. */
  last(turn: number): { turn: number; frame: Frame } | undefined {
    const found = this.transitions.filter((number) => number <= turn).at(-1);
    const frame = found === undefined ? undefined : this.frames[found];
    return frame && found !== undefined ? { turn: found, frame } : undefined;
  }

  /** A name of an element for people. */
  named(number: number): string {
    const element = this.description.elements[number];
    if (!element) return "";
    return element.law ?? (element.name !== "" ? element.name : element.kind);
  }
}
