//! Reports words of other languages and misspelled keywords, and replaces them with tokens, so that parsing continues
//! as if the plan were written in MDLe. Each such word gets only one message.

mod advice;
mod loops;

use std::collections::{BTreeMap, BTreeSet};

pub(crate) use advice::advice;
use advice::{advice_for, is_word};

use super::header;
use super::lexer::Lexed;
use super::source::{FileText, TextRange};
use super::token::{Tok, Token};
use crate::diagnostic::{Code, Diagnostic};

/// Returns `true` if a name probably stands for the keyword `Atom`.
fn is_like_atom(name: &str) -> bool {
    (3..=5).contains(&name.len())
        && name.starts_with(['a', 'A'])
        && strsim::damerau_levenshtein(&name.to_ascii_lowercase(), "atom") <= 1
}

/// Reports words of other languages, and replaces them with tokens with which parsing can continue.
pub(super) fn replace<'s>(source: FileText<'s>, lexed: &mut Lexed<'s>) {
    let is_foreign = |token: &Token<'_>| {
        let is_word = |name: &str| is_word(name) || is_like_atom(name) || is_like_loop(name);
        matches!(token.kind, Tok::Use | Tok::LBracket) || matches!(token.kind, Tok::Name(name) if is_word(name))
    };
    if !lexed.tokens.iter().any(is_foreign) {
        return;
    }
    let plans = header::names(&lexed.tokens);
    let old = std::mem::take(&mut lexed.tokens);
    let mut rewriting = Rewriting {
        source,
        old: &old,
        ends: ends(&old),
        plans,
        new: Vec::new(),
        moved: Vec::new(),
        open: Vec::new(),
        found: Vec::new(),
    };
    rewriting.all();
    let Rewriting { new, moved, found, .. } = rewriting;
    let at = |before: usize| moved.get(before).copied().unwrap_or(new.len());
    lexed.docs.iter_mut().for_each(|(before, _)| *before = at(*before));
    lexed.errors.iter_mut().for_each(|(before, _)| *before = at(*before));
    let is_inside = |error: &Diagnostic, place: &TextRange| {
        error
            .span()
            .is_some_and(|span| place.start <= span.within(source.id).start && span.within(source.id).end <= place.end)
    };
    for (before, place, diagnostic) in found {
        lexed.errors.retain(|(_, error)| !is_inside(error, &place));
        lexed.errors.push((before, diagnostic));
    }
    lexed.errors.sort_by_key(|(before, error)| (*before, error.span()));
    lexed.tokens = new;
}

/// Returns `true` if a name is a misspelling of `ExecPlan`, such as `Execplan` or `ExecPlam`.
fn is_like_loop(name: &str) -> bool {
    (7..=9).contains(&name.len())
        && name.starts_with(['e', 'E'])
        && strsim::damerau_levenshtein(&name.to_ascii_lowercase(), "execplan") <= 1
}

/// Returns the index of the closing bracket for each opening bracket that has a partner.
fn ends(tokens: &[Token<'_>]) -> BTreeMap<usize, usize> {
    let (mut ends, mut open) = (BTreeMap::new(), Vec::new());
    for (at, token) in tokens.iter().enumerate() {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no brackets")]
        match token.kind {
            Tok::LParen | Tok::TouchParen => open.push((at, Tok::RParen)),
            Tok::LBrace => open.push((at, Tok::RBrace)),
            Tok::LBracket => open.push((at, Tok::RBracket)),
            Tok::RParen | Tok::RBrace | Tok::RBracket => match open.pop() {
                Some((opener, closer)) if closer == token.kind => drop(ends.insert(opener, at)),
                // After a mismatch, the enclosing brackets have no partner either.
                Some(_) | None => open.clear(),
            },
            _ => {}
        }
    }
    ends
}

struct Rewriting<'t, 's> {
    source: FileText<'s>,
    old: &'t [Token<'s>],
    /// Index of the closing bracket for each opening bracket.
    ends: BTreeMap<usize, usize>,
    /// Names of the plans in this file, because these may also be words of other languages.
    plans: BTreeSet<&'s str>,
    new: Vec<Token<'s>>,
    /// Index of each original token among the new tokens.
    moved: Vec<usize>,
    /// Open brackets; the innermost comes last.
    open: Vec<OpenDelimiter>,
    /// Messages, each with the index of the new token after the reported text, and the place of that text.
    found: Vec<(usize, TextRange, Diagnostic)>,
}

