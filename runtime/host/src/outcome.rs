//! The outcome of one run among several.

use mdle_runtime::Nanos;

use crate::report::Over;

/// Outcome of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// The plan is over, and there was no goal.
    Ended,
    /// The plan is over, and the robot is in its goal.
    Arrived,
    /// The plan is over, and the robot touches an obstacle.
    Bumped,
    /// The plan is over, and the robot is outside its goal: where.
    Astray(String),
    /// The plan is over by another cause than those required.
    Otherwise,
    /// The plan was given up.
    TimedOut,
    /// The run could not begin, or a fault stopped it: the reason.
    Failed(String),
}

/// A run that has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct EndedRun {
    pub(crate) seed: u64,
    pub(crate) outcome: Outcome,
    /// The plan's time at which it ended.
    pub(crate) t: Nanos,
    /// End of the plan; `None` if it was not over.
    pub(crate) over: Option<Over>,
    pub(crate) contacts: u64,
}
