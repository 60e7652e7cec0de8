//! Balances brackets before the grammar parses the tokens (docs/src/reference/language.md, 3.7). Afterwards, every
//! bracket has a partner, brackets are nested at most 256 deep, and no atom contains an atom.

mod inside;
mod unclosed;

use std::collections::{BTreeMap, BTreeSet};

use super::indentation::{self, BraceEnd};
use super::lexer::Lexed;
use super::regions::Regions;
use super::source::{FileText, TextRange};
use super::token::{Tok, Token};
use super::tree::Name;
use crate::diagnostic::{Code, Diagnostic};

/// Maximum nesting depth of brackets.
pub(super) const MAX_DEPTH: usize = 256;

/// Tokens whose brackets match.
#[derive(Debug, Default)]
pub(super) struct Balanced<'s> {
    /// Tokens with balanced brackets. Inserted tokens have an empty place.
    pub(super) tokens: Vec<Token<'s>>,
    /// Doc comments, each with the index of the token that follows it.
    pub(super) docs: Vec<(usize, &'s str)>,
    /// Regions of the tokens; an error may affect all tokens of its region.
    pub(super) regions: Regions,
    /// Lexical errors, and errors about brackets.
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Names of files that a `use` inside a plan names.
    pub(super) uses: Vec<Name<'s>>,
    /// `true` if the text contains a brace that is never closed.
    is_open: bool,
    /// `true` if braces that the text never closes have been closed where they seem to end.
    is_repaired: bool,
}

/// Balances the brackets of a text. A brace that is never closed is closed where the indentation shows its end or, if
/// this leaves fewer errors, where its plan seems to end. A repair that causes more errors is discarded.
pub(super) fn balance<'s>(source: FileText<'s>, lexed: &Lexed<'s>) -> Balanced<'s> {
    let (plain, ends) = pass(source, lexed, &BTreeMap::new());
    if !plain.is_open {
        return plain;
    }
    let by_plan = ends.into_iter().map(|end| (end, BraceEnd::OfPlan)).collect();
    let ways = [indentation::ends(source, &lexed.tokens), by_plan];
    ways.into_iter().filter(|ends| !ends.is_empty()).map(|ends| pass(source, lexed, &ends).0).fold(
        plain,
        |best, next| {
            // If a brace is closed too early, its closing brace is left over and reported.
            let is_better = next.diagnostics.len() <= best.diagnostics.len()
                && !(best.is_repaired && best.diagnostics.len() == next.diagnostics.len());
            if is_better { Balanced { is_repaired: true, ..next } } else { best }
        },
    )
}

/// Reads the tokens once, and closes open brackets before the tokens in `ends`. Also returns the tokens before which
/// the braces that are never closed seem to end.
fn pass<'s>(
    source: FileText<'s>,
    lexed: &Lexed<'s>,
    ends: &BTreeMap<usize, BraceEnd>,
) -> (Balanced<'s>, BTreeSet<usize>) {
    let mut errors = lexed.errors.iter().peekable();
    let mut docs = lexed.docs.iter().peekable();
    let mut pass = Pass {
        source,
        raw: &lexed.tokens,
        balanced: Balanced::default(),
        open: Vec::new(),
        braces: 0,
        strays: None,
        reached: 0,
        ends: BTreeSet::new(),
    };
    for (index, token) in lexed.tokens.iter().enumerate() {
        while let Some((_, error)) = errors.next_if(|(before, _)| *before <= index) {
            pass.lexical(error.clone());
        }
        match ends.get(&index) {
            Some(BraceEnd::OfPlan) => pass.close_down_to(0, token.place),
            Some(BraceEnd::OfBrace(brace)) => pass.close_brace_of(*brace, token.place),
            None => {}
        }
        if !pass.token(index, *token) {
            break;
        }
        while let Some((_, doc)) = docs.next_if(|(before, _)| *before <= index) {
            let at = pass.balanced.tokens.len().saturating_sub(1);
            pass.balanced.docs.push((at, doc));
        }
    }
    for (_, error) in errors {
        pass.lexical(error.clone());
    }
    pass.end();
    (pass.balanced, pass.ends)
}

