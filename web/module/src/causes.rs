//! Converts the causes of transitions to text, in the words of the plan.

use mdle_quantity::cause_text;
use mdle_runtime::{Measured, Plan, Printable, Transition};

use crate::course::Seen;

/// Returns the cause of a transition with the measured values, in the form in which `mdle run` reports it: `r1 = 0.38 m
/// < 40cm (plan.mdle:7)`.
pub(crate) fn cause(plan: &impl Plan, transition: &Transition, operands: &[(u32, Measured)]) -> String {
    let text = cause_text(plan.source(), transition, operands);
    Printable(text.unwrap_or_else(|| transition.by(plan).to_owned())).to_string()
}

/// Returns the cause of the last transition.
pub(crate) fn last(plan: &impl Plan, seen: &Seen) -> String {
    seen.transitions.last().map_or_else(String::new, |(transition, operands)| cause(plan, transition, operands))
}
