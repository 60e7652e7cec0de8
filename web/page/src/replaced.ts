// Work that was replaced or removed, with the button that brings it back. The offer waits until the reader closes it.
import { button, byId, element } from "./dom";
import { EXAMPLES, settingsOfExample } from "./examples";
import { isAllSame, type Settings, settingsOf } from "./settings";
import { setAside, wasSetAside } from "./storage";

/** Returns `true` for what is no example as it was opened: it would be missed. */
function isWork(settings: Settings): boolean {
  return settings.text.trim() !== "" && !EXAMPLES.some((example) => isAllSame(settingsOfExample(example), settings));
}

/** Offers something with a button; an empty sentence closes the offer. */
export function offer(sentence: string, title = "", act: () => void = () => {}): void {
  const bar = byId("replaced");
  bar.hidden = sentence === "";
  bar.replaceChildren();
  if (sentence === "") return;
  const close = () => {
    setAside(undefined);
    offer("");
  };
  const accept = button(title, () => {
    close();
    act();
  });
  bar.append(element("span", {}, sentence), accept, button("Close", close));
}

export class Replaced {
  constructor(private now: () => Settings, private put: (settings: Settings) => void) {}

  /** Puts other settings in place of those of the page, and offers these. */
  by(next: Settings, sentence: string, title = "Undo"): void {
    const before = this.now();
    this.put(next);
    this.offer(before, sentence, title);
  }

  /** Offers settings that are in the page no more, if they would be missed; an offer that the page already makes remains otherwise. */
  offer(before: Settings, sentence: string, title = "Undo"): void {
    if (!isWork(before) || isAllSame(before, this.now())) return;
    setAside(before);
    offer(sentence, title, () => this.by(before, "Your plan is back.", "Redo"));
  }

  /** Offers what was replaced before the page was loaded again. */
  offerAgain(): void {
    const before = wasSetAside(settingsOf);
    if (before) this.offer(before, "Your plan was replaced.");
  }
}
