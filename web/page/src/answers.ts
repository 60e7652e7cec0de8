// Answers of the module.

/** Line, column, line, column; from 0, columns in UTF-16 code units. */
export type Range = [number, number, number, number];

export interface Edit {
  range: Range;
  insert: string;
}

export interface Diagnosis {
  diagnostics: { code: string; title: string; error: boolean; file: string; range: Range; message: string; fixes: (Edit & { title: string })[] }[];
  plans: string[];
  /** Plans that no other plan uses. */
  roots: string[];
  tokens: [Range, string][];
}

export interface Completion {
  range: Range;
  items: { label: string; kind: string; detail: string; about: string; insert: string; snippet: boolean }[];
}

export type Point = [number, number];
export type Pose = [number, number, number];

export interface Outline {
  name: string;
  solid: boolean;
  points: Point[];
}

/** A goal; its heading and tolerance are in degrees. */
export type Goal = ({ min: Point; max: Point } | { center: Point; radius: number }) & { heading: [number, number] | null };

export interface Floor {
  outlines: Outline[];
  things: Outline[];
  start: Pose;
  goal: Goal | null;
  charger: { at: Point; heading: number; reach: number } | null;
}

export interface Element {
  kind: "atom" | "loop" | "scope";
  law: string | null;
  name: string;
  condition: string;
  parent: number | null;
  atom: number | null;
  state: number | null;
  line: number;
  /** Name of the file in which it is written. */
  file: string;
}

export interface Robot {
  pose: Pose;
  round: boolean;
  /** Half of the length, or the radius, in metres. */
  length: number;
  width: number;
}

export interface Ready {
  floor: Floor;
  robot: Robot;
}

export interface Description extends Ready {
  elements: Element[];
  period: number;
  limit: number;
}

export interface Fired {
  scope: number;
  completed: boolean;
  by: string;
  to: number | null;
}

export interface Frame {
  t: number;
  pose: Pose;
  velocity: [number, number];
  odometry: Pose;
  battery: number;
  touches: boolean;
  ranges: (number | null)[];
  echoes: Point[];
  gone: (Point | null)[];
  atom: number | null;
  began: boolean;
  /** Times since the scope around the atom and the atom itself were entered, the atom's last. */
  since: number[];
  /** Atoms that were skipped in this turn, each with the number of times. */
  skipped: [number, number][];
  made: number;
  fired: Fired[];
}

/** What the goal says of the end of a run. */
export type Judged = "arrived" | "bumped" | "astray";

export interface End {
  /** `full`: a page would have to keep too many turns; `stopped`: by the reader; `broken`: the module stopped. */
  how: "over" | "limit" | "fault" | "full" | "stopped" | "broken";
  by?: string;
  judged?: Judged | null;
}

export interface Steps {
  turns: Frame[];
  end: End | null;
}

export interface Moment {
  atom: number;
  ends: boolean;
  is_new: boolean;
  completed: boolean;
  scopes: { element: number; since: number; fired: boolean; operands: { fired: boolean; words: string | null }[] }[];
}

export interface Trial {
  seed: number;
  end: "over" | "limit" | "fault";
  fault: string | null;
  t: number;
  contacts: number;
  judged: Judged | null;
  pose: Pose;
}
