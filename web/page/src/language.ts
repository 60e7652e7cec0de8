// Colours of a plan before its names are known: comments, numbers, texts and keywords. The module colours names.
import { StreamLanguage } from "@codemirror/language";

const KEYWORDS = /^(?:use|Atom|ExecPlan|FRAME|here|module|null|infinity|inf|OR|AND|NOT|RISING|after|or|and|not|rising)$/;

export const mdle = StreamLanguage.define<{ inComment: boolean }>({
  name: "mdle",
  startState: () => ({ inComment: false }),
  token(stream, state) {
    if (state.inComment) {
      state.inComment = !stream.match(/^.*?\*\//);
      if (state.inComment) stream.skipToEnd();
      return "comment";
    }
    if (stream.eatSpace()) return null;
    if (stream.match("//")) {
      stream.skipToEnd();
      return "comment";
    }
    if (stream.match("/*")) {
      state.inComment = true;
      return "comment";
    }
    if (stream.match(/^"[^"]*"?/)) return "string";
    if (stream.match(/^[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?(?:[a-zA-Z]+(?:\/s)?)?/)) return "number";
    const word = stream.match(/^[\p{L}_][\p{L}\p{M}\p{Nd}_]*/u);
    if (word) return KEYWORDS.test((word as RegExpMatchArray)[0]) ? "keyword" : null;
    if (stream.match(/^(?:==|<=|>=|<|>|≤|≥)/)) return "operator";
    stream.next();
    return null;
  },
  languageData: { commentTokens: { line: "//", block: { open: "/*", close: "*/" } }, closeBrackets: { brackets: ["(", "[", "{", '"'] } },
});
