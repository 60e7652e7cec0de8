// Checks of the files while they are typed, and the picture of the plan.
import { byId, later, oneAtATime } from "./dom";
import type { Documents } from "./documents";
import type { Editor } from "./editor";
import { choices, offerPlans } from "./form";
import type { Module } from "./module";
import { tell } from "./notice";
import type { Picture } from "./picture";
import { showProblems } from "./problems";
import type { Settings } from "./settings";

/** Time without a keystroke after which the files are kept and the picture is drawn, in milliseconds. */
export const QUIET = 200;
/** Time after which a check of an older text is given up, in milliseconds. */
const OLD = 2000;

/** What other parts of the page have to do with a check. */
interface Around {
  settings: () => Settings;
  /** The files have changed. */
  changed: () => void;
  /** The files rest, and their picture is drawn: it belongs to a run, or to none. */
  settled: () => void;
}

export class Checking {
  /** `true` if the files have errors: the picture is that of the last plan without. */
  hasErrors = false;
  /** Beginning of the check that goes on; 0 if there is none. */
  private begun = 0;

  constructor(
    private editor: Editor, private documents: Documents, private picture: Picture, private language: Module, private around: Around,
  ) {}

  /** The files or the robot have changed. */
  changed(): void {
    if (this.begun > 0 && performance.now() - this.begun > OLD) this.language.stop("The text has changed.");
    this.check();
    this.around.changed();
    this.settled();
  }

  /** Draws the plan once the reader pauses. */
  readonly settled = later(QUIET, () => void this.draw());

  private readonly check = oneAtATime(async () => {
    const { editor } = this;
    const { text } = editor;
    this.begun = performance.now();
    try {
      const diagnosis = await editor.diagnose();
      if (!diagnosis) return;
      showProblems(byId("problems"), diagnosis, this.documents, editor, this.language);
      this.hasErrors = diagnosis.diagnostics.some(({ error }) => error);
      if (!this.hasErrors) offerPlans(diagnosis.plans, diagnosis.roots);
      byId("choice").textContent = choices();
      document.documentElement.dataset.checked = String(performance.now());
    } catch (error) {
      // What an older text was refused for is of no use.
      if (editor.text === text) tell((error as Error).message, true);
    } finally {
      this.begun = 0;
    }
  });

  private async draw(): Promise<void> {
    const { picture, around } = this;
    if (!this.hasErrors) await picture.draw(around.settings()).catch((error: Error) => picture.say(error.message));
    around.settled();
  }
}
