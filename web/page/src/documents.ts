// The files of the plan, as tabs above the editor. The first one is run; it reads the others by `use`.
import type { EditorState } from "@codemirror/state";
import { button, byId } from "./dom";
import type { Editor } from "./editor";
import { offer } from "./replaced";
import { FILE, isName, LONGEST, wrongName } from "./settings";

/** Text of a file that is added: a plan that says how it is used. */
const added = (name: string, plan: string) => `/// plan.mdle reads this file by the line: use "${name}"\n{ ${plan} (null)\n  (Atom (wait 2s) (go 20 0))\n}\n`;

/** Returns where a text names a file in its lines of `use`. */
function usesOf(name: string, text: string): number[] {
  return [...text.matchAll(/^(\s*use\s+")([^"\n]*)"/gm)].filter(([, , used]) => used === name).map(({ index, 1: before = "" }) => index + before.length);
}

export class Documents {
  /** Name of the file in the editor. */
  shown = FILE;
  /** The files in order; the state of the one in the editor is in the editor. */
  private states = new Map<string, EditorState>();
  private readonly name = byId<HTMLInputElement>("name");

  constructor(private tabs: HTMLElement, private editor: Editor, private changed: () => void) {
    this.states.set(FILE, editor.fresh(""));
    byId("add").addEventListener("click", () => this.add());
    byId("remove").addEventListener("click", () => this.remove());
    this.name.addEventListener("change", () => this.rename(this.name.value.trim()));
    this.name.addEventListener("input", () => this.refuse(""));
    tabs.addEventListener("keydown", ({ key }) => {
      const step = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
      if (step === 0) return;
      const { names } = this;
      this.show(names[(names.indexOf(this.shown) + step + names.length) % names.length] ?? FILE);
      this.tabs.querySelector<HTMLElement>('[aria-selected="true"]')?.focus();
    });
    this.draw();
  }

  get names(): string[] {
    return [...this.states.keys()];
  }

  /** Text of the file that is run. */
  get text(): string {
    return this.textOf(FILE);
  }

  /** Texts of the other files. */
  get files(): Record<string, string> {
    return Object.fromEntries(this.names.slice(1).map((name) => [name, this.textOf(name)]));
  }

  /** Takes other files. */
  set(text: string, files: Record<string, string>): void {
    const all = [[FILE, text] as const, ...Object.entries(files)];
    this.states = new Map(all.map(([name, text]) => [name, this.editor.fresh(text)]));
    this.open(FILE);
  }

  /** Shows a file in the editor. */
  show(name: string): void {
    if (name === this.shown || !this.states.has(name)) return;
    this.states.set(this.shown, this.editor.view.state);
    this.open(name);
    this.changed();
  }

  /** Adds a file of this name, or of a free one, and shows it. */
  add(wanted?: string): void {
    const free = ["part.mdle", ...Array.from({ length: LONGEST.files }, (_, number) => `part${number + 2}.mdle`)];
    const name = wanted ?? free.find((name) => !this.states.has(name));
    if (name === undefined || this.states.has(name) || this.states.size > LONGEST.files) return;
    const plan = name.replace(/^.*\/|\.mdle$/g, "").replace(/[^\p{L}\p{Nd}_]/gu, "_");
    this.states.set(name, this.editor.fresh(added(name, plan.replace(/^./u, (first) => first.toUpperCase()))));
    this.show(name);
  }

  private remove(): void {
    const { shown } = this;
    this.show(FILE);
    const state = this.states.get(shown);
    this.states.delete(shown);
    this.draw();
    this.changed();
    offer(`The file ${shown} was removed.`, "Undo", () => this.bringBack(shown, state));
  }

  /** Brings a file back that was removed, unless another one has its name by now. */
  private bringBack(name: string, state: EditorState | undefined): void {
    if (state && !this.states.has(name)) this.states.set(name, state);
    this.show(name);
  }

  private rename(name: string): void {
    const { shown } = this;
    if (name === shown) return this.refuse("");
    if (this.states.has(name)) return this.refuse(`There is another file ${name}.`);
    if (!isName(name)) return this.refuse(wrongName(name));
    this.states = new Map([...this.states].map(([known, state]) => [known === shown ? name : known, state]));
    this.shown = name;
    this.draw();
    this.changed();
    this.offerUses(shown, name);
  }

  /** Says what is wrong with the name in the field; an empty sentence if nothing is. */
  private refuse(sentence: string): void {
    byId("unnamed").textContent = sentence;
    if (sentence === "") this.name.removeAttribute("aria-invalid");
    else this.name.setAttribute("aria-invalid", "true");
  }

  /** Offers to change the lines that use a file by the name that it had. */
  private offerUses(old: string, name: string): void {
    const using = this.names.filter((file) => usesOf(old, this.textOf(file)).length > 0);
    if (using.length === 0) return;
    offer(`The file ${old} is ${name} now.`, `Change the use of it in ${using.join(", ")}`, () => {
      for (const file of using) this.edit(file, usesOf(old, this.textOf(file)).map((from) => ({ from, to: from + old.length, insert: name })));
      this.changed();
    });
  }

  private edit(file: string, changes: { from: number; to: number; insert: string }[]): void {
    const { view } = this.editor;
    const state = this.states.get(file);
    if (file === this.shown) view.dispatch({ changes });
    else if (state) this.states.set(file, state.update({ changes }).state);
  }

  private textOf(name: string): string {
    return name === this.shown ? this.editor.text : this.states.get(name)?.doc.toString() ?? "";
  }

  private open(name: string): void {
    const state = this.states.get(name);
    if (!state) return;
    this.shown = name;
    this.editor.view.setState(state);
    this.draw();
  }

  private draw(): void {
    this.tabs.replaceChildren(...this.names.map((name) => {
      const isShown = name === this.shown;
      return button(name, () => this.show(name), { role: "tab", "aria-controls": "editor", "aria-selected": String(isShown), tabindex: isShown ? "0" : "-1" });
    }));
    byId("naming").hidden = this.shown === FILE;
    this.name.value = this.shown;
    this.refuse("");
  }
}
