//! Outcome of a run in a batch of several runs.

use mdle_runtime::Nanos;

use crate::report::Over;

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum RunOutcome {
    /// The plan has ended, and the run has no goal.
    Ended,
    /// The plan has ended, and the robot is in its goal.
    Arrived,
    /// The plan has ended, and the robot touches an obstacle.
    Bumped,
    /// The plan has ended, and the robot is outside its goal; the text says where the robot is.
    Astray(String),
    /// The plan has ended, but not by one of the required causes.
    Otherwise,
    /// The run has reached its time limit before the plan ended.
    TimedOut,
    /// The run could not begin, or a fault stopped it; contains the reason.
    Failed(String),
}

/// A finished run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EndedRun {
    pub(crate) seed: u64,
    pub(crate) outcome: RunOutcome,
    /// Time of the plan at the end of the run.
    pub(crate) t: Nanos,
    /// Cause of the plan's end; `None` if the plan has not ended.
    pub(crate) over: Option<Over>,
    pub(crate) contacts: u64,
}
