// What a run has come to, in sentences for people.
import type { End, Floor, Judged, Pose } from "./answers";
import { byId } from "./dom";
import { distanceTo } from "./places";
import type { Run } from "./run";

/** What a goal says of the robot. */
export const JUDGED: Record<Judged, string> = {
  arrived: "at the goal", bumped: "touching something", astray: "away from the goal",
};

/** Shows a sentence below the floor, and messages of several lines in a block of their own. */
export function status(text: string, isBad = false): void {
  const [first = "", ...rest] = text.trimEnd().split("\n");
  const line = byId("status");
  const shown = rest.length > 0 ? "The run has not begun:" : first;
  // A sentence that is set again would be read aloud again.
  if (line.textContent !== shown) line.textContent = shown;
  line.classList.toggle("bad", isBad);
  const report = byId("report");
  report.hidden = rest.length === 0;
  report.textContent = rest.length === 0 ? "" : text.trimEnd();
}

/** The state of a run of which a turn is shown; its end is told as soon as it is known. */
export function stateOf(run: Run, turn: number): [string, boolean] {
  if (!run.end) return ["Simulating …", false];
  const [sentence, isBad] = endOf(run, run.end);
  return [turn < run.frames.length - 1 && run.end.how !== "stopped" ? `The end of the run: ${sentence}` : sentence, isBad];
}

function endOf(run: Run, { how, by = "", judged }: End): [string, boolean] {
  const time = `${run.duration.toFixed(1)} s`;
  const last = run.frames.at(-1);
  const where = judged === "astray" && last ? astray(run.description.floor.goal, last.pose) : judged ? JUDGED[judged] : "";
  const goal = where ? ` The robot is ${where}.` : "";
  switch (how) {
    case "over": return [`The plan is over after ${time}: ${by}.${goal}`, false];
    case "limit": return [`Stopped after ${time} by the time limit; the plan is not over.${goal}`, false];
    case "full": return [`Stopped after ${time}: the page cannot keep more turns. \`mdle run\` has no such limit.`, true];
    case "fault": return [`A fault after ${time}: ${by}`, true];
    case "broken": return [`${by} The run is shown up to ${time}.`, true];
    case "stopped": return [`Stopped by you after ${time} of the run; the plan is not over.`, false];
  }
}

/** Says by how much a robot misses a goal: by the distance, or else by the heading. */
function astray(goal: Floor["goal"], pose: Pose): string {
  const missing = goal ? distanceTo(goal, pose) : 0;
  if (missing > 0) return `${Math.max(missing, 0.01).toFixed(2)} m away from the goal`;
  const around = (degrees: number) => `${Math.round(((degrees % 360) + 360) % 360)}°`;
  const [heading, tolerance] = goal?.heading ?? [];
  if (heading === undefined || tolerance === undefined) return JUDGED.astray;
  return `in the area of the goal, but its heading is ${around((pose[2] * 180) / Math.PI)}, and the goal asks for ${around(heading)} ± ${Math.round(tolerance)}°`;
}
