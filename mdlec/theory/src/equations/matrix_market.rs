//! Writes the transition matrices of a plan as MatrixMarket coordinate files, one file for each interrupt, and a list
//! of the files.

use std::fmt::Write;

use serde::Serialize;

use super::terms::{Extent, Term, Terms};

/// Version of the list's format.
const VERSION: u32 = 1;
/// Maximum total number of ones in all files. Each of them takes a line.
const ONES: usize = 10_000_000;
/// Maximum length of a comment, in characters: a line of a MatrixMarket file may have at most 1024 bytes.
const COMMENT: usize = 200;

/// Files of a plan's matrices.
#[derive(Debug, Clone, Copy)]
pub struct MatrixFiles<'t, 'p>(&'t Terms<'p>);

/// Returns the files of the terms' matrices.
///
/// # Errors
/// Returns the total number of ones in all files and its maximum of ten million if the maximum is exceeded.
pub fn matrix_files<'t, 'p>(terms: &'t Terms<'p>) -> Result<MatrixFiles<'t, 'p>, (usize, usize)> {
    let ones = terms.states().saturating_mul(terms.live.len());
    if ones > ONES { Err((ones, ONES)) } else { Ok(MatrixFiles(terms)) }
}

/// List of the matrices.
#[derive(Debug, Serialize)]
struct MatrixList<'t> {
    version: u32,
    source: &'t str,
    combined: bool,
    states: Vec<String>,
    laws: &'t [&'t str],
    matrices: Vec<MatrixEntry<'t>>,
    never: Vec<MatrixEntry<'t>>,
}

#[derive(Debug, Serialize)]
struct MatrixEntry<'t> {
    name: &'t str,
    text: &'t str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    places: Vec<ScopeStates<'t>>,
}

/// Range of the states of a scope, which are counted from 1.
#[derive(Debug, Serialize)]
struct ScopeStates<'t> {
    number: usize,
    scope: &'t str,
    first: usize,
    last: usize,
}

impl MatrixFiles<'_, '_> {
    /// Name of the list among the files.
    pub const LIST: &'static str = "matrices.json";

    /// Returns the name and the text of each file; the iterator creates a text when it reaches the file.
    pub fn files(&self) -> impl Iterator<Item = (String, String)> {
        self.0.live.iter().map(|term| (file_name(term), self.file(term)))
    }

    /// Returns the text of the list. It contains the states, the laws, and each matrix with its interrupt, its file and
    /// the states of its scopes.
    #[must_use]
    pub fn list(&self) -> String {
        let states = (1..self.0.states()).map(|atom| format!("a{atom}")).chain(["end".to_owned()]);
        let list = MatrixList {
            version: VERSION,
            source: self.0.source,
            combined: self.0.combined,
            states: states.collect(),
            laws: &self.0.laws,
            matrices: self.0.live.iter().map(|term| entry(term, Some(file_name(term)))).collect(),
            never: self.0.never.iter().map(|term| entry(term, None)).collect(),
        };
        // Serialization fails only for maps with keys that are not strings, and the list contains no such map.
        serde_json::to_string_pretty(&list).map(|text| text + "\n").unwrap_or_default()
    }

    fn file(&self, term: &Term<'_>) -> String {
        let (matrix, states) = (self.0.matrix(term), self.0.states());
        let mut text = String::from("%%MatrixMarket matrix coordinate integer general\n");
        // Writing to a string cannot fail.
        let _ = writeln!(text, "% {}", comment(&format!("{} = {}", term.name, term.text)));
        let _ = writeln!(text, "{states} {states} {states}");
        for (row, column) in matrix.iter().zip(1..) {
            let _ = writeln!(text, "{} {column} 1", row + 1);
        }
        text
    }
}

fn file_name(term: &Term<'_>) -> String {
    format!("{}.mtx", term.name)
}

fn entry<'t>(term: &'t Term<'_>, file: Option<String>) -> MatrixEntry<'t> {
    let listed = |place: &Extent<'t>| {
        let Extent { number, scope, first, last, row: _ } = *place;
        ScopeStates { number, scope, first: first + 1, last: last + 1 }
    };
    MatrixEntry { name: &term.name, text: term.text, file, places: term.places.iter().map(listed).collect() }
}

/// Returns a text on one line, shortened to the maximum length of a comment.
fn comment(text: &str) -> String {
    let mut line: String =
        text.chars().take(COMMENT).map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    if text.chars().nth(COMMENT).is_some() {
        line.push('…');
    }
    line
}
