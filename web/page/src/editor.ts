// The editor: what it knows of the language comes from the module.
import { acceptCompletion, autocompletion, closeBrackets, closeBracketsKeymap, type CompletionContext, type CompletionResult, completionKeymap, snippetCompletion } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, HighlightStyle, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, lintKeymap, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState, type Extension, StateEffect, StateField, type Text } from "@codemirror/state";
import { Decoration, type DecorationSet, drawSelection, EditorView, highlightActiveLine, hoverTooltip, keymap, lineNumbers, tooltips } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Completion, Diagnosis, Edit, Range } from "./answers";
import { markdown } from "./dom";
import { mdle } from "./language";
import type { Module } from "./module";

const COLOURS = HighlightStyle.define([
  { tag: tags.comment, class: "tok-comment" },
  { tag: tags.keyword, class: "tok-keyword" },
  { tag: tags.number, class: "tok-number" },
  { tag: tags.string, class: "tok-string" },
  { tag: tags.operator, class: "tok-keyword" },
]);

const THEME = EditorView.theme({
  "&": { color: "var(--ink)", backgroundColor: "var(--paper)" },
  ".cm-content": { caretColor: "var(--ink)" },
  ".cm-gutters": { color: "var(--quiet)", backgroundColor: "var(--paper)", border: "none" },
  ".cm-activeLine, .cm-activeLineGutter": { backgroundColor: "color-mix(in srgb, var(--accent) 9%, transparent)" },
  ".cm-cursor": { borderLeftColor: "var(--ink)" },
  "&.cm-focused > .cm-scroller > .cm-selectionLayer .cm-selectionBackground, .cm-selectionBackground": {
    backgroundColor: "color-mix(in srgb, var(--accent) 28%, transparent)",
  },
  ".cm-tooltip": { color: "var(--ink)", backgroundColor: "var(--paper)", border: "1px solid var(--line)", borderRadius: "6px" },
  ".cm-tooltip-autocomplete ul li[aria-selected]": { color: "var(--on-accent)", backgroundColor: "var(--accent)" },
  ".cm-panels": { color: "var(--ink)", backgroundColor: "var(--ground)" },
  ".cm-diagnosticText": { whiteSpace: "pre-wrap" },
  ".tok-comment": { color: "var(--quiet)", fontStyle: "italic" },
  ".tok-keyword": { color: "var(--accent)", fontWeight: "600" },
  ".tok-number": { color: "var(--good)" },
  ".tok-string": { color: "var(--warn)" },
  ".tok-class": { fontWeight: "700" },
  ".tok-event": { color: "var(--warn)" },
  ".tok-variable": { color: "var(--warn)" },
  ".tok-property, .tok-parameter": { fontStyle: "italic" },
});

/** Returns the offset of a line and a column, both from 0. */
function offset(text: Text, line: number, column: number): number {
  if (line >= text.lines) return text.length;
  const found = text.line(line + 1);
  return Math.min(found.from + column, found.to);
}

function span(text: Text, [line, column, endLine, endColumn]: Range): { from: number; to: number } {
  const from = offset(text, line, column);
  return { from, to: Math.max(from, offset(text, endLine, endColumn)) };
}

function change(text: Text, { range, insert }: Edit) {
  return { ...span(text, range), insert };
}

function place(text: Text, position: number) {
  const line = text.lineAt(position);
  return { line: line.number - 1, character: position - line.from };
}

