//! Closes brackets that have no closing bracket in the text, and reports them.

use super::{BracketKind, OpenBracket, Pass};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::source::TextRange;
use crate::syntax::token::{Tok, Token};

impl Pass<'_, '_> {
    /// Closes all brackets that are still open at the end of the text.
    pub(super) fn end(&mut self) {
        let stopped = self.balanced.diagnostics.iter().any(|diagnostic| diagnostic.code == Code::E0106);
        let end = self.balanced.tokens.last().map_or(TextRange::new(0, 0), |token| token.place);
        let end = TextRange::new(end.end, end.end);
        while let Some(open) = self.open.last().copied() {
            match open.kind {
                _ if stopped => drop(self.force()),
                BracketKind::Brace => {
                    self.force();
                    self.unclosed_brace(open, end);
                }
                BracketKind::Parenthesis | BracketKind::Atom => {
                    let above = self.open.iter().rev().take_while(|open| open.kind != BracketKind::Brace).count();
                    self.force_down_to(self.open.len() - above, end, "at the latest here");
                }
            }
        }
    }

    fn unclosed_brace(&mut self, open: OpenBracket, end: TextRange) {
        self.balanced.is_open = true;
        if let Some(diagnostic) = open.stray.and_then(|stray| self.balanced.diagnostics.get_mut(stray)) {
            let stray = diagnostic.span();
            let message = diagnostic.clone();
            *diagnostic = match stray {
                Some(stray) => message.fix("a `{` is closed by {}", stray, "}"),
                None => message.help("a `{` is closed by `}`"),
            };
            return;
        }
        let begins = |token: &Token<'_>| {
            matches!(token.kind, Tok::LBrace | Tok::Label(_)) && self.source.is_column_one(token.place)
        };
        let behind = self.raw.get(open.raw + 1..).unwrap_or(&[]);
        match behind.iter().position(begins).map(|offset| open.raw + 1 + offset) {
            Some(next) => {
                self.ends.insert(next);
                let place = self.raw.get(next).map_or(end, |token| token.place);
                self.report_brace(open, place, "perhaps a `}` is missing before this");
            }
            None => self.report_brace(open, end, "a `}` is missing at the latest here"),
        }
    }

    fn report_brace(&mut self, open: OpenBracket, at: TextRange, text: &str) {
        let Some(place) = open.place else { return };
        let span = self.source.span(place);
        let diagnostic = Diagnostic::new(Code::E0103, "this `{` is never closed", span, "opened here");
        self.balanced.diagnostics.push(diagnostic.also(self.source.span(at), text));
    }

    /// Closes the brace that opens at the token with the index `brace`, and all brackets inside it.
    pub(super) fn close_brace_of(&mut self, brace: usize, at: TextRange) {
        if let Some(depth) = self.open.iter().position(|open| open.raw == brace && open.kind == BracketKind::Brace) {
            self.close_down_to(depth, at);
        }
    }

    /// Closes all open brackets except the outermost `depth`, and reports them as never closed. `at` is the place of
    /// the token before which they seem to end.
    pub(super) fn close_down_to(&mut self, depth: usize, at: TextRange) {
        while let Some(open) = self.open.last().copied().filter(|_| self.open.len() > depth) {
            if open.kind == BracketKind::Brace {
                self.force();
                self.report_brace(open, at, "perhaps a `}` is missing before this");
            } else {
                let above = self.open.iter().rev().take_while(|open| open.kind != BracketKind::Brace).count();
                self.force_down_to(self.open.len() - above, at, "before this");
            }
        }
    }
}
