// The world as text, and the floor that is drawn of it while no run is shown.
import type { Floor, Ready } from "./answers";
import { byId, element, later } from "./dom";
import type { FloorView } from "./floor";
import { checkSetup, field } from "./form";
import type { Module } from "./module";
import { type Settings, worldText, WORLDS } from "./settings";

/** Time without a keystroke after which the floor is drawn, in milliseconds. */
const QUIET = 200;

export class World {
  private readonly own = element("textarea", { id: "world-text", spellcheck: "false", "aria-label": "World as TOML" });
  private readonly error = element("p", { class: "bad", role: "status" });

  /** Text of the world `own`, which is kept while another world is chosen; empty if there is none yet. */
  private ownText = "";

  /**
   * `changed` is called when another world, or another text of it, is meant; `replaces` before the text of another world, edited,
   * takes the place of an own one.
   */
  constructor(
    private floor: FloorView, private module: Module, private settings: () => Settings, private isOfRun: () => boolean, changed: () => void,
    replaces: () => void,
  ) {
    field("world").addEventListener("change", () => {
      if (field("world").value === "own") this.ownText ||= this.own.value;
      this.own.value = worldText(settings());
      changed();
    });
    const soon = later(QUIET, changed);
    this.own.addEventListener("input", () => {
      if (field("world").value !== "own" && this.ownText !== "") replaces();
      field("world").value = "own";
      this.ownText = this.own.value;
      soon();
    });
    byId("panel-world").append(element("p", { class: "quiet" }, "Change the text, and the floor is drawn again. Lengths are in metres; the book has the format."), this.error, this.own);
  }

  /** Text of the world `own`. */
  get text(): string {
    return this.ownText;
  }

  set({ world, ownWorld }: Settings): void {
    this.ownText = ownWorld;
    this.own.value = world === "own" ? ownWorld : (WORLDS[world] ?? "");
  }

  /** Draws the world with the robot at its start, unless a run in it is shown; marks a field, or a text, that is refused. */
  async draw(): Promise<void> {
    const now = this.settings();
    const ready = await checkSetup(this.module, now);
    this.error.textContent = "";
    try {
      const shown = ready ?? (await this.alone(now));
      if (!this.isOfRun()) this.floor.show(shown);
    } catch (error) {
      this.floor.fade(true);
      this.error.textContent = (error as Error).message;
    }
  }

  private async alone(now: Settings): Promise<Ready> {
    const drawn = await this.module.ask<Floor>({ ask: "floor", world: worldText(now) });
    return { floor: drawn, robot: { pose: drawn.start, round: true, length: 0.205, width: 0.205 } };
  }
}
