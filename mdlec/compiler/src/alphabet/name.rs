//! Names in plans and in alphabets (docs/src/reference/language.md, 2).
//!
//! The lexers recognize ASCII letters and digits only. With the letters of all scripts as states, the three lexers
//! would take a third of the time in which this package compiles.

use logos::{Lexer, Logos};
use unicode_properties::{GeneralCategory, GeneralCategoryGroup, UnicodeGeneralCategory};

/// Reads the rest of a name, of which the lexer has read the first character or the first ASCII letters and digits.
///
/// # Errors
///
/// Fails if no name begins with the first character.
pub(crate) fn name<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> Result<&'s str, ()> {
    if lexer.slice().starts_with(begins_name) { word(lexer) } else { Err(()) }
}

/// Reads the rest of a word, which may also begin with a digit or a combining mark.
///
/// # Errors
///
/// Fails if the first character does not belong to a word.
pub(crate) fn word<'s, T: Logos<'s, Source = str>>(lexer: &mut Lexer<'s, T>) -> Result<&'s str, ()> {
    let rest = lexer.remainder();
    if !lexer.slice().starts_with(continues_name) {
        return Err(());
    }
    lexer.bump(rest.len() - rest.trim_start_matches(continues_name).len());
    Ok(lexer.slice())
}

fn begins_name(c: char) -> bool {
    if c.is_ascii() { c.is_ascii_alphabetic() || c == '_' } else { is_letter(c) }
}

fn continues_name(c: char) -> bool {
    if c.is_ascii() {
        return c.is_ascii_alphanumeric() || c == '_';
    }
    is_letter(c)
        || c.general_category_group() == GeneralCategoryGroup::Mark
        || c.general_category() == GeneralCategory::DecimalNumber
}

fn is_letter(c: char) -> bool {
    c.general_category_group() == GeneralCategoryGroup::Letter
}

#[cfg(test)]
mod tests {
    use super::{begins_name, continues_name};

    #[test]
    fn names_consist_of_letters_of_any_script_marks_and_decimal_digits() {
        for letter in "aZ_éßσΓЖمह中あ한ªʰ𝒜".chars() {
            assert!(begins_name(letter) && continues_name(letter), "{letter}");
        }
        for inside in ['0', '٣', '९', '\u{301}', '\u{93f}', '\u{20dd}'] {
            assert!(!begins_name(inside) && continues_name(inside), "{inside}");
        }
        for other in " -≤∞°²½Ⅳ→·“\u{a0}\u{feff}\u{2028}😀".chars() {
            assert!(!begins_name(other) && !continues_name(other), "{other}");
        }
    }
}