const setColours = StateEffect.define<DecorationSet>();
const colours = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(set, transaction) {
    const moved = set.map(transaction.changes);
    return transaction.effects.reduce((set, effect) => (effect.is(setColours) ? effect.value : set), moved);
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** The plan files, and the name of the one in the editor. */
export interface Draft {
  text: string;
  files: Record<string, string>;
  file: string;
  robot: string;
}

export class Editor {
  readonly view: EditorView;
  private readonly extensions: Extension[];

  constructor(parent: HTMLElement, private module: Module, private draft: () => Draft, changed: () => void, run: () => void) {
    this.extensions = [
      lineNumbers(), history(), drawSelection(), bracketMatching(), closeBrackets(), highlightActiveLine(), highlightSelectionMatches(),
      mdle, syntaxHighlighting(COLOURS), colours, lintGutter(), tooltips({ parent: document.body }),
      autocompletion({ override: [(context) => this.complete(context)] }),
      hoverTooltip((_, position) => this.hover(position), { hideOnChange: true }),
      keymap.of([
        { key: "Mod-Enter", run: () => (run(), true) },
        { key: "Mod-Shift-f", run: () => (void this.format(), true) },
        { key: "Tab", run: acceptCompletion },
        ...closeBracketsKeymap, ...defaultKeymap, ...searchKeymap, ...historyKeymap, ...completionKeymap, ...lintKeymap, indentWithTab,
      ]),
      THEME, EditorView.lineWrapping,
      EditorView.contentAttributes.of({ tabindex: "0", "aria-label": "Text of the plan. Escape, then Tab, leaves the editor." }),
      EditorView.updateListener.of((update) => update.docChanged && changed()),
    ];
    this.view = new EditorView({ parent, state: this.fresh("") });
  }

  /** Makes the state of a file. */
  fresh(text: string): EditorState {
    return EditorState.create({ doc: text, extensions: this.extensions });
  }

  get text(): string {
    return this.view.state.doc.toString();
  }

  /** Moves the cursor to a line, from 1. */
  goTo(line: number, focus = true): void {
    const { doc } = this.view.state;
    const { from } = doc.line(Math.min(Math.max(line, 1), doc.lines));
    this.view.dispatch({ selection: { anchor: from }, effects: EditorView.scrollIntoView(from, { y: "center" }) });
    if (focus) this.view.focus();
  }

  /** Asks for the diagnostics of the text, and shows them unless it has changed meanwhile. */
  async diagnose(): Promise<Diagnosis | undefined> {
    const { doc } = this.view.state;
    const draft = this.draft();
    const diagnosis = await this.module.ask<Diagnosis>({ ask: "diagnose", ...draft });
    if (this.view.state.doc !== doc) return undefined;
    const here = diagnosis.diagnostics.filter(({ file }) => file === draft.file);
    const shown = here.map(({ code, error, range, message, fixes }): Diagnostic => ({
      ...span(doc, range),
      severity: error ? "error" : "warning",
      source: code,
      message,
      actions: fixes.map((fix) => ({ name: fix.title, apply: (view) => view.dispatch({ changes: change(view.state.doc, fix) }) })),
    }));
    const marks = diagnosis.tokens.flatMap(([range, kind]) => {
      const { from, to } = span(doc, range);
      return from < to ? [Decoration.mark({ class: `tok-${kind}` }).range(from, to)] : [];
    });
    this.view.dispatch(setDiagnostics(this.view.state, shown), { effects: setColours.of(Decoration.set(marks, true)) });
    return diagnosis;
  }

  /** Makes the first edit that removes a diagnostic. */
  fix(edit: Edit): void {
    this.view.dispatch({ changes: change(this.view.state.doc, edit) });
  }

  /** Formats the text; returns `false` if it has errors. */
  async format(): Promise<boolean> {
    const { doc } = this.view.state;
    const edits = await this.module.ask<Edit[] | null>({ ask: "format", text: doc.toString() });
    if (edits === null) return false;
    if (this.view.state.doc === doc) this.view.dispatch({ changes: edits.map((edit) => change(doc, edit)) });
    return true;
  }

  private async complete(context: CompletionContext): Promise<CompletionResult | null> {
    const { doc } = context.state;
    const word = context.matchBefore(/[\p{L}\p{Nd}_]+$/u);
    if (!context.explicit && !word && !context.matchBefore(/[( {]$/)) return null;
    const { range, items } = await this.module.ask<Completion>({ ask: "complete", ...this.draft(), at: place(doc, context.pos) });
    if (items.length === 0) return null;
    const options = items.map((item) => {
      const option = { label: item.label, detail: item.detail, type: item.kind, info: item.about === "" ? undefined : () => markdown(item.about) };
      return item.snippet ? snippetCompletion(item.insert.replaceAll("$0", "${}"), option) : { ...option, apply: item.insert };
    });
    return { ...span(doc, range), options, validFor: /^[\p{L}\p{Nd}_]*$/u };
  }

  private async hover(position: number) {
    const { doc } = this.view.state;
    const found = await this.module.ask<{ range: Range; text: string } | null>({ ask: "hover", ...this.draft(), at: place(doc, position) });
    if (found === null || this.view.state.doc !== doc) return null;
    const { from, to } = span(doc, found.range);
    return { pos: from, end: to, create: () => ({ dom: markdown(found.text) }) };
  }
}
