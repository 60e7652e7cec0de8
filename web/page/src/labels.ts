// Atoms where they began, by the number of their state.
import { colour } from "./canvas";
import type { Run } from "./run";

const RADIUS = 7.5;
/** Maximum number of atoms that are shown: the last ones. */
const MOST = 100;
/** Directions in which a number moves off another. */
const TURNS = Array.from({ length: 8 }, (_, number) => (number * Math.PI) / 4 - Math.PI / 2);

/** Draws where atoms began; of a stale run without numbers. */
export function beginnings(
  context: CanvasRenderingContext2D, run: Run, turn: number, isStale: boolean, toX: (x: number) => number, toY: (y: number) => number,
): void {
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 1;
  const way = colour("way");
  context.strokeStyle = way;
  const labels: { text: string; at: [number, number] }[] = [];
  for (const number of run.beginnings.filter((number) => number <= turn).slice(-MOST)) {
    const frame = run.frames[number];
    const state = frame && run.atom(frame.atom)?.state;
    if (!frame || state == null) continue;
    const [x, y] = [toX(frame.pose[0]), toY(frame.pose[1])];
    const at = free(x, y, labels.map(({ at }) => at));
    circle(context, x, y, 2.5, way);
    if (isStale) continue;
    labels.push({ text: String(state), at });
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(...at);
    context.stroke();
  }
  // Above all lines that lead to them.
  for (const { text, at: [x, y] } of labels) {
    circle(context, x, y, RADIUS, colour("paper"));
    context.fillStyle = colour("ink");
    context.fillText(text, x, y + 0.5);
  }
}

function circle(context: CanvasRenderingContext2D, x: number, y: number, radius: number, fill: string): void {
  context.fillStyle = fill;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
}

/** Returns a place for a number at a point or near it that no other number takes; the point itself if there is none. */
function free(x: number, y: number, taken: [number, number][]): [number, number] {
  const isFree = ([x, y]: [number, number]) => taken.every(([otherX, otherY]) => Math.hypot(x - otherX, y - otherY) >= 2 * RADIUS + 1);
  const places = [1.15, 2.3].flatMap((far) => TURNS.map((turn): [number, number] => [x + 2 * RADIUS * far * Math.cos(turn), y + 2 * RADIUS * far * Math.sin(turn)]));
  return [[x, y] as [number, number], ...places].find(isFree) ?? [x, y];
}
