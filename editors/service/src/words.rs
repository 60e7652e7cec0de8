//! Splits an unfinished text into words for completion, because its syntax tree is incomplete.

use std::ops::Range;

/// Kind of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WordKind {
    /// A name or a keyword.
    Name,
    /// Digits, and the unit that directly follows them.
    Number,
    /// A comment or a text in quotes.
    Opaque,
    /// A bracket or an operator.
    Sign,
}

/// A word, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Word<'t> {
    pub(crate) kind: WordKind,
    pub(crate) text: &'t str,
    pub(crate) range: Range<usize>,
}

/// Returns the words of `text`.
pub(crate) fn words(text: &str) -> impl Iterator<Item = Word<'_>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = text.get(at..)?;
        at += rest.len() - rest.trim_start().len();
        let rest = text.get(at..).filter(|rest| !rest.is_empty())?;
        let (kind, length) = next(rest);
        let start = at;
        at += length;
        Some(Word { kind, text: text.get(start..at)?, range: start..at })
    })
}

/// Returns the kind and the length, in bytes, of the first word of a text.
fn next(text: &str) -> (WordKind, usize) {
    let while_in = |is_in: fn(char) -> bool| text.find(|letter| !is_in(letter)).unwrap_or(text.len());
    let first = text.chars().next().unwrap_or(' ');
    let is_digit = |at: usize| text.as_bytes().get(at).is_some_and(u8::is_ascii_digit);
    if text.starts_with("//") {
        (WordKind::Opaque, text.find('\n').unwrap_or(text.len()))
    } else if text.starts_with("/*") {
        (WordKind::Opaque, text.find("*/").map_or(text.len(), |end| end + 2))
    } else if first == '"' {
        let end = text.get(1..).and_then(|rest| rest.find(['"', '\n']));
        (WordKind::Opaque, end.map_or(text.len(), |end| end + 2).min(text.len()))
    } else if is_digit(0) || (matches!(first, '+' | '-') && is_digit(1)) {
        let rest = text.get(1..).unwrap_or("");
        let is_inside = |letter: char| letter.is_alphanumeric() || matches!(letter, '.' | '/' | '_');
        (WordKind::Number, 1 + rest.find(|letter| !is_inside(letter)).unwrap_or(rest.len()))
    } else if first.is_alphabetic() || first == '_' {
        (WordKind::Name, while_in(|letter| letter.is_alphanumeric() || letter == '_'))
    } else {
        (WordKind::Sign, first.len_utf8())
    }
}
