// The floor: world, way, atoms where they began, echoes and the robot.
import type { Floor, Outline, Point, Ready, Robot } from "./answers";
import { Canvas, colour } from "./canvas";
import { beginnings } from "./labels";
import { centre, nameAt, reach } from "./places";
import type { Run } from "./run";

/** Margin around the world, in metres. */
const MARGIN = 0.4;

/** Places of the floor on the canvas. */
interface Scale {
  metre: number;
  toX: (x: number) => number;
  toY: (y: number) => number;
  back: (x: number, y: number) => Point;
}

export class FloorView {
  private shown: Ready | undefined;
  private run: Run | undefined;
  private turn = 0;
  private isStale = false;
  private readonly canvas: Canvas;
  private scale: Scale | undefined;

  constructor(canvas: HTMLCanvasElement, pointed: HTMLElement) {
    this.canvas = new Canvas(canvas, (context, width, height) => this.paint(context, width, height));
    canvas.addEventListener("pointermove", ({ offsetX, offsetY }) => (pointed.textContent = this.under(offsetX, offsetY)));
    canvas.addEventListener("pointerleave", () => (pointed.textContent = ""));
  }

  /** Makes the floor pale, or not. */
  fade(isPale: boolean): void {
    this.canvas.canvas.parentElement?.classList.toggle("stale", isPale);
  }

  /** Shows a world without a run. */
  show(ready: Ready): void {
    this.fade(false);
    [this.shown, this.run] = [ready, undefined];
    this.canvas.draw();
  }

  /** Shows a turn of a run; of a stale one, atoms have no numbers. */
  at(run: Run, turn: number, isStale: boolean): void {
    [this.shown, this.run, this.turn, this.isStale] = [run.description, run, turn, isStale];
    this.canvas.draw();
  }

  /** The place under the pointer in words. */
  private under(x: number, y: number): string {
    if (!this.scale || !this.shown) return "";
    const place = this.scale.back(x, y);
    const name = nameAt(this.shown.floor, place, 6 / this.scale.metre);
    return `${place[0].toFixed(2)}, ${place[1].toFixed(2)} m${name === "" ? "" : `: ${name}`}`;
  }

  private paint(context: CanvasRenderingContext2D, width: number, height: number): void {
    const { shown, run } = this;
    if (!shown) return;
    const { floor } = shown;
    this.scale = scaleOf(floor, shown.robot, width, height);
    const { metre, toX, toY } = this.scale;
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
        context.fillRect(toX(min[0]), toY(max[1]), (max[0] - min[0]) * metre, (max[1] - min[1]) * metre);
      } else {
        circle(floor.goal.center, floor.goal.radius * metre);
        context.fill();
      }
    }
    if (floor.charger) {
      circle(floor.charger.at, floor.charger.reach * metre);
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
    this.names(context, floor, this.scale);
    if (!run || !frame) return this.robot(context, shown.robot, this.scale, false);
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
    beginnings(context, run, this.turn, this.isStale, toX, toY);
    this.robot(context, { ...shown.robot, pose: frame.pose }, this.scale, frame.touches);
  }

  /** Writes the names of goal, charger and things, where there is room for them. */
  private names(context: CanvasRenderingContext2D, floor: Floor, { metre, toX, toY }: Scale): void {
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = colour("quiet");
    const write = (name: string, [x, y]: Point, room: number) => {
      if (context.measureText(name).width <= room * metre) context.fillText(name, toX(x), toY(y));
    };
    if (floor.goal && "min" in floor.goal) {
      const { min, max } = floor.goal;
      write("goal", [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2], max[0] - min[0]);
    } else if (floor.goal) write("goal", floor.goal.center, 2 * floor.goal.radius);
    if (floor.charger) write("charger", floor.charger.at, 2 * floor.charger.reach);
    for (const outline of floor.outlines) {
      const [left, bottom, right, top] = reach(outline);
      // A wall around everything, or a straight one, is no place.
      const isPlace = outline.solid || (outline.points.length === 4 && right - left < 6 && top - bottom > 0.5);
      if (isPlace) write(outline.name, centre(outline), right - left);
    }
  }

  private robot(context: CanvasRenderingContext2D, { pose: [x, y, heading], ...form }: Robot, { metre, toX, toY }: Scale, touches: boolean): void {
    context.save();
    context.translate(toX(x), toY(y));
    context.rotate(-heading);
    context.fillStyle = colour(touches ? "bad" : "robot");
    context.strokeStyle = colour("paper");
    context.lineWidth = 1.5;
    context.beginPath();
    if (form.round) context.arc(0, 0, form.length * metre, 0, 2 * Math.PI);
    else context.rect(-form.length * metre, -form.width * metre, 2 * form.length * metre, 2 * form.width * metre);
    context.globalAlpha = 0.85;
    context.fill();
    context.globalAlpha = 1;
    context.stroke();
    context.beginPath();
    context.moveTo(0, 0);
    context.lineTo(form.length * metre, 0);
    context.lineWidth = 2.5;
    context.stroke();
    context.restore();
  }
}

/** Fits a floor into a canvas. */
function scaleOf(floor: Floor, { pose }: Robot, width: number, height: number): Scale {
  let [left, bottom, right, top] = [pose[0] - 1, pose[1] - 1, pose[0] + 1, pose[1] + 1];
  for (const outline of [...floor.outlines, ...floor.things]) {
    const [west, south, east, north] = reach(outline);
    [left, bottom, right, top] = [Math.min(left, west), Math.min(bottom, south), Math.max(right, east), Math.max(top, north)];
  }
  [left, bottom, right, top] = [left - MARGIN, bottom - MARGIN, right + MARGIN, top + MARGIN];
  const metre = Math.min(width / (right - left), height / (top - bottom));
  const [x0, y0] = [(width - (right - left) * metre) / 2, (height - (top - bottom) * metre) / 2];
  return {
    metre, toX: (x) => (x - left) * metre + x0, toY: (y) => (top - y) * metre + y0, back: (x, y) => [(x - x0) / metre + left, top - (y - y0) / metre],
  };
}
