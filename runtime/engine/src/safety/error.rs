//! Error in a safety file.

use std::fmt;

/// Reason why a text is not a valid safety file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RulesError {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// Sentence that says what to write instead.
    pub message: String,
}

impl fmt::Display for RulesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.line, self.message)
    }
}

impl std::error::Error for RulesError {}
