//! The site: the place at which the parser found an unexpected token, with the surrounding tokens.

use std::cell::OnceCell;
use std::collections::BTreeSet;

use super::header;
use super::source::{FileText, TextRange};
use super::token::{Tok, Token};
use crate::diagnostic::{Code, Diagnostic, Span};

/// The place at which the parser found an unexpected token.
pub(super) struct Site<'t, 's> {
    pub(super) source: FileText<'s>,
    pub(super) tokens: &'t [Token<'s>],
    pub(super) openers: &'t [Option<usize>],
    /// Names of the plans of the text, computed on first use.
    pub(super) plans: &'t OnceCell<BTreeSet<&'s str>>,
    /// Index of the unexpected token.
    pub(super) at: usize,
    pub(super) expected: Vec<String>,
}

impl<'s> Site<'_, 's> {
    /// Returns the unexpected token; `None` at the end of the text.
    pub(super) fn found(&self) -> Option<Tok<'s>> {
        self.kind(self.at)
    }

    /// Returns the token that is `back` tokens before the unexpected token.
    pub(super) fn before(&self, back: usize) -> Option<Tok<'s>> {
        self.at.checked_sub(back).and_then(|at| self.kind(at))
    }

    /// Returns the kind of the token at `at`.
    pub(super) fn kind(&self, at: usize) -> Option<Tok<'s>> {
        self.tokens.get(at).map(|token| token.kind)
    }

    /// Returns the name at `at`; `None` if the token there is not a name.
    pub(super) fn name_at(&self, at: usize) -> Option<&'s str> {
        match self.kind(at) {
            Some(Tok::Name(name)) => Some(name),
            Some(_) | None => None,
        }
    }

    /// Returns the kind of the opening bracket that the bracket at `closer` closes.
    pub(super) fn partner(&self, closer: usize) -> Option<Tok<'s>> {
        self.openers.get(closer).copied().flatten().and_then(|at| self.kind(at))
    }

    /// Returns the index of the innermost open bracket before the unexpected token; `None` if no bracket is open.
    pub(super) fn opener(&self) -> Option<usize> {
        self.openers.get(self.at).copied().flatten()
    }

    /// Returns the kind of the innermost open bracket before the unexpected token.
    pub(super) fn opener_kind(&self) -> Option<Tok<'s>> {
        self.opener().and_then(|at| self.kind(at))
    }

    /// Returns `true` if the innermost open bracket belongs to an atom.
    pub(super) fn in_atom(&self) -> bool {
        self.opener().is_some_and(|at| self.kind(at + 1) == Some(Tok::Atom))
    }

    /// Returns `true` if the name of a plan is missing at the site.
    pub(super) fn is_plan_without_name(&self) -> bool {
        self.before(1) == Some(Tok::LBrace) && self.expects("name") && !self.expects("ExecPlan")
    }

    /// Returns `true` if the site is in the condition of a plan without a name. Such a condition looks like a scope in
    /// formal notation.
    pub(super) fn in_nameless_head(&self) -> bool {
        let Some(paren) = self.opener().filter(|at| *at > 0 && self.kind(*at) == Some(Tok::LParen)) else {
            return false;
        };
        let is_loop = paren >= 3 && self.kind(paren - 3) == Some(Tok::ExecPlan);
        let is_condition = self.expects(",") && self.expects_argument() && self.name_at(paren + 1).is_some();
        self.kind(paren - 1) == Some(Tok::LBrace) && is_condition && !is_loop
    }

    /// Returns the index of the token that determines the region of the error; each region gets one error only. For a
    /// plan without a name, this token is the opening brace, not the token after it.
    pub(super) fn decisive(&self) -> usize {
        if self.is_plan_without_name() { self.at - 1 } else { self.at }
    }

    /// Returns the index of the last token of the group whose bracket opens at `at`.
    pub(super) fn end_of_group(&self, at: usize) -> usize {
        let around = self.openers.get(at).copied().flatten();
        let inside = |next: &usize| self.openers.get(*next).is_some_and(|opener| *opener != around);
        (at + 1..self.openers.len()).take_while(inside).last().unwrap_or(at)
    }

    /// Returns `true` if the grammar allows this terminal at the site.
    pub(super) fn expects(&self, terminal: &str) -> bool {
        self.expected.iter().any(|expected| expected.trim_matches('"') == terminal)
    }

    /// Returns `true` if the grammar allows an element at the site.
    pub(super) fn expects_element(&self) -> bool {
        self.expects("ExecPlan")
    }

    /// Returns `true` if the grammar allows a condition at the site.
    pub(super) fn expects_condition(&self) -> bool {
        self.expects("null")
    }

    /// Returns `true` if the grammar allows an argument at the site.
    pub(super) fn expects_argument(&self) -> bool {
        self.expects("string") && self.expects("number")
    }

    /// Returns the source text from token `first` to token `last`; `None` if the text is not on one line or is too long
    /// for a sentence.
    pub(super) fn text(&self, first: usize, last: usize) -> Option<&'s str> {
        let (first, last) = (self.tokens.get(first)?, self.tokens.get(last)?);
        let text = self.source.slice(TextRange::new(first.place.start, last.place.end));
        (!text.is_empty() && text.len() <= 60 && !text.contains('\n')).then_some(text)
    }

    /// Returns the span from one token to another.
    pub(super) fn span(&self, first: usize, last: usize) -> Span {
        self.source.span(TextRange::new(self.place(first).start, self.place(last).end))
    }

    /// Returns the empty span before a token.
    pub(super) fn before_token(&self, at: usize) -> Span {
        let start = self.place(at).start;
        self.source.span(TextRange::new(start, start))
    }

    /// Returns the index of the brace that follows a name and the group after this name.
    pub(super) fn brace_after_group(&self, name: usize) -> Option<usize> {
        let is_group = matches!(self.kind(name + 1), Some(Tok::LParen | Tok::TouchParen));
        let brace = self.end_of_group(name + 1) + 1;
        (is_group && self.kind(brace) == Some(Tok::LBrace)).then_some(brace)
    }

    /// Returns `true` if the text contains a plan with this name.
    pub(super) fn has_plan(&self, name: &str) -> bool {
        self.plans.get_or_init(|| header::names(self.tokens)).contains(name)
    }

    /// Returns `true` if the tokens look like quarks and comparisons: they are names, values, and operators between
    /// them.
    pub(super) fn is_call(&self, first: usize, last: usize) -> bool {
        let is_value = |at: usize| {
            (first..=last).contains(&at)
                && matches!(self.kind(at), Some(Tok::Name(_) | Tok::Number(_) | Tok::Infinity | Tok::Str(_)))
        };
        let is_negated = |at: usize| at <= last && matches!(self.kind(at), Some(Tok::Not | Tok::Rising));
        let is_sound = |at: usize| match self.kind(at) {
            Some(Tok::Not | Tok::Rising) => matches!(self.kind(at + 1), Some(Tok::Name(_))) && at < last,
            Some(Tok::Or | Tok::And) => at > first && is_value(at - 1) && (is_value(at + 1) || is_negated(at + 1)),
            Some(Tok::Less | Tok::LessOrEqual | Tok::Greater | Tok::GreaterOrEqual | Tok::Equal) => {
                at > first && is_value(at - 1) && is_value(at + 1)
            }
            _ => is_value(at),
        };
        let begins = matches!(self.kind(first), Some(Tok::Name(_) | Tok::Not | Tok::Rising));
        let is_comparison = |at: &usize| is_sound(*at) && !is_value(*at) && !is_negated(*at) && !self.joins(*at);
        let operands = (first..=last).collect::<Vec<_>>();
        let once = operands
            .split(|at| self.joins(*at))
            .all(|operand| operand.iter().copied().filter(is_comparison).count() <= 1);
        begins && once && (first..=last).all(is_sound)
    }

    /// Returns `true` if the token at `at` is OR or AND.
    fn joins(&self, at: usize) -> bool {
        matches!(self.kind(at), Some(Tok::Or | Tok::And))
    }

    /// Returns the index of the bracket that the bracket at `closer` closes.
    pub(super) fn opener_of(&self, closer: usize) -> Option<usize> {
        self.openers.get(closer).copied().flatten()
    }

    /// Returns `true` if a token touches the next one.
    pub(super) fn touches_next(&self, at: usize) -> bool {
        at + 1 < self.tokens.len() && self.place(at).end == self.place(at + 1).start
    }

    /// Creates a message about the token at `at`.
    pub(super) fn about(&self, at: usize, message: impl Into<String>, here: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Code::E0102, message, self.source.span(self.place(at)), here)
    }

    /// Returns `diagnostic` with an additional label for the token at `at`.
    pub(super) fn also(&self, diagnostic: Diagnostic, at: usize, text: &str) -> Diagnostic {
        diagnostic.also(self.source.span(self.place(at)), text)
    }

    fn place(&self, at: usize) -> TextRange {
        let end = self.tokens.last().map_or(0, |token| token.place.end);
        self.tokens.get(at).map_or(TextRange::new(end, end), |token| token.place)
    }

    /// Reports the expected terminals and the unexpected token.
    pub(super) fn unexpected(&self) -> Diagnostic {
        let message = format!("expected {}, found {}", self.expectation(), self.found_words());
        self.about(self.at, message, "not expected here")
    }

    /// Returns the unexpected token in the words of a message.
    pub(super) fn found_words(&self) -> String {
        let Some(found) = self.found() else { return "the end of the file".to_owned() };
        let text = self.text(self.at, self.at).unwrap_or("…");
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are what they look like")]
        match found {
            Tok::Name(_) => format!("the name `{text}`"),
            Tok::Label(_) => format!("the label `{text}`"),
            Tok::Number(_) => format!("the number `{text}`"),
            Tok::Str(_) => format!("the text `{text}`"),
            _ => format!("`{text}`"),
        }
    }

    /// Returns the terminals that the grammar allows at the site, in the words of a message.
    pub(super) fn expectation(&self) -> String {
        let before = self.at.checked_sub(1).and_then(|before| self.kind(before));
        let mut left: Vec<&str> = self.expected.iter().map(|terminal| terminal.trim_matches('"')).collect();
        if let Some(Tok::Less | Tok::LessOrEqual | Tok::Greater | Tok::GreaterOrEqual | Tok::Equal) = before {
            return "a value or a signal".to_owned();
        }
        let mut words: Vec<String> = Vec::new();
        for (sign, whole, parts) in WHOLES {
            if sign.iter().all(|sign| left.contains(sign)) {
                words.push((*whole).to_owned());
                left.retain(|terminal| !parts.contains(terminal));
            }
        }
        let minor = ["Group", "^", ":", "module", "sigma_null", "touching (", "parameters (", "condition ("];
        let (small, large): (Vec<&str>, Vec<&str>) = left.into_iter().partition(|terminal| minor.contains(terminal));
        let left = if words.is_empty() && large.is_empty() { small } else { large };
        words.extend(left.into_iter().map(terminal_words));
        match words.split_last() {
            None => "something else".to_owned(),
            Some((only, [])) => only.clone(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
        }
    }
}

/// Names for sets of terminals. Each entry contains the terminals that indicate the set, the name of the set, and the
/// terminals that the set includes.
const WHOLES: &[(&[&str], &str, &[&str])] = &[
    (&["ExecPlan"], "an element", &["name", "{", "(", "ExecPlan", "FRAME", "label"]),
    (&["use", "{"], "a plan", &["use", "label", "{"]),
    (&["null"], "a condition", &["name", "(", "NOT", "RISING", "null", "after"]),
    (&["string", "number"], "an argument", &["name", "(", "number", "inf", "string"]),
    (&["number", "inf", "name"], "a count", &["number", "inf", "name"]),
    (&["=="], "a comparison", &["==", "<", "<=", ">", ">="]),
    (&["name", "("], "a law", &["name", "("]),
];

/// Returns a terminal of the grammar in the words of a message.
fn terminal_words(terminal: &str) -> String {
    match terminal {
        "name" => "a name".to_owned(),
        "label" => "a label".to_owned(),
        "number" => "a number".to_owned(),
        "string" => "a text in quotes".to_owned(),
        "touching (" | "parameters (" | "condition (" => "`(`".to_owned(),
        other => format!("`{other}`"),
    }
}
