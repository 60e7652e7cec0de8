//! The tokens of a text in their printed form, each with the comments that precede it.

use std::borrow::Cow;

use super::super::header;
use super::super::label::label;
use super::super::lexer::{Lexed, lex};
use super::super::printed;
use super::super::source::{FileText, TextRange};
use super::super::token::{Tok, Token};
use super::comments::{Gap, gap};

/// A token in its printed form.
#[derive(Debug)]
pub(super) struct Piece<'s> {
    /// Text of the token in the canonical spelling.
    pub(super) text: Cow<'s, str>,
    /// `true` if no space precedes the piece.
    pub(super) is_glued: bool,
    kind: Tok<'s>,
    /// Byte offset of the token in the source.
    start: usize,
    /// Comments and line ends before the piece.
    gap: Gap<'s>,
    /// `true` if a line that would be too long may be broken before the piece.
    may_break: bool,
    /// Number of columns that all previous pieces would need on one line.
    left: usize,
    /// Number of comments in the whole text before the piece.
    comments: usize,
}

/// Pieces that must stay on one line.
pub(super) struct Chunk {
    /// `true` if a line may be broken before the chunk.
    pub(super) may_break: bool,
    /// Number of columns that the chunk needs.
    pub(super) width: usize,
}

/// All pieces of a text; the last piece is empty and marks the end.
pub(super) struct Pieces<'s>(Vec<Piece<'s>>);

impl<'s> Pieces<'s> {
    /// Returns the pieces of a text without errors.
    pub(super) fn of(source: FileText<'s>) -> Self {
        let mut lexed = lex(source);
        printed::read(&mut lexed);
        let Lexed { mut tokens, .. } = lexed;
        header::mark(&mut tokens);
        let end = source.text.len();
        tokens.push(Token { kind: Tok::Comment, place: TextRange::new(end, end) });
        let mut pieces: Vec<Piece<'s>> = Vec::with_capacity(tokens.len());
        let (mut behind, mut left, mut comments) = (0, 0, 0);
        for token in tokens {
            let Token { kind, place } = token;
            let gap = gap(source.slice(TextRange::new(behind, place.start)));
            let is_glued = pieces.last().is_none_or(|before| touch(before.kind, kind));
            let text = text(source, token);
            left += usize::from(!is_glued);
            comments += gap.comments.len();
            let may_break = matches!(kind, Tok::Or | Tok::And | Tok::ConditionParen)
                || pieces.last().is_some_and(|before| before.kind == Tok::Comma);
            let width = text.chars().count();
            pieces.push(Piece { text, is_glued, kind, start: place.start, gap, may_break, left, comments });
            left += width;
            behind = place.end;
        }
        Self(pieces)
    }

    pub(super) fn get(&self, at: usize) -> &Piece<'s> {
        let last = self.0.len() - 1;
        &self.0[at.min(last)]
    }

    /// Returns the kind of a piece's token; `None` at the end.
    pub(super) fn kind(&self, at: usize) -> Option<Tok<'s>> {
        (at + 1 < self.0.len()).then(|| self.get(at).kind)
    }

    /// Returns the index of the first piece at or after the byte offset `byte`.
    pub(super) fn at_byte(&self, byte: usize) -> usize {
        self.0.partition_point(|piece| piece.start < byte)
    }

    /// Removes and returns the comments and line ends before a piece.
    pub(super) fn take_gap(&mut self, at: usize) -> Gap<'s> {
        self.0.get_mut(at).map(|piece| std::mem::take(&mut piece.gap)).unwrap_or_default()
    }

    pub(super) fn may_break_before(&mut self, at: usize) {
        if let Some(piece) = self.0.get_mut(at) {
            piece.may_break = true;
        }
    }

    /// Returns the number of columns that the pieces `first..end` need on one line.
    pub(super) fn width(&self, first: usize, end: usize) -> usize {
        let last = self.get(end.saturating_sub(1));
        last.left + last.text.chars().count() - self.get(first).left
    }

    /// Returns `true` if a comment precedes any of the pieces `first..end`.
    pub(super) fn have_comments(&self, first: usize, end: usize) -> bool {
        self.get(end.saturating_sub(1)).comments > self.get(first.saturating_sub(1)).comments
    }

    /// Returns the pieces from `first` to the next place at which the line may be broken, but at most up to `end`.
    pub(super) fn chunk(&self, first: usize, end: usize) -> Chunk {
        if !self.get(first).may_break {
            return Chunk { may_break: false, width: 0 };
        }
        // AND binds more tightly than OR, so a line breaks before OR and not before AND.
        let is_and = |at: usize| self.get(at).kind == Tok::And;
        let next =
            (first + 1..end).find(|at| self.get(*at).may_break && (is_and(first) || !is_and(*at))).unwrap_or(end);
        Chunk { may_break: true, width: self.width(first, next) }
    }
}

/// Returns the printed form of a token. Words and numbers are printed as written, but without typesetting.
fn text<'s>(source: FileText<'s>, token: Token<'s>) -> Cow<'s, str> {
    let written = source.slice(token.place);
    #[allow(clippy::wildcard_enum_match_arm, reason = "all others are written as they are")]
    Cow::Borrowed(match token.kind {
        Tok::Or => "OR",
        Tok::And => "AND",
        Tok::Not => "NOT",
        Tok::Rising => "RISING",
        Tok::SigmaNull => "sigma_null",
        Tok::Infinity => "inf",
        Tok::LBrace => "{",
        Tok::RBrace => "}",
        Tok::LessOrEqual => "<=",
        Tok::GreaterOrEqual => ">=",
        Tok::Label(written) => return plain_label(written),
        _ => written,
    })
}

/// Returns a label without typesetting; if the result would not be a label, returns the label as written.
fn plain_label(written: &str) -> Cow<'_, str> {
    let plain = label(written);
    let is_label = |text: &str| {
        let parts = text.strip_prefix("Γ_").map(|parts| parts.split('^'));
        parts.is_some_and(|mut parts| parts.all(|part| !part.is_empty()))
    };
    if is_label(&plain) { plain } else { Cow::Borrowed(written) }
}

/// Returns `true` if two tokens are printed without a space between them.
fn touch(before: Tok<'_>, token: Tok<'_>) -> bool {
    let opens = matches!(
        before,
        Tok::LParen | Tok::TouchParen | Tok::ParamParen | Tok::ConditionParen | Tok::LBracket | Tok::Caret
    );
    let closes = matches!(
        token,
        Tok::RParen | Tok::TouchParen | Tok::ParamParen | Tok::LBracket | Tok::RBracket | Tok::Comma | Tok::Colon
    );
    (opens || closes || token == Tok::Caret) && before != Tok::Group
}
