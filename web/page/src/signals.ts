// Signals and timers against time.
import type { Frame } from "./answers";
import { Canvas, colour } from "./canvas";
import { element } from "./dom";
import type { Run } from "./run";

interface Signal {
  name: string;
  unit: string;
  of: (frame: Frame) => number | null;
}

const SONARS: Signal[] = Array.from({ length: 16 }, (_, number) => ({ name: `r${number}`, unit: "m", of: (frame) => frame.ranges[number] ?? null }));
const SIGNALS: Signal[] = [
  ...SONARS,
  { name: "v", unit: "m/s", of: (frame) => frame.velocity[0] },
  { name: "omega", unit: "rad/s", of: (frame) => frame.velocity[1] },
  { name: "x", unit: "m", of: (frame) => frame.odometry[0] },
  { name: "y", unit: "m", of: (frame) => frame.odometry[1] },
  { name: "theta", unit: "rad", of: (frame) => frame.odometry[2] },
  { name: "battery", unit: "V", of: (frame) => frame.battery },
  { name: "timer of the atom", unit: "s", of: (frame) => frame.since.at(-1) ?? null },
  { name: "timer of its scope", unit: "s", of: (frame) => frame.since.at(-2) ?? null },
];

/** A signal that is drawn. */
interface Curve extends Signal {
  shade: string;
  values: (number | null)[];
}

/** Width of the scales, left of the curves. */
const LEFT = 72;
const COLOURS = ["way", "echo", "good", "bad", "warn", "quiet"];

export class Signals {
  private run: Run | undefined;
  private turn = 0;
  private readonly canvas: Canvas;
  private readonly boxes: HTMLInputElement[];

  constructor(private panel: HTMLElement) {
    const picks = element("fieldset", { class: "picks" }, element("legend", { class: "hidden" }, "Signals"));
    this.boxes = SIGNALS.map(({ name }) => {
      const box = element("input", { type: "checkbox", value: name, checked: name === "r0" || name === "timer of the atom" });
      box.addEventListener("change", () => this.canvas.draw());
      picks.append(element("label", {}, box, name));
      return box;
    });
    const canvas = element("canvas", { id: "chart", role: "img", "aria-label": "Chart of the chosen signals against time" });
    panel.append(picks, canvas);
    this.canvas = new Canvas(canvas, (context, width, height) => this.paint(context, width, height));
  }

  /** Shows no run. */
  clear(): void {
    this.run = undefined;
    this.canvas.draw();
  }

  at(run: Run, turn: number): void {
    [this.run, this.turn] = [run, turn];
    if (!this.panel.hidden) this.canvas.draw();
  }

  private paint(context: CanvasRenderingContext2D, width: number, height: number): void {
    const { run } = this;
    context.font = "12px system-ui, sans-serif";
    context.fillStyle = colour("quiet");
    if (!run || run.frames.length === 0) return context.fillText("Run the plan to see its signals.", 8, 20);
    const chosen = SIGNALS.filter((_, number) => this.boxes[number]?.checked)
      .map((signal, number) => ({ ...signal, shade: colour(COLOURS[number % COLOURS.length] ?? "ink"), values: run.frames.map(signal.of) }));
    // Columns as wide as the longest entry of the legend can be, with its value.
    const widest = chosen.reduce((widest, { name, unit }) => Math.max(widest, context.measureText(`${name} -88.88 ${unit}`).width), 0) + 28;
    const columns = Math.max(1, Math.floor((width - LEFT) / widest));
    const [top, bottom] = [12 + 16 * Math.ceil(chosen.length / columns), height - 22];
    const last = run.frames.length - 1;
    const toX = (turn: number) => LEFT + ((width - LEFT - 8) * turn) / Math.max(last, 1);
    chosen.forEach((curve, number) => legend(context, curve, this.turn, LEFT + widest * (number % columns), 14 + 16 * Math.floor(number / columns)));
    // Each unit has a scale of its own.
    const units = [...new Set(chosen.map(({ unit }) => unit))];
    const strip = (bottom - top) / Math.max(units.length, 1);
    units.forEach((unit, number) => {
      const from = top + strip * number;
      scaled(context, chosen.filter((curve) => curve.unit === unit), unit, from + 10, from + strip - 4, width, toX);
    });
    context.fillStyle = context.strokeStyle = colour("quiet");
    for (const turn of run.transitions.slice(0, 400)) line(context, toX(turn), bottom, toX(turn), bottom + 5);
    context.fillText("0 s", LEFT, height - 4);
    const end = `${(run.frames[last]?.t ?? 0).toFixed(1)} s`;
    context.fillText(end, width - 8 - context.measureText(end).width, height - 4);
    context.strokeStyle = colour("ink");
    line(context, toX(this.turn), top, toX(this.turn), bottom);
  }
}

/** Names a curve in the legend, with its value in a turn. */
function legend(context: CanvasRenderingContext2D, { name, unit, shade, values }: Curve, turn: number, x: number, y: number): void {
  const now = values[turn];
  context.fillStyle = shade;
  context.fillRect(x, y - 5, 12, 3);
  context.fillStyle = colour("ink");
  context.fillText(`${name} ${now == null ? "–" : now.toFixed(2)} ${unit}`, x + 16, y);
}

/** Draws the curves of one unit between two heights, with their scale. */
function scaled(
  context: CanvasRenderingContext2D, curves: Curve[], unit: string, top: number, bottom: number, width: number, toX: (turn: number) => number,
): void {
  const known = curves.flatMap(({ values }) => values).filter((value): value is number => value !== null);
  const low = known.reduce((low, value) => Math.min(low, value), 0);
  const high = known.reduce((high, value) => Math.max(high, value), low + 1e-3);
  const toY = (value: number) => bottom - ((bottom - top) * (value - low)) / (high - low);
  context.strokeStyle = colour("line");
  context.fillStyle = colour("quiet");
  context.lineWidth = 1;
  for (const value of [low, high]) {
    line(context, LEFT, toY(value), width - 8, toY(value));
    context.fillText(`${value.toFixed(1)} ${unit}`, 4, toY(value) + 4);
  }
  for (const { shade, values } of curves) {
    context.strokeStyle = shade;
    context.lineWidth = 1.5;
    context.beginPath();
    let drawn = false;
    values.forEach((value, turn) => {
      if (value !== null) context[drawn ? "lineTo" : "moveTo"](toX(turn), toY(value));
      drawn = value !== null;
    });
    context.stroke();
  }
}

function line(context: CanvasRenderingContext2D, fromX: number, fromY: number, toX: number, toY: number): void {
  context.beginPath();
  context.moveTo(fromX, fromY);
  context.lineTo(toX, toY);
  context.stroke();
}