/// Kind of an open bracket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum BracketKind {
    Brace,
    Parenthesis,
    Atom,
}

/// An open bracket.
#[derive(Debug, Clone, Copy)]
struct OpenBracket {
    kind: BracketKind,
    /// Place of the bracket; `None` if it was inserted.
    place: Option<TextRange>,
    /// Index of the bracket among the text's tokens. For an inserted bracket, this is the index of the token before
    /// which it was inserted.
    raw: usize,
    /// Index of the message about a `)` that was written instead of the bracket's `}`; `None` if there is no such
    /// message.
    stray: Option<usize>,
}

/// A series of consecutive closing brackets without opening brackets.
#[derive(Debug, Clone, Copy)]
struct Strays {
    /// Index of the message about the series.
    message: usize,
    /// Index of the last bracket in the series.
    last: usize,
    count: usize,
}

struct Pass<'t, 's> {
    source: FileText<'s>,
    raw: &'t [Token<'s>],
    balanced: Balanced<'s>,
    open: Vec<OpenBracket>,
    /// Number of open braces.
    braces: usize,
    /// Last series of closing brackets without opening brackets.
    strays: Option<Strays>,
    /// Byte offset up to which the text has been searched for line ends.
    reached: usize,
    /// Tokens before which the braces that are never closed seem to end.
    ends: BTreeSet<usize>,
}

