// What a run has come to, in sentences for people.
import type { Judged } from "./answers";
import { byId } from "./dom";
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

/** The state of a run of which a turn is shown: the end is told when it is shown. */
export function stateOf(run: Run, turn: number): [string, boolean] {
  const time = `${run.duration.toFixed(1)} s`;
  if (!run.end) return ["Simulating …", false];
  if (run.end.how === "stopped") return [`Stopped by you after ${time} of the run; the plan is not over.`, false];
  if (turn < run.frames.length - 1) return [`Simulated up to ${time}.`, false];
  const { how, by = "", judged } = run.end;
  const goal = judged ? ` The robot is ${JUDGED[judged]}.` : "";
  switch (how) {
    case "over": return [`The plan is over after ${time}: ${by}.${goal}`, false];
    case "limit": return [`Stopped after ${time} by the time limit; the plan is not over.${goal}`, false];
    case "full": return [`Stopped after ${time}: the page cannot keep more turns. \`mdle run\` has no such limit.`, true];
    case "fault": return [`A fault after ${time}: ${by}`, true];
    case "broken": return [`${by} The run is shown up to ${time}.`, true];
  }
}
