// The floor: world, way, atoms where they began, echoes and the robot.
import type { Floor, Outline, Point, Pose } from "./answers";
import { Canvas, colour } from "./canvas";
import type { Run } from "./run";

/** Margin around the world, in metres. */
const MARGIN = 0.4;

export class FloorView {
  private floor: Floor | undefined;
  private run: Run | undefined;
  private turn = 0;
  private readonly canvas: Canvas;

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = new Canvas(canvas, (context, width, height) => this.paint(context, width, height));
  }

  /** Shows a world without a run. */
  show(floor: Floor): void {
    [this.floor, this.run] = [floor, undefined];
    this.canvas.draw();
  }

  /** Shows a turn of a run. */
  at(run: Run, turn: number): void {
    [this.floor, this.run, this.turn] = [run.description.floor, run, turn];
    this.canvas.draw();
  }

  private paint(context: CanvasRenderingContext2D, width: number, height: number): void {
    const { floor, run } = this;
    if (!floor) return;
    const [left, bottom, right, top] = bounds(floor);
    const scale = Math.min(width / (right - left), height / (top - bottom));
    const toX = (x: number) => (x - left) * scale + (width - (right - left) * scale) / 2;
    const toY = (y: number) => (top - y) * scale + (height - (top - bottom) * scale) / 2;
    const path = (points: Point[], [dx, dy]: Point = [0, 0]) => {
      context.beginPath();
      points.forEach(([x, y], place) => (place === 0 ? context.moveTo(toX(x + dx), toY(y + dy)) : context.lineTo(toX(x + dx), toY(y + dy))));
    };
    const outline = (outline: Outline, gone?: Point) => {
      path(outline.points, gone);
      context.strokeStyle = colour("wall");
      context.lineWidth = 2;
      if (outline.solid) {
        context.closePath();
        context.fillStyle = colour("solid");
        context.fill();
      }
      context.stroke();
    };
    const circle = ([x, y]: Point, radius: number) => {
      context.beginPath();
      context.arc(toX(x), toY(y), radius, 0, 2 * Math.PI);
    };
    if (floor.goal) {
      context.fillStyle = colour("goal");
      if ("min" in floor.goal) {
        const { min, max } = floor.goal;
        context.fillRect(toX(min[0]), toY(max[1]), (max[0] - min[0]) * scale, (max[1] - min[1]) * scale);
      } else {
        circle(floor.goal.center, floor.goal.radius * scale);
        context.fill();
      }
    }
    if (floor.charger) {
      circle(floor.charger.at, floor.charger.reach * scale);
      context.strokeStyle = colour("good");
      context.setLineDash([4, 3]);
      context.stroke();
      context.setLineDash([]);
    }
    const frame = run?.frames[this.turn];
    floor.outlines.forEach((one) => outline(one));
    floor.things.forEach((thing, number) => {
      const gone = frame ? frame.gone[number] : ([0, 0] as Point);
      if (gone) outline(thing, gone);
    });
    if (!run || !frame) return this.robot(context, floor.start, toX, toY, scale, false);
    context.strokeStyle = colour("way");
    context.lineWidth = 1.5;
    context.globalAlpha = 0.75;
    path(run.frames.slice(0, this.turn + 1).map(({ pose: [x, y] }): Point => [x, y]));
    context.stroke();
    context.globalAlpha = 1;
    context.fillStyle = colour("echo");
    // The echoes of the last second.
    for (let turn = Math.max(0, this.turn - 10); turn <= this.turn; turn++) {
      context.globalAlpha = turn === this.turn ? 1 : 0.35;
      for (const echo of run.frames[turn]?.echoes ?? []) {
        circle(echo, turn === this.turn ? 2.5 : 1.5);
        context.fill();
      }
    }
    context.globalAlpha = 1;
    this.beginnings(context, run, toX, toY);
    this.robot(context, frame.pose, toX, toY, scale, frame.touches);
  }

  /** Draws the state of each atom where it began; of many the last hundred. */
  private beginnings(context: CanvasRenderingContext2D, run: Run, toX: (x: number) => number, toY: (y: number) => number): void {
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const turn of run.beginnings.filter((turn) => turn <= this.turn).slice(-100)) {
      const frame = run.frames[turn];
      const state = frame && run.atom(frame.atom)?.state;
      if (!frame || state == null) continue;
      const [x, y] = frame.pose;
      context.fillStyle = colour("paper");
      context.strokeStyle = colour("way");
      context.lineWidth = 1;
      context.beginPath();
      context.arc(toX(x), toY(y), 7.5, 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      context.fillStyle = colour("ink");
      context.fillText(String(state), toX(x), toY(y) + 0.5);
    }
  }

  private robot(
    context: CanvasRenderingContext2D, [x, y, heading]: Pose, toX: (x: number) => number, toY: (y: number) => number, scale: number, touches: boolean,
  ): void {
    const form = this.run?.description.form ?? { round: true, length: 0.205, width: 0.205 };
    context.save();
    context.translate(toX(x), toY(y));
    context.rotate(-heading);
    context.fillStyle = colour(touches ? "bad" : "robot");
    context.strokeStyle = colour("paper");
    context.lineWidth = 1.5;
    context.beginPath();
    if (form.round) context.arc(0, 0, form.length * scale, 0, 2 * Math.PI);
    else context.rect(-form.length * scale, -form.width * scale, 2 * form.length * scale, 2 * form.width * scale);
    context.globalAlpha = 0.85;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(form.length * scale, 0);
    context.lineWidth = 2.5;
    context.stroke();
    context.restore();
  }
}

/** Returns the smallest and the largest coordinates of a floor. */
function bounds(floor: Floor): [number, number, number, number] {
  let [left, bottom, right, top] = [floor.start[0] - 1, floor.start[1] - 1, floor.start[0] + 1, floor.start[1] + 1];
  for (const { points } of [...floor.outlines, ...floor.things]) {
    for (const [x, y] of points) {
      [left, right, bottom, top] = [Math.min(left, x), Math.max(right, x), Math.min(bottom, y), Math.max(top, y)];
    }
  }
  return [left - MARGIN, bottom - MARGIN, right + MARGIN, top + MARGIN];
}
