//! Quick fixes: the edits that the help of diagnostics proposes.

use std::ops::Range;

use mdle_compiler::diagnostic::{Diagnostic, Sources};

use crate::diagnostics::{FileRange, place};

/// An edit that fixes the cause of a diagnostic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fix {
    /// Title of the fix: the help of the diagnostic.
    pub title: String,
    /// Index of the diagnostic in the list of all diagnostics.
    pub diagnostic: usize,
    /// Place of the text to replace.
    pub place: FileRange,
    /// Text to insert.
    pub replacement: String,
}

/// Returns the fixes for the diagnostics that touch `range` in a file. `own` returns `true` for places in this file.
#[must_use]
pub fn fixes(
    sources: &Sources,
    diagnostics: &[Diagnostic],
    own: impl Fn(&FileRange) -> bool,
    range: &Range<usize>,
) -> Vec<Fix> {
    let touches = |place: &FileRange| own(place) && place.range.start <= range.end && range.start <= place.range.end;
    let concerned = diagnostics
        .iter()
        .enumerate()
        .filter(|(_, found)| found.span().is_some_and(|span| touches(&place(sources, span))));
    concerned
        .flat_map(|(index, found)| {
            found.help.iter().filter_map(move |help| {
                let edit = help.edit.as_ref()?;
                let (title, replacement) = (help.text.clone(), edit.replacement.clone());
                Some(Fix { title, diagnostic: index, place: place(sources, edit.span), replacement })
            })
        })
        .collect()
}