#[derive(Clone, Copy, PartialEq)]
enum OpenDelimiter {
    Brace,
    /// A brace that is treated as a parenthesis.
    Rewritten,
    Parenthesis,
    Atom,
    /// A square bracket that is treated as the parenthesis of an atom.
    Bracket,
}

impl<'s> Rewriting<'_, 's> {
    fn all(&mut self) {
        let mut at = 0;
        while at < self.old.len() {
            let first = self.new.len();
            at = self.next(at).max(at + 1);
            // All original tokens that were processed together map to the same index.
            self.moved.resize(at, first);
        }
    }

    fn kind(&self, at: usize) -> Option<Tok<'s>> {
        self.old.get(at).map(|token| token.kind)
    }

    fn before(&self, at: usize, back: usize) -> Option<Tok<'s>> {
        at.checked_sub(back).and_then(|at| self.kind(at))
    }

    fn place(&self, first: usize, last: usize) -> TextRange {
        let get = |at: usize| self.old.get(at).map_or(TextRange::new(0, 0), |token| token.place);
        TextRange::new(get(first).start, get(last).end.max(get(first).end))
    }

    fn push(&mut self, kind: Tok<'s>, place: TextRange) {
        self.new.push(Token { kind, place });
    }

    fn report(&mut self, place: TextRange, diagnostic: Diagnostic) {
        self.found.push((self.new.len(), place, diagnostic));
    }

    /// Processes the original token at `at`; returns the index of the original token at which to continue.
    fn next(&mut self, at: usize) -> usize {
        let Some(token) = self.old.get(at).copied() else { return at + 1 };
        let rewritten = if token.kind == Tok::Use {
            self.used(at)
        } else if token.kind == Tok::LBracket {
            self.atom_in_brackets(at)
        } else if let Tok::Name(name) = token.kind
            && !self.plans.contains(name)
        {
            self.word(at, name)
        } else {
            None
        };
        if let Some(next) = rewritten {
            return next;
        }
        let mut kind = token.kind;
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no brackets")]
        match token.kind {
            Tok::LBrace => self.open.push(OpenDelimiter::Brace),
            Tok::LParen | Tok::TouchParen => {
                let is_atom = match self.kind(at + 1) {
                    Some(Tok::Atom) => true,
                    Some(Tok::Name(name)) => self.is_atom(at + 1, name),
                    Some(_) | None => false,
                };
                self.open.push(if is_atom { OpenDelimiter::Atom } else { OpenDelimiter::Parenthesis });
            }
            Tok::RParen => self.close(&[OpenDelimiter::Parenthesis, OpenDelimiter::Atom]),
            Tok::RBracket if self.open.last() == Some(&OpenDelimiter::Bracket) => {
                kind = Tok::RParen;
                self.close(&[OpenDelimiter::Bracket]);
            }
            Tok::RBrace => {
                if self.open.last() == Some(&OpenDelimiter::Rewritten) {
                    kind = Tok::RParen;
                }
                self.close(&[OpenDelimiter::Brace, OpenDelimiter::Rewritten]);
            }
            _ => {}
        }
        self.push(kind, token.place);
        at + 1
    }

    fn close(&mut self, kinds: &[OpenDelimiter]) {
        if self.open.last().is_some_and(|open| kinds.contains(open)) {
            self.open.pop();
        }
    }

    /// Returns `true` if `name` begins an atom with a misspelled keyword, such as `(atom (…`.
    fn is_atom(&self, at: usize, name: &str) -> bool {
        let is_open = |kind| matches!(kind, Some(Tok::LParen | Tok::TouchParen));
        is_like_atom(name) && !self.plans.contains(name) && is_open(self.before(at, 1)) && is_open(self.kind(at + 1))
    }

    /// Reports a name that is a keyword of another language and is not the name of a plan in the file. Returns the
    /// index of the original token at which to continue; `None` if the name was not reported.
    fn word(&mut self, at: usize, name: &'s str) -> Option<usize> {
        let place = self.place(at, at);
        if self.is_atom(at, name) {
            let message = format!("`{name}` is not a keyword");
            let span = self.source.span(place);
            let diagnostic = Diagnostic::new(Code::E0102, message, span, "not expected here");
            self.report(place, diagnostic.fix("the keyword is {}", span, "Atom"));
            self.push(Tok::Atom, place);
            let paren = self.old.get(at + 1)?.place;
            self.push(Tok::LParen, paren);
            self.open.push(OpenDelimiter::Parenthesis);
            return Some(at + 2);
        }
        if matches!(name, "import" | "include" | "require") && self.open.is_empty() {
            return self.import(at);
        }
        let is_plan_name = self.before(at, 1) == Some(Tok::LBrace) && self.open.last() == Some(&OpenDelimiter::Brace);
        let is_loop_body = matches!(self.before(at, 2), Some(Tok::Number(_) | Tok::Infinity | Tok::Name(_)))
            && self.before(at, 3) == Some(Tok::ExecPlan);
        let inside = self.open.iter().rev().take_while(|open| **open != OpenDelimiter::Brace);
        if is_plan_name && !is_loop_body
            || self.open.is_empty()
            || inside.into_iter().any(|open| matches!(open, OpenDelimiter::Atom | OpenDelimiter::Bracket))
        {
            return None;
        }
        if is_like_loop(name)
            || matches!(name, "repeat" | "Repeat" | "REPEAT" | "loop" | "Loop" | "for" | "For" | "forever")
        {
            return self.repeat(at, name);
        }
        let condition = self.condition_at(at + 1);
        let help = advice_for(name, condition.unwrap_or("r0 < 1m"))?;
        let is_used =
            !matches!(self.before(at, 1), Some(Tok::ExecPlan | Tok::After | Tok::Comma | Tok::Colon | Tok::Frame));
        let follows =
            matches!(self.kind(at + 1), Some(Tok::LParen | Tok::TouchParen | Tok::LBrace | Tok::Name(_) | Tok::Not));
        if !is_used || !follows {
            return None;
        }
        let message = format!("MDLe has no `{name}`");
        self.report(
            place,
            Diagnostic::new(Code::E0102, message, self.source.span(place), "not expected here").help(help),
        );
        Some(self.past_condition(at + 1))
    }

    /// Returns the condition in the parentheses that open at `at`; `None` if it is too long or too complex for a
    /// proposal.
    fn condition_at(&self, at: usize) -> Option<&'s str> {
        let end = self.end_of(at).filter(|_| self.kind(at) != Some(Tok::LBrace))?;
        let inside = self.old.get(at + 1..end)?;
        let is_condition = |token: &Token<'_>| {
            !matches!(token.kind, Tok::Atom | Tok::LBrace | Tok::RBrace | Tok::Assign | Tok::LBracket | Tok::Colon)
        };
        let text = self.source.slice(self.place(at + 1, end.checked_sub(1)?));
        let is_balanced = text.matches('(').count() == text.matches(')').count();
        let is_short = is_balanced
            && !inside.is_empty()
            && text.len() <= 60
            && !text.contains(['\n', '!', '&', '|', '+', '*', '=']);
        (is_short && inside.iter().all(is_condition)).then_some(text)
    }

    /// Skips the condition after a word, and replaces the braces after the condition with parentheses.
    fn past_condition(&mut self, at: usize) -> usize {
        let mut next = at;
        if matches!(self.kind(at), Some(Tok::LParen | Tok::TouchParen)) && self.kind(at + 1) != Some(Tok::Atom) {
            let Some(end) = self.end_of(at) else { return at };
            next = end + 1;
        } else {
            // `if bumper {`, `else if (…)`
            let is_word = |kind| matches!(kind, Some(Tok::Name(_) | Tok::Not));
            let words = (at..at + 8).take_while(|at| is_word(self.kind(*at))).count();
            if self.kind(at + words) == Some(Tok::LBrace) && self.end_of(at + words).is_some() {
                next = at + words;
            }
        }
        let has_name = matches!(self.kind(next + 1), Some(Tok::Name(name)) if !is_word(name));
        if self.kind(next) != Some(Tok::LBrace) || has_name || self.end_of(next).is_none() {
            return next;
        }
        let place = self.place(next, next);
        self.push(Tok::LParen, place);
        self.open.push(OpenDelimiter::Rewritten);
        next + 1
    }

    /// Returns the index of the bracket that closes the bracket at `at`.
    fn end_of(&self, at: usize) -> Option<usize> {
        self.ends.get(&at).copied()
    }

    /// Reports an atom in square brackets, such as `[Atom (bumper) stop]`, and replaces the opening bracket; the
    /// closing bracket is replaced when it is reached. Returns the index of the original token at which to continue;
    /// `None` if there is no such atom.
    fn atom_in_brackets(&mut self, at: usize) -> Option<usize> {
        let next = self.kind(at + 1)?;
        let is_atom = next == Tok::Atom || matches!(next, Tok::Name(name) if is_like_atom(name));
        let end = self.end_of(at).filter(|_| is_atom)?;
        let (opener, closer) = (self.place(at, at), self.place(end, end));
        let span = self.source.span(opener);
        let diagnostic = Diagnostic::new(Code::E0102, "an atom is written in parentheses", span, "not expected here");
        let inside = self.source.slice(TextRange::new(opener.end, closer.start));
        let diagnostic = match inside.len() <= 60 && !inside.contains('\n') {
            true => {
                let whole = self.source.span(self.place(at, end));
                diagnostic.fix("write {}", whole, format!("({inside})"))
            }
            false => diagnostic.help("`(` and `)` are around an atom: `(Atom (bumper) stop)`"),
        };
        self.report(opener, diagnostic);
        self.push(Tok::LParen, opener);
        self.open.push(OpenDelimiter::Bracket);
        Some(at + 1)
    }

    /// Reports an import of another language, such as `import "corridors.mdle"`. Returns the index of the original
    /// token at which to continue; `None` if there is no import.
    fn import(&mut self, at: usize) -> Option<usize> {
        let place = self.place(at, at);
        if !matches!(self.kind(at + 1), Some(Tok::Str(_))) {
            return None;
        }
        let is_hashed = self.source.slice(TextRange::new(0, place.start)).ends_with('#');
        let written = TextRange::new(place.start - usize::from(is_hashed), place.end);
        let span = self.source.span(written);
        let name = self.source.slice(written);
        let diagnostic = Diagnostic::new(Code::E0102, format!("MDLe has no `{name}`"), span, "not expected here");
        self.report(written, diagnostic.fix("the keyword is {}", span, "use"));
        self.push(Tok::Use, place);
        Some(at + 1)
    }

    /// Reports a file name without quotes, such as `use corridors.mdle`. Returns the index of the original token at
    /// which to continue; `None` if there is no such name.
    fn used(&mut self, at: usize) -> Option<usize> {
        if matches!(self.kind(at + 1), Some(Tok::Str(_))) || !self.open.is_empty() {
            return None;
        }
        let word = self.place(at, at);
        let line = self.source.text.get(word.end..)?.lines().next().unwrap_or("");
        let path = line.split("//").next().unwrap_or("").trim_end_matches([';', ' ', '\t', '\r']);
        let path = path.trim_start();
        let file = path.trim_matches(|c: char| "'`<>“”„‘’".contains(c));
        if file.is_empty() || file.contains(|c: char| c.is_whitespace() || "{}()\"".contains(c)) {
            return None;
        }
        let start = word.end + line.find(path)?;
        let place = TextRange::new(start, start + path.len());
        let span = self.source.span(place);
        let message = "the name of a file is written between double quotes";
        let diagnostic = Diagnostic::new(Code::E0102, message, span, "no quotes around this");
        self.push(Tok::Use, word);
        self.report(place, diagnostic.fix("write {}", span, format!("\"{file}\"")));
        self.push(Tok::Str(file), place);
        let inside = (at + 1..self.old.len()).take_while(|at| self.place(*at, *at).start < place.end).count();
        Some(at + 1 + inside)
    }
}
