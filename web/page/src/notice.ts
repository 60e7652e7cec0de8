// What the page tells its reader, at the top, until it is closed or something else is told.
import { button, byId, element } from "./dom";

/** Time after which what is no defect goes away, in milliseconds. */
const SHOWN = 8000;
let timer = 0;

/** Tells the reader something; a text, never HTML. An empty text closes the notice. */
export function tell(sentence: string, isBad = false): void {
  clearTimeout(timer);
  const notice = byId("notice");
  notice.classList.toggle("bad", isBad);
  notice.hidden = sentence === "";
  notice.replaceChildren();
  if (sentence === "") return;
  notice.append(element("span", {}, sentence), button("Close", () => tell("")));
  if (!isBad) timer = window.setTimeout(() => tell(""), SHOWN);
}
