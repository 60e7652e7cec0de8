//! Reasons why a target does not begin a run.

/// Reason why a robot could not be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// An option, a world or a start pose is no good.
    Usage(String),
    /// The robot does not answer, or answers that it cannot run.
    Fault(String),
    /// The run was asked to end while the robot was opened. The robot was stopped; if not, a sentence with the reason
    /// (exit status 3).
    Ended(Result<(), String>),
}
