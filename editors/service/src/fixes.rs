//! Quick fixes: the edits that the help of diagnostics proposes.

use std::ops::Range;

use mdle_compiler::diagnostic::{Diagnostic, Sources};

use crate::diagnostics::{Place, place};

/// An edit that removes a defect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fix {
    /// The help, as the title of the fix.
    pub title: String,
    /// Index of the diagnostic among those given.
    pub diagnostic: usize,
    /// Place of the text to replace.
    pub place: Place,
    /// Text to insert.
    pub replacement: String,
}

/// Lists the fixes of the diagnostics that touch `range` of the file that `own` accepts.
#[must_use]
pub fn fixes(
    sources: &Sources,
    diagnostics: &[Diagnostic],
    own: impl Fn(&Place) -> bool,
    range: &Range<usize>,
) -> Vec<Fix> {
    let touches = |place: &Place| own(place) && place.range.start <= range.end && range.start <= place.range.end;
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
