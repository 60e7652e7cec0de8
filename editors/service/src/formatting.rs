//! Formats a document, or the plans that a range touches, in the layout of `mdlec fmt`.

use std::ops::Range;

use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::syntax::{Arena, format, parse};

use crate::view::View;

/// An edit of the document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextEdit {
    /// Byte range to replace.
    pub range: Range<usize>,
    /// Text to insert.
    pub text: String,
}

/// Formats a document. Returns the edit between the first and the last difference; `None` if the document has errors.
#[must_use]
pub fn document(text: &str) -> Option<Vec<TextEdit>> {
    let formatted = format(SourceId(0), text).ok()?;
    Some(difference(text, &formatted, 0))
}

/// Formats the plans that a range touches, even if other plans have errors. Returns `None` if one of the formatted
/// plans has errors.
#[must_use]
pub fn range(view: &View<'_>, range: &Range<usize>) -> Option<Vec<TextEdit>> {
    let plans: Vec<_> = view.file.plans.iter().filter_map(|plan| view.range(plan.span)).collect();
    let mut touched = plans.iter().filter(|plan| plan.start <= range.end && range.start <= plan.end);
    let Some(first) = touched.next() else { return Some(Vec::new()) };
    let whole = first.start..touched.next_back().unwrap_or(first).end;
    let text = view.text.get(whole.clone())?;
    if !parse(SourceId(0), text, &Arena::new()).1.is_empty() {
        return None;
    }
    let formatted = format(SourceId(0), text).ok()?;
    Some(difference(text, formatted.trim_end(), whole.start))
}

/// Returns the edit that changes `old` to `new`; an empty list if they are equal. `old` begins at the byte `start` of
/// the document.
fn difference(old: &str, new: &str, start: usize) -> Vec<TextEdit> {
    let same = |pair: &(char, char)| pair.0 == pair.1;
    let prefix: usize = old.chars().zip(new.chars()).take_while(same).map(|(letter, _)| letter.len_utf8()).sum();
    let (old_rest, new_rest) = (old.get(prefix..).unwrap_or(""), new.get(prefix..).unwrap_or(""));
    let suffix = old_rest.chars().rev().zip(new_rest.chars().rev()).take_while(same);
    let suffix: usize = suffix.map(|(letter, _)| letter.len_utf8()).sum();
    let inserted = new_rest.get(..new_rest.len() - suffix).unwrap_or("");
    let range = start + prefix..start + old.len() - suffix;
    if range.is_empty() && inserted.is_empty() {
        Vec::new()
    } else {
        vec![TextEdit { range, text: inserted.to_owned() }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_difference_turns_one_text_into_the_other() {
        for (old, new) in
            [("", ""), ("a", ""), ("", "b"), ("abab", "ab"), ("größe", "grüße"), ("aaa", "aaaa"), ("x𝒜y", "x𝒞y")]
        {
            let mut text = old.to_owned();
            for TextEdit { range, text: inserted } in difference(old, new, 0) {
                text.replace_range(range, &inserted);
            }
            assert_eq!(text, new);
        }
    }
}
