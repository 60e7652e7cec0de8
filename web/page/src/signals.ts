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
  { name: "timer around it", unit: "s", of: (frame) => frame.since.at(-2) ?? null },
];
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
    const chosen = SIGNALS.filter((_, number) => this.boxes[number]?.checked);
    // Columns as wide as the longest entry of the legend can be, with its value.
    const widest = chosen.reduce((widest, { name, unit }) => Math.max(widest, context.measureText(`${name} -88.88 ${unit}`).width), 0) + 28;
    const columns = Math.max(1, Math.floor((width - 44) / widest));
    const [left, top, bottom] = [44, 18 + 16 * Math.ceil(chosen.length / columns), height - 22];
    const last = run.frames.length - 1;
    const toX = (turn: number) => left + ((width - left - 8) * turn) / Math.max(last, 1);
    const values = chosen.map((signal) => run.frames.map(signal.of));
    const known = values.flat().filter((value): value is number => value !== null);
    const low = known.reduce((low, value) => Math.min(low, value), 0);
    const high = known.reduce((high, value) => Math.max(high, value), low + 1e-3);
    const toY = (value: number) => bottom - ((bottom - top) * (value - low)) / (high - low);
    context.strokeStyle = colour("line");
    context.lineWidth = 1;
    for (const value of [low, (low + high) / 2, high]) {
      line(context, left, toY(value), width - 8, toY(value));
      context.fillText(value.toFixed(1), 4, toY(value) + 4);
    }
    for (const turn of run.transitions.slice(0, 400)) line(context, toX(turn), bottom, toX(turn), bottom + 5);
    context.fillText("0 s", left, height - 4);
    const end = `${(run.frames[last]?.t ?? 0).toFixed(1)} s`;
    context.fillText(end, width - 8 - context.measureText(end).width, height - 4);
    chosen.forEach((signal, number) => {
      const shade = colour(COLOURS[number % COLOURS.length] ?? "ink");
      context.strokeStyle = shade;
      context.lineWidth = 1.5;
      context.beginPath();
      let drawn = false;
      (values[number] ?? []).forEach((value, turn) => {
        if (value === null) drawn = false;
        else if (drawn) context.lineTo(toX(turn), toY(value));
        else {
          context.moveTo(toX(turn), toY(value));
          drawn = true;
        }
      });
      context.stroke();
      const now = values[number]?.[this.turn];
      const [x, y] = [left + widest * (number % columns), 14 + 16 * Math.floor(number / columns)];
      context.fillStyle = shade;
      context.fillRect(x, y - 5, 12, 3);
      context.fillStyle = colour("ink");
      context.fillText(`${signal.name} ${now == null ? "–" : now.toFixed(2)} ${signal.unit}`, x + 16, y);
    });
    context.strokeStyle = colour("ink");
    line(context, toX(this.turn), top, toX(this.turn), bottom);
  }
}

function line(context: CanvasRenderingContext2D, fromX: number, fromY: number, toX: number, toY: number): void {
  context.beginPath();
  context.moveTo(fromX, fromY);
  context.lineTo(toX, toY);
  context.stroke();
}
