//! Replaces loops in the syntax of other languages, such as `repeat 3 { … }`, `forever { … }`, `for i in range(3): …`.

use super::{Rewriting, advice, is_like_loop};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::token::Tok;

impl Rewriting<'_, '_> {
    /// Processes loops such as `repeat 3 { … }`, `repeat(3) { … }` and `forever { … }`.
    pub(super) fn repeat(&mut self, at: usize, name: &str) -> Option<usize> {
        if let Some(body) = self.after_loop_variable(at, name) {
            return Some(body);
        }
        let is_count = |kind| matches!(kind, Some(Tok::Number(_) | Tok::Infinity));
        let (count, next) = if is_count(self.kind(at + 1)) {
            (Some(at + 1), at + 2)
        } else if matches!(self.kind(at + 1), Some(Tok::LParen | Tok::TouchParen))
            && is_count(self.kind(at + 2))
            && self.kind(at + 3) == Some(Tok::RParen)
        {
            (Some(at + 2), at + 4)
        } else {
            (None, at + 1)
        };
        let times = match count {
            Some(count) => self.source.slice(self.place(count, count)),
            None => "inf",
        };
        let place = self.place(at, next - 1);
        let span = self.source.span(self.place(at, at));
        let message = match is_like_loop(name) {
            true => format!("`{name}` is not a keyword"),
            false => format!("MDLe has no `{name}`"),
        };
        let diagnostic = Diagnostic::new(Code::E0102, message, span, "not expected here");
        if matches!(self.kind(next), Some(Tok::LBrace | Tok::Name(_)))
            && (count.is_some() || self.kind(next) == Some(Tok::LBrace))
        {
            let whole = self.source.span(place);
            self.report(
                place,
                diagnostic.fix("a loop is written {} and what it repeats", whole, format!("ExecPlan {times}")),
            );
            self.push(Tok::ExecPlan, self.place(at, at));
            match count {
                Some(count) => self.push(self.kind(count)?, self.place(count, count)),
                None => self.push(Tok::Infinity, self.place(at, at)),
            }
            return Some(next);
        }
        let help = advice("repeat")?;
        if count.is_none() && !matches!(self.kind(next), Some(Tok::LParen | Tok::TouchParen)) {
            return None;
        }
        self.report(place, diagnostic.help(help));
        Some(if count.is_some() { next } else { self.past_condition(next) })
    }

    /// Processes loops such as `for i in 1..3 …`, `for i in range(3): …` and `for i = 1:3 …`, except their bodies.
    fn after_loop_variable(&mut self, at: usize, name: &str) -> Option<usize> {
        let variable = self.kind(at + 1).filter(|kind| matches!(kind, Tok::Name(_)) && !is_like_loop(name))?;
        if !matches!(self.kind(at + 2), Some(Tok::Name("in" | "from" | "of") | Tok::Assign)) {
            return None;
        }
        let mut body = at + 3;
        while let Some(kind) = self.kind(body) {
            let begins = matches!(kind, Tok::LParen | Tok::LBrace | Tok::RBrace | Tok::ExecPlan | Tok::Frame);
            if begins || self.source.slice(self.place(at, body)).contains('\n') {
                break;
            }
            if body > at + 16 {
                return None;
            }
            body = if kind == Tok::TouchParen { self.end_of(body)? + 1 } else { body + 1 };
        }
        let Tok::Name(variable) = variable else { return None };
        let (place, span) = (self.place(at, body - 1), self.source.span(self.place(at, at)));
        let message = format!("MDLe has no `{name}`, and no variables such as `{variable}`");
        let diagnostic = Diagnostic::new(Code::E0102, message, span, "not expected here");
        self.report(place, diagnostic.help(advice("for")?));
        Some(self.past_condition(body))
    }
}