impl<'s> Pass<'_, 's> {
    /// Processes a token. Returns `false` if no more tokens have to be read.
    fn token(&mut self, index: usize, token: Token<'s>) -> bool {
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are treated alike")]
        match token.kind {
            Tok::LBrace => {
                if self.in_complete_atom() {
                    self.close_atom(token.place);
                }
                return self.open(BracketKind::Brace, index, token);
            }
            Tok::LParen | Tok::TouchParen => {
                let atom = matches!(self.raw.get(index + 1), Some(Token { kind: Tok::Atom, .. }));
                if atom {
                    self.close_atom(token.place);
                }
                return self.open(if atom { BracketKind::Atom } else { BracketKind::Parenthesis }, index, token);
            }
            Tok::Atom if self.label_inside() => self.push(token),
            Tok::Atom if !self.after_parenthesis() => {
                self.close_atom(token.place);
                if !self.lone_atom(index, token) {
                    return false;
                }
                self.push(token);
            }
            Tok::Use if !self.open.is_empty() => self.inner_use(index, token),
            Tok::Str(_) if self.balanced.uses.last().is_some_and(|file| self.source.span(token.place) == file.span) => {
            }
            Tok::RBrace => self.close_brace(index, token),
            Tok::RParen => self.close_parenthesis(index, token),
            _ => self.push(token),
        }
        true
    }

    fn push(&mut self, token: Token<'s>) {
        self.reach(token.place.start);
        self.reached = self.reached.max(token.place.end);
        self.balanced.regions.push();
        self.balanced.tokens.push(token);
    }

    /// Starts a new line in the regions if the text up to the byte offset `start` contains a line end.
    fn reach(&mut self, start: usize) {
        if self.source.slice(TextRange::new(self.reached, start)).contains('\n') {
            self.balanced.regions.begin_line();
        }
        self.reached = self.reached.max(start);
    }

    fn lexical(&mut self, diagnostic: Diagnostic) {
        self.reach(diagnostic.span().map_or(0, |span| span.within(self.source.id).start));
        self.spoil(diagnostic);
    }

    fn spoil(&mut self, diagnostic: Diagnostic) {
        self.balanced.regions.spoil();
        self.balanced.diagnostics.push(diagnostic);
    }

    /// Returns `true` if the innermost open bracket belongs to an atom that already has its condition and its law.
    fn in_complete_atom(&self) -> bool {
        if self.open.last().is_none_or(|open| open.kind != BracketKind::Atom) {
            return false;
        }
        let (mut depth, mut groups, mut others) = (0_usize, 0, 0);
        for token in self.balanced.tokens.iter().rev().take_while(|token| token.kind != Tok::Atom) {
            #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no brackets")]
            match token.kind {
                Tok::RParen | Tok::RBrace => depth += 1,
                Tok::LParen | Tok::TouchParen | Tok::LBrace => {
                    depth = depth.saturating_sub(1);
                    groups += usize::from(depth == 0);
                }
                _ => others += usize::from(depth == 0),
            }
        }
        groups > 1 || groups == 1 && others > 0
    }

    fn after_parenthesis(&self) -> bool {
        matches!(self.balanced.tokens.last(), Some(Token { kind: Tok::LParen | Tok::TouchParen, .. }))
    }

    fn open(&mut self, kind: BracketKind, raw: usize, token: Token<'s>) -> bool {
        if self.open.len() >= MAX_DEPTH {
            let message = format!("brackets nested more than {MAX_DEPTH} deep");
            let help = "give an inner part a name, as a plan of its own, and use it by that name";
            let span = self.source.span(token.place);
            self.spoil(Diagnostic::new(Code::E0106, message, span, "reading stops here").help(help));
            return false;
        }
        let place = (!token.place.is_empty()).then_some(token.place);
        self.open.push(OpenBracket { kind, place, raw, stray: None });
        match kind {
            BracketKind::Brace => {
                self.braces += 1;
                self.push(token);
                self.balanced.regions.open_brace();
            }
            BracketKind::Parenthesis | BracketKind::Atom => {
                self.balanced.regions.open_parenthesis();
                self.push(token);
            }
        }
        true
    }

    /// Closes the innermost open bracket, and returns it.
    fn close(&mut self, token: Token<'s>) -> Option<OpenBracket> {
        let open = self.open.pop()?;
        self.push(token);
        match open.kind {
            BracketKind::Brace => {
                self.braces -= 1;
                self.balanced.regions.close_brace();
            }
            BracketKind::Parenthesis | BracketKind::Atom => self.balanced.regions.close_parenthesis(),
        }
        Some(open)
    }

    /// Closes the innermost open bracket, although the text contains no closing bracket for it.
    fn force(&mut self) -> Option<OpenBracket> {
        let kind = if self.open.last()?.kind == BracketKind::Brace { Tok::RBrace } else { Tok::RParen };
        self.balanced.regions.spoil();
        let end = self.balanced.tokens.last().map_or(0, |token| token.place.end);
        self.close(Token { kind, place: TextRange::new(end, end) })
    }

    /// Closes all open brackets except the first `depth`, and reports them in one message. The closed brackets must be
    /// parentheses.
    fn force_down_to(&mut self, depth: usize, missing_at: TextRange, before: &str) {
        let mut unclosed = Vec::new();
        let mut atom = false;
        while let Some(open) = (self.open.len() > depth).then(|| self.force()).flatten() {
            atom |= open.kind == BracketKind::Atom;
            unclosed.extend(open.place);
        }
        unclosed.reverse();
        let Some((first, others)) = unclosed.split_first() else { return };
        let message = match others.len() {
            0 => "this `(` is never closed".to_owned(),
            more => format!("{} parentheses are never closed", more + 1),
        };
        let mut diagnostic = Diagnostic::new(Code::E0103, message, self.source.span(*first), "opened here");
        for other in others.iter().take(3) {
            diagnostic = diagnostic.also(self.source.span(*other), "and here");
        }
        let missing = if others.is_empty() { "a `)` is missing" } else { "their `)` are missing" };
        let diagnostic = diagnostic.also(self.source.span(missing_at), format!("{missing} {before}"));
        self.balanced.diagnostics.push(if atom {
            diagnostic.help("an atom has parentheses around its condition and around all of it: `(Atom (bumper) stop)`")
        } else {
            diagnostic
        });
    }

    /// Closes an atom inside which another atom begins.
    fn close_atom(&mut self, at: TextRange) {
        let inside = self.open.iter().rev().take_while(|open| open.kind != BracketKind::Brace);
        if let Some(up) = inside.enumerate().filter(|(_, open)| open.kind == BracketKind::Atom).map(|(up, _)| up).last()
        {
            self.force_down_to(self.open.len() - up - 1, at, "before this");
        }
    }

    /// Inserts the missing parenthesis before an `Atom`; returns `false` if brackets would be nested too deep.
    fn lone_atom(&mut self, index: usize, token: Token<'s>) -> bool {
        let place = TextRange::new(token.place.start, token.place.start);
        if !self.open(BracketKind::Atom, index, Token { kind: Tok::LParen, place }) {
            return false;
        }
        let span = self.source.span(token.place);
        let diagnostic =
            Diagnostic::new(Code::E0103, "this atom does not begin with `(`", span, "a `(` is missing before this");
        self.spoil(diagnostic.help("an atom is written in parentheses: `(Atom (bumper) stop)`"));
        true
    }

    /// Returns `true` if a closing bracket continues a series of closing brackets without opening brackets. The series'
    /// message then also covers this bracket.
    fn is_one_more(&mut self, index: usize, token: Token<'s>) -> bool {
        let is_alike = |last: usize| self.raw.get(last).is_some_and(|last| last.kind == token.kind);
        let strays = self.strays.as_mut().filter(|strays| strays.last + 1 == index && is_alike(strays.last));
        let Some(strays) = strays else {
            self.strays = Some(Strays { message: self.balanced.diagnostics.len(), last: index, count: 1 });
            return false;
        };
        self.balanced.regions.spoil();
        (strays.last, strays.count) = (index, strays.count + 1);
        let bracket = if token.kind == Tok::RBrace { '}' } else { ')' };
        if let Some(first) = self.balanced.diagnostics.get_mut(strays.message) {
            first.message = format!("these {} `{bracket}` close nothing", strays.count);
            first.help.clear();
            first.labels.iter_mut().take(1).for_each(|label| label.span = label.span.to(self.source.span(token.place)));
        }
        true
    }

    fn close_brace(&mut self, index: usize, token: Token<'s>) {
        if self.braces == 0 {
            if self.is_one_more(index, token) {
                return;
            }
            let span = self.source.span(token.place);
            let diagnostic = Diagnostic::new(Code::E0103, "this `}` closes nothing", span, "no `{` is open here");
            self.spoil(diagnostic.help("remove it, or open a plan: `{ Name (Atom (bumper) stop) }`"));
            return;
        }
        let above = self.open.iter().rev().take_while(|open| open.kind != BracketKind::Brace).count();
        self.force_down_to(self.open.len() - above, token.place, "before this");
        self.close(token);
    }

    fn close_parenthesis(&mut self, index: usize, token: Token<'s>) {
        let brace = match self.open.last() {
            Some(open) if open.kind != BracketKind::Brace => {
                self.close(token);
                return;
            }
            other => other.and_then(|open| open.place),
        };
        if self.is_one_more(index, token) {
            return;
        }
        let span = self.source.span(token.place);
        let mut diagnostic = Diagnostic::new(Code::E0103, "this `)` closes nothing", span, "no `(` is open here");
        if let Some(brace) = brace {
            diagnostic = diagnostic.also(self.source.span(brace), "the innermost open bracket is this `{`");
        }
        let message = self.balanced.diagnostics.len();
        self.spoil(diagnostic);
        if let Some(open) = self.open.last_mut() {
            open.stray.get_or_insert(message);
        }
    }
}
