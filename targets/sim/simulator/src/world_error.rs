//! The error in a world file.

use std::fmt;

/// An error in a world file, displayed as `file:line:column: sentence`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldError {
    file: String,
    /// Line and column, counted from 1; `None` if the error concerns the whole file.
    place: Option<(usize, usize)>,
    what: String,
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file)?;
        if let Some((line, column)) = self.place {
            write!(f, "{line}:{column}:")?;
        }
        write!(f, " {}", self.what)
    }
}

impl std::error::Error for WorldError {}

impl WorldError {
    /// Creates an error at a line and column, counted from 1. With `None`, the error concerns the whole file.
    pub(crate) fn new(file: &str, place: Option<(usize, usize)>, what: impl Into<String>) -> Self {
        Self { file: file.to_owned(), place, what: what.into() }
    }
}
