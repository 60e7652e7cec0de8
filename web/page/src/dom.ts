// Elements of the page. Texts are always set as text, never as HTML.

/** Returns the element of this identifier. */
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no #${id}`);
  return found as T;
}

type Attributes = Record<string, string | boolean>;

/** Makes an element with attributes and children. */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K, attributes: Attributes = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

/** Makes a button that does something. */
export function button(text: string, act: () => void, attributes: Attributes = {}): HTMLButtonElement {
  const made = element("button", { type: "button", ...attributes }, text);
  made.addEventListener("click", act);
  return made;
}

/** Shows a text of Markdown with code blocks and words in code, as the language service writes it. */
export function markdown(text: string): HTMLElement {
  const shown = element("div", { class: "markdown" });
  text.split(/^```\w*\n([\s\S]*?)^```\n?/m).forEach((part, number) => {
    if (number % 2 === 1) return shown.append(element("pre", {}, part.trimEnd()));
    for (const paragraph of part.split(/\n+/).filter((line) => line.trim() !== "" && line.trim() !== "---")) {
      const line = element(paragraph.startsWith("- ") ? "li" : "p");
      paragraph.replace(/^- /, "").split("`").forEach((words, place) => line.append(place % 2 === 1 ? element("code", {}, words) : words));
      shown.append(line);
    }
  });
  return shown;
}

/** Waits until nothing has called for this many milliseconds, and then acts. */
export function later(milliseconds: number, act: () => void): () => void {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = window.setTimeout(act, milliseconds);
  };
}

/** Acts at once, or as soon as what it began before is done; what is asked for meanwhile is done once. */
export function oneAtATime(act: () => Promise<void>): () => void {
  let isBusy = false;
  let isAsked = false;
  const go = async () => {
    isBusy = true;
    do {
      isAsked = false;
      await act();
    } while (isAsked);
    isBusy = false;
  };
  return () => {
    isAsked = true;
    if (!isBusy) void go();
  };
}

/** Offers a text as a file to save. */
export function save(name: string, type: string, text: string): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  element("a", { href: address, download: name }).click();
  window.setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
