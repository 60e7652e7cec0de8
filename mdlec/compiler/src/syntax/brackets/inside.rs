//! Reports errors from which the grammar could not recover: a label inside its atom, and a `use` inside a plan.

use super::{BracketKind, Pass};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::token::{Tok, Token};
use crate::syntax::tree::Name;

impl<'s> Pass<'_, 's> {
    /// Reports a label between an atom's opening parenthesis and the token `Atom`, and assigns the parenthesis to the
    /// atom. Returns `true` if there is such a label.
    pub(super) fn label_inside(&mut self) -> bool {
        let [.., Token { kind: Tok::LParen | Tok::TouchParen, .. }, Token { kind: Tok::Name(label), place }, colon] =
            self.balanced.tokens.as_slice()
        else {
            return false;
        };
        if colon.kind != Tok::Colon {
            return false;
        }
        let message = format!("the label `{label}` is inside its atom");
        let diagnostic = Diagnostic::new(Code::E0102, message, self.source.span(*place), "not expected here");
        let diagnostic = diagnostic.help(format!("a label is written before its element: `{label}: (Atom …)`"));
        self.spoil(diagnostic);
        if let Some(open) = self.open.last_mut() {
            open.kind = BracketKind::Atom;
        }
        true
    }

    /// Reports a `use` inside a plan, from which the grammar could not recover. The file that it names is treated as
    /// used.
    pub(super) fn inner_use(&mut self, index: usize, token: Token<'s>) {
        let span = self.source.span(token.place);
        let diagnostic = Diagnostic::new(
            Code::E0102,
            "`use` is written between plans, not inside a plan",
            span,
            "not expected here",
        );
        if let Some(Token { kind: Tok::Str(file), place }) = self.raw.get(index + 1) {
            let help = format!("put it at the top of the file: `use \"{file}\"`");
            self.balanced.diagnostics.push(diagnostic.help(help));
            self.balanced.uses.push(Name { node: file, span: self.source.span(*place) });
            return;
        }
        self.spoil(diagnostic.help("put it at the top of the file: `use \"corridors.mdle\"`"));
        self.push(Token { kind: Tok::Name("use"), ..token });
    }
}
