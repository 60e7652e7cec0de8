//! Displays untrusted text safely, so that none of its characters can move the cursor, colour the terminal or reverse
//! the direction of text.

use core::fmt::{self, Write};

/// A text that is displayed on one line. Each character that [is not printable](is_printable) is replaced by its code
/// point, as in `U+001B`.
///
/// Widths and precisions of format strings have no effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Printable<T>(pub T);

/// A text of several lines that is displayed like a [`Printable`], except that line breaks and tabs remain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PrintableLines<T>(pub T);

impl<T: fmt::Display> fmt::Display for Printable<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(Replacing { to: f, is_kept: is_printable }, "{}", self.0)
    }
}

impl<T: fmt::Display> fmt::Display for PrintableLines<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_kept = |letter| matches!(letter, '\n' | '\t') || is_printable(letter);
        write!(Replacing { to: f, is_kept }, "{}", self.0)
    }
}

/// Returns `true` if a character is visible by itself, or modifies the character next to it, as an accent does.
///
/// These characters are not printable: control characters (`Cc`), separators of lines and paragraphs (`Zl`, `Zp`),
/// characters that reverse text, join it, or are invisible (`Cf`, except the signs of Arabic, Syriac and Kaithi that
/// enclose numbers, and the layout of hieroglyphs), and the two characters `U+FFFE` and `U+FFFF`, which XML does not
/// allow.
#[must_use]
pub const fn is_printable(letter: char) -> bool {
    !matches!(
        letter,
        '\0'..='\u{1F}'
            | '\u{7F}'..='\u{9F}'
            | '\u{AD}'
            | '\u{61C}'
            | '\u{180E}'
            | '\u{200B}'..='\u{200F}'
            | '\u{2028}'..='\u{202E}'
            | '\u{2060}'..='\u{206F}'
            | '\u{FEFF}'
            | '\u{FFF9}'..='\u{FFFB}'
            | '\u{FFFE}'..='\u{FFFF}'
            | '\u{1BCA0}'..='\u{1BCA3}'
            | '\u{1D173}'..='\u{1D17A}'
            | '\u{E0000}'..='\u{E007F}'
    )
}

/// A writer that replaces each character for which `is_kept` returns `false` by the character's code point.
struct Replacing<'a, 'f, K> {
    to: &'a mut fmt::Formatter<'f>,
    is_kept: K,
}

impl<K: Fn(char) -> bool> Write for Replacing<'_, '_, K> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for piece in text.split_inclusive(|letter| !(self.is_kept)(letter)) {
            let mut letters = piece.chars();
            match letters.next_back() {
                Some(last) if !(self.is_kept)(last) => {
                    self.to.write_str(letters.as_str())?;
                    write!(self.to, "U+{:04X}", u32::from(last))?;
                }
                Some(_) | None => self.to.write_str(piece)?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    #[test]
    fn what_has_no_form_is_shown_as_its_number() {
        let shown = |text: &str| (Printable(text).to_string(), PrintableLines(text).to_string());
        let both = |text: &str, expected: &str| assert_eq!(shown(text), (expected.into(), expected.into()), "{text:?}");
        both("größe ∞ \u{301}é العربية 日本 👍", "größe ∞ \u{301}é العربية 日本 👍");
        both("\u{1b}[31m red\u{7}", "U+001B[31m redU+0007");
        both("a\rb\u{7f}\u{9b}\0", "aU+000DbU+007FU+009BU+0000");
        both("\u{202e}txt.exe\u{2069}\u{200f}", "U+202Etxt.exeU+2069U+200F");
        both("a\u{2028}b\u{feff}\u{200d}\u{e0041}", "aU+2028bU+FEFFU+200DU+E0041");
        both("\u{fffe}\u{ffff}", "U+FFFEU+FFFF");
        both("", "");
        assert_eq!(shown("a\n\tb"), ("aU+000AU+0009b".into(), "a\n\tb".into()));
    }

    #[test]
    fn no_control_character_is_printable() {
        let all = (0..=u32::from(char::MAX)).filter_map(char::from_u32);
        assert!(all.filter(|letter| letter.is_control()).all(|letter| !is_printable(letter)));
        assert!(('!'..='~').all(is_printable) && is_printable(' '));
    }

    #[test]
    fn what_is_shown_is_printable() {
        let all: std::string::String = (0..=u32::from(char::MAX)).filter_map(char::from_u32).collect();
        assert!(Printable(&all).to_string().chars().all(is_printable));
        assert_eq!(Printable(Printable(&all)).to_string(), Printable(&all).to_string());
    }
}
