//! The safety rules of a run. They apply to every input before it is sent to the robot, regardless of the plan
//! (docs/src/safety.md).
//!
//! [`read()`] reads the rules from a file, [`Conditions`] compiles the conditions of the guards for a robot, and an
//! [`Envelope`] uses both to decide which input is sent to the robot.

mod conditions;
mod envelope;
mod error;
mod fence;
mod guardian;
mod plane;
mod read;
mod rule_id;
mod rules;
mod section;
mod start;
#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests;

pub use conditions::{Conditions, GuardError, WatchedConditions};
pub use envelope::Envelope;
pub use error::RulesError;
pub use fence::Fence;
pub use guardian::Guardian;
pub use read::read;
pub use rule_id::RuleId;
pub use rules::{ConditionText, Guard, Limits, Measure, PlanEntry, Rules, Then};
