// The run that is shown: how it begins, what it shows, and whether it still belongs to the files and fields.
import { byId } from "./dom";
import { FIELDS } from "./form";
import type { Module } from "./module";
import { Player } from "./player";
import { Run } from "./run";
import { isAllSame, isSame, type Settings, setupOf, worldText } from "./settings";
import { stateOf, status } from "./status";
import type { Views } from "./views";

/** Settings that change a run. The robot changes only what the plan is checked for. */
const OF_RUN = FIELDS.filter((name) => name !== "robot" && name !== "world");

/** What other parts of the page have to do with a run. */
interface Around {
  settings: () => Settings;
  hasErrors: () => boolean;
  /** There is no run, and the floor is drawn without one. */
  drawWorld: () => void;
}

export class Running {
  run: Run | undefined;
  private readonly player = new Player((run, turn) => this.show(run, turn));
  /** The settings of the run that is shown. */
  private ranWith: Settings | undefined;
  /** What has changed since. */
  private stale: "" | "plan" | "world" | "fields" = "";
  /** The settings with which a run could not begin. */
  private refusedWith: Settings | undefined;
  /** Number of runs begun. */
  private runs = 0;

  constructor(private module: Module, private views: Views, private around: Around) {}

  /** Shows a turn of the run. */
  go(turn: number): void {
    this.player.go(turn);
  }

  /** The floor that is shown is that of the run. */
  get hasFloor(): boolean {
    return this.run !== undefined && this.stale !== "world";
  }

  /** Shows the turn again, in another view or with another picture; or no run. The floor of another world remains. */
  refresh(): void {
    if (this.run) this.show(this.run, this.player.turn, this.hasFloor);
    else this.views.noRun(this.around.hasErrors());
  }

  /** Shows no run any more. */
  clear(): void {
    this.run?.stop({ how: "stopped" });
    [this.run, this.ranWith, this.refusedWith] = [undefined, undefined, undefined];
    this.player.clear();
    this.views.clear();
    status("");
    this.showStale();
  }

  /** Begins a run, and plays it while it is being made. */
  async begin(): Promise<void> {
    this.clear();
    status("Compiling …");
    byId<HTMLButtonElement>("stop").disabled = false;
    const number = ++this.runs;
    const given = this.around.settings();
    const begun = performance.now();
    let next: Run | undefined;
    try {
      next = await Run.begin(this.module, setupOf(given));
      if (number !== this.runs) return;
      [this.run, this.ranWith] = [next, given];
      // The text may have changed while it was compiled.
      this.showStale();
      this.player.begin(next);
      await next.make(() => this.run === next && this.player.more());
      document.documentElement.dataset.simulated = String(performance.now() - begun);
    } catch (error) {
      if (number === this.runs) this.broken(next, given, (error as Error).message);
    }
  }

  /** Ends the run that is being made, and its playback. */
  stop(): void {
    if (!this.run) return this.module.stop("Stopped by you.");
    this.run.stop({ how: "stopped" });
    this.player.pause();
    this.refresh();
  }

  /** Says that the run that is shown is not that of the text and the fields. What another setup was refused for is said no more. */
  showStale(): void {
    const { ranWith, refusedWith } = this;
    const now = this.around.settings();
    if (refusedWith && !isAllSame(refusedWith, now)) {
      this.refusedWith = undefined;
      status("");
    }
    const differs = (names: readonly (keyof Settings)[]) => ranWith !== undefined && names.some((name) => !isSame(name, now, ranWith));
    const isOtherWorld = ranWith !== undefined && worldText(now) !== worldText(ranWith);
    this.stale = differs(["text", "files", "plan"]) ? "plan" : isOtherWorld ? "world" : differs(OF_RUN) ? "fields" : "";
    if (this.stale === "world") this.player.pause();
    byId("stale").hidden = this.stale === "";
    byId("stale").textContent = this.stale === "" ? "" : `This run is of the ${this.stale} before your change. Run again to see the change.`;
    this.views.fade(this.stale !== "");
  }

  /** A run could not be begun, or the module stopped while it was made. */
  private broken(made: Run | undefined, given: Settings, sentence: string): void {
    if (made && made.frames.length > 0) {
      made.stop({ how: "broken", by: sentence });
      return this.player.go(made.frames.length - 1);
    }
    this.clear();
    this.refusedWith = given;
    status(sentence, true);
    // The settings may have changed meanwhile.
    this.showStale();
    this.around.drawWorld();
  }

  private show(run: Run, turn: number, onFloor = true): void {
    this.views.show(run, turn, { isOld: this.stale === "plan", hasErrors: this.around.hasErrors(), onFloor });
    if (onFloor) this.views.fade(this.stale !== "");
    status(...stateOf(run, turn));
  }
}
