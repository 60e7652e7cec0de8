// The floor and the views of a turn: they all show the same one.
import { byId } from "./dom";
import type { FloorView } from "./floor";
import type { Picture } from "./picture";
import type { Run } from "./run";
import type { Signals } from "./signals";
import type { Transitions } from "./transitions";
import type { Why } from "./why";

/** What the picture shows while the text has errors. */
const LAST = "The last plan without errors.";

export class Views {
  constructor(
    private floor: FloorView, private picture: Picture, private why: Why, private signals: Signals, private transitions: Transitions,
  ) {}

  /** Shows a turn, perhaps not on the floor; of a run of an older plan, the picture is that of the plan as it is now. */
  show(run: Run, turn: number, { isOld, hasErrors, onFloor }: { isOld: boolean; hasErrors: boolean; onFloor: boolean }): void {
    if (onFloor) this.floor.at(run, turn, isOld);
    if (isOld) this.picture.clear(`${hasErrors ? LAST : "The plan as it is now."} The run above is of the plan before your change.`);
    else this.picture.at(run, turn);
    this.signals.at(run, turn);
    this.transitions.at(run, turn);
    void this.why.at(run, turn);
    const frame = run.frames[turn];
    const law = run.atom(frame?.atom)?.law ?? "plan over";
    byId("floor").setAttribute("aria-label", frame
      ? `Floor of the world. At ${frame.t.toFixed(1)} s the robot is at ${frame.pose[0].toFixed(2)}, ${frame.pose[1].toFixed(2)} m; ${law}`
      : "Floor of the world");
  }

  /** Makes the floor pale: it is not that of the plan and the fields. */
  fade(isPale: boolean): void {
    this.floor.fade(isPale);
  }

  /** Shows the picture of the plan without a run. */
  noRun(hasErrors: boolean): void {
    this.picture.clear(hasErrors ? LAST : "");
  }

  /** Shows no run. */
  clear(): void {
    this.picture.clear("");
    for (const view of [this.why, this.signals, this.transitions]) view.clear();
  }
}
