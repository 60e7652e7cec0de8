//! Determines the ends of tokens that a regular expression cannot describe: numbers with units, strings and comments.

use logos::{FilterResult, Lexer, Logos};

use crate::alphabet::Unit;

/// Reads a number and the text that touches it. Fails if this text is not a unit.
pub(super) fn number<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> Result<&'s str, ()> {
    let rest = lexer.remainder();
    let tail = match rest.as_bytes() {
        // Most numbers have no unit.
        [] | [b')' | b',' | b'\n', ..] => return Ok(lexer.slice()),
        [b' ' | b'\t', ..] => unit_apart(rest),
        _ => touching(rest),
    };
    let is_sound = tail == 0 || rest.get(..tail).is_some_and(Unit::is_name);
    lexer.bump(tail);
    if is_sound { Ok(lexer.slice()) } else { Err(()) }
}

/// Returns the length in bytes of the text that follows a number without a space.
fn touching(rest: &str) -> usize {
    let mut chars = rest.chars();
    while let Some(c) = chars.next() {
        let next = || chars.clone().next().unwrap_or(' ');
        let belongs = match c {
            '/' => next().is_alphabetic(),
            '+' | '-' => next().is_ascii_digit(),
            _ => c.is_alphanumeric() || matches!(c, '_' | '.' | '°'),
        };
        if !belongs {
            return rest.len() - chars.as_str().len() - c.len_utf8();
        }
    }
    rest.len()
}

/// Returns the length in bytes of the spaces and the unit after a number, if the unit contains `/`. Such a unit may
/// follow after spaces, because only units contain `/`.
fn unit_apart(rest: &str) -> usize {
    let blanks = rest.bytes().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
    let behind = rest.get(blanks..).unwrap_or("");
    let letters = behind.bytes().take_while(u8::is_ascii_alphabetic).count();
    if behind.as_bytes().get(letters) != Some(&b'/') {
        return 0;
    }
    let follows = |unit: &Unit| {
        let next = behind.strip_prefix(unit.name).map(|after| after.chars().next());
        unit.name.contains('/') && next.is_some_and(|next| !next.is_some_and(|c| c.is_alphanumeric() || c == '_'))
    };
    Unit::ALL.iter().find(|unit| follows(unit)).map_or(0, |unit| blanks + unit.name.len())
}

/// Returns the text in the quotes; if the string does not end on its line, it ends where a file name could end.
pub(super) fn string<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> &'s str {
    let rest = lexer.remainder();
    let stop = rest.find(['"', '\n']).unwrap_or(rest.len());
    let (line, behind) = rest.split_at_checked(stop).unwrap_or((rest, ""));
    let closed = behind.starts_with('"');
    let ends = |c: char| c.is_whitespace() || "(){}[],;".contains(c);
    let text = if closed { line } else { line.split(ends).next().unwrap_or("") };
    lexer.bump(text.len() + usize::from(closed));
    text
}

/// Returns the text after the slashes of a doc comment; four slashes do not begin a doc comment.
pub(super) fn doc<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> FilterResult<&'s str, ()> {
    match lexer.slice().strip_prefix("///") {
        Some(text) if !text.starts_with('/') => FilterResult::Emit(text.trim_end()),
        Some(_) | None => FilterResult::Skip,
    }
}

/// Skips a block comment. A comment that is never closed extends to the end of the text.
pub(super) fn comment<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> FilterResult<(), ()> {
    let rest = lexer.remainder();
    match rest.find("*/") {
        Some(end) => {
            lexer.bump(end + 2);
            FilterResult::Skip
        }
        None => {
            lexer.bump(rest.len());
            FilterResult::Emit(())
        }
    }
}
