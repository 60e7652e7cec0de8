// The list of messages below the editor.
import type { Diagnosis } from "./answers";
import { button, element } from "./dom";
import type { Documents } from "./documents";
import type { Editor } from "./editor";
import type { Module } from "./module";
import { isName } from "./settings";

/** Shows diagnostics as a list: each goes to its place, its fix, and its explanation. */
export function showProblems(panel: HTMLElement, { diagnostics }: Diagnosis, documents: Documents, editor: Editor, module: Module): void {
  if (diagnostics.length === 0) return panel.replaceChildren(element("span", { class: "good" }, "No errors."));
  const list = element("ul");
  for (const { code, error, file, range, message, fixes } of diagnostics) {
    const line = range[0] + 1;
    const place = documents.names.length > 1 ? `${file}, line ${line}` : `Line ${line}`;
    const inFile = (act: () => void) => () => {
      documents.show(file);
      act();
    };
    const [first, ...lines] = message.split("\n");
    // A help that can be clicked is not written twice.
    const rest = lines.filter((line) => !fixes.some(({ title }) => line === `help: ${title}`));
    const item = element("li", { class: error ? "error" : "warning" });
    item.append(button(`${place}: ${first}`, inFile(() => editor.goTo(line))), " ");
    item.append(button(code, () => void explain(item, module, code), { class: "code", title: `Explain ${code}` }));
    if (rest.length > 0) item.append(element("div", { class: "quiet" }, rest.join("\n")));
    for (const fix of fixes) item.append(button(fix.title, inFile(() => editor.fix(fix)), { class: "fix" }));
    const [, missing = ""] = /^there is no file `([^`]*)`/.exec(message) ?? [];
    if (isName(missing)) item.append(button(`add the file ${missing}`, () => documents.add(missing), { class: "fix" }));
    list.append(item);
  }
  panel.replaceChildren(list);
}

/** Shows or hides the explanation of a code. */
async function explain(item: HTMLElement, module: Module, code: string): Promise<void> {
  const shown = item.querySelector("pre");
  if (shown) return shown.remove();
  const { output } = await module.ask<{ output: string }>({ ask: "explain", code });
  item.append(element("pre", {}, output.trimEnd()));
}
