//! Reasons why a target does not begin a run.

use std::fmt;

/// Reason why the program could not connect to a robot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// An option, a world or a start pose is invalid.
    Usage(String),
    /// The robot does not answer, or reports that it is not ready to drive.
    Fault(String),
    /// The run was asked to end while the program connected to the robot. Contains the result of stopping the robot; if
    /// the stop failed, the sentence gives the reason (exit status 3).
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
