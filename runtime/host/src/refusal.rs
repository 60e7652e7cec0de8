//! Reasons why a target does not begin a run.

use std::fmt;

/// Reason why a robot could not be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// An option, a world or a start pose is invalid.
    Usage(String),
    /// The robot does not answer, or reports that it cannot be driven.
    Fault(String),
    /// The run was asked to end while the robot was being opened. The robot was stopped; if not, the sentence gives the
    /// reason (exit status 3).
    Ended(Result<(), String>),
}

/// Writes the message about the refusal.
impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Usage(sentence) | Self::Fault(sentence) | Self::Ended(Err(sentence)) => sentence,
            Self::Ended(Ok(())) => "the run was asked to end before it began",
        })
    }
}
