// Playback of a run: the turn that is shown, and how it moves.
import { byId } from "./dom";
import type { Run } from "./run";

const BUTTONS = ["play", "previous", "back", "forward", "next", "time"];

export class Player {
  turn = 0;
  private run: Run | undefined;
  private playing = false;
  private time = 0;
  private last = 0;
  private readonly slider = byId<HTMLInputElement>("time");
  private readonly play = byId<HTMLButtonElement>("play");
  private readonly speed = byId<HTMLSelectElement>("speed");

  constructor(private show: (run: Run, turn: number) => void) {
    this.play.addEventListener("click", () => this.toggle());
    const move = {
      back: () => this.go(this.turn - 1),
      forward: () => this.go(this.turn + 1),
      previous: () => this.go(this.run?.transitions.findLast((turn) => turn < this.turn) ?? this.turn),
      next: () => this.go(this.run?.transitions.find((turn) => turn > this.turn) ?? this.turn),
    };
    for (const [id, act] of Object.entries(move)) byId(id).addEventListener("click", act);
    document.addEventListener("keydown", (event) => {
      const { code, altKey, ctrlKey, metaKey, shiftKey } = event;
      // Some keyboards type a letter of a plan with this key.
      if (!altKey || ctrlKey || metaKey || !["Comma", "Period"].includes(code) || /[≤≥]/.test(event.key)) return;
      event.preventDefault();
      if (code === "Comma") (shiftKey ? move.previous : move.back)();
      else (shiftKey ? move.next : move.forward)();
    });
    this.slider.addEventListener("input", () => this.go(Number(this.slider.value)));
  }

  /** Plays a run from its first turn. */
  begin(run: Run): void {
    [this.run, this.turn, this.time] = [run, 0, 0];
    for (const id of BUTTONS) byId<HTMLButtonElement>(id).disabled = false;
    this.set(true);
  }

  /** Has no run any more. */
  clear(): void {
    this.set(false);
    this.run = undefined;
    for (const id of BUTTONS) byId<HTMLButtonElement>(id).disabled = true;
    [this.slider.max, this.slider.value, this.turn] = ["0", "0", 0];
    byId("clock").textContent = "0.0 s";
  }

  /** Takes note of turns that were made meanwhile. */
  more(): void {
    this.slider.max = String(Math.max(0, (this.run?.frames.length ?? 1) - 1));
    this.allowStop();
    this.shown();
  }

  /** Shows a turn, and pauses. */
  go(turn: number): void {
    if (!this.run || this.run.frames.length === 0) return;
    this.set(false);
    this.turn = Math.min(Math.max(turn, 0), this.run.frames.length - 1);
    this.time = this.turn * this.run.description.period;
    this.shown();
  }

  /** Plays or pauses; at the end it plays from the beginning. */
  toggle(): void {
    if (!this.run) return;
    if (!this.playing && this.run.end && this.turn >= this.run.frames.length - 1) [this.turn, this.time] = [0, 0];
    this.set(!this.playing);
  }

  pause(): void {
    this.set(false);
  }

  /** There is something to stop while a run is made or played. */
  private allowStop(): void {
    byId<HTMLButtonElement>("stop").disabled = !this.playing && (!this.run || this.run.end !== undefined);
  }

  private set(playing: boolean): void {
    const begins = playing && !this.playing;
    this.playing = playing;
    this.play.textContent = playing ? "Pause" : "Play";
    this.allowStop();
    if (begins) {
      this.last = performance.now();
      requestAnimationFrame((now) => this.tick(now));
    }
  }

  private tick(now: number): void {
    const { run } = this;
    if (!run || !this.playing) return;
    this.time += (Math.max(0, now - this.last) / 1000) * Number(this.speed.value);
    this.last = now;
    const newest = run.frames.length - 1;
    const turn = Math.min(Math.floor(this.time / run.description.period + 1e-6), newest);
    // A run that is still being made is waited for.
    this.time = Math.min(this.time, (newest + 1) * run.description.period);
    if (turn !== this.turn && turn >= 0) {
      this.turn = turn;
      this.shown();
    }
    if (run.end && this.turn >= newest) return this.set(false);
    requestAnimationFrame((now) => this.tick(now));
  }

  private shown(): void {
    const frame = this.run?.frames[this.turn];
    if (!this.run || !frame) return;
    this.slider.value = String(this.turn);
    const clock = `${frame.t.toFixed(1)} s`;
    byId("clock").textContent = clock;
    this.slider.setAttribute("aria-valuetext", clock);
    this.show(this.run, this.turn);
  }
}
