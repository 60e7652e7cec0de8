//! Formats transitions and the positions of atoms for reports. A transition is shown by the operands that fired, as
//! written in the plan, with their values and lines.

use std::fmt;

use mdle_quantity::{cause_text, file_line};
use mdle_runtime::fsm::Kind;
use mdle_runtime::{Plan, Transition};

use crate::passes::{Passes, outwards};
use crate::position::Texts;
use crate::transitions::Operand;

/// Cause of the end of a scope, as text for a report: `r1 = 0.38 m < 40cm (wall.mdle:7)`.
pub struct CauseText<'a> {
    /// Plan that contains the scope.
    pub plan: &'a dyn Texts,
    /// Transition that ended the scope.
    pub transition: &'a Transition,
    /// Operands that fired.
    pub operands: &'a [Operand],
}

impl fmt::Display for CauseText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plan, transition, operands } = *self;
        if let Some(words) = cause_text(plan.source(), transition, operands) {
            return f.write_str(&words);
        }
        // A plan that was written in Rust has no text.
        let name = plan.name(transition.scope);
        let by = transition.cause.by(plan.condition(transition.scope));
        if name.is_empty() { f.write_str(by) } else { write!(f, "{by} ({name})") }
    }
}

/// Returns the cause of a transition of `plan` as text for a report, with the values of the operands that fired: `r1 =
/// 0.38 m < 40cm (wall.mdle:7)`.
#[must_use]
pub fn cause_words(plan: &impl Plan, transition: &Transition, operands: &[Operand]) -> String {
    CauseText { plan, transition, operands }.to_string()
}

/// Returns the position of an atom as text for a report: its line, the names of its enclosing scopes and the passes of
/// loops.
#[must_use]
pub fn place(plan: &dyn Texts, passes: &Passes, atom: u32) -> String {
    let (fsm, source) = (plan.fsm(), plan.source());
    let Some(own) = fsm.atoms.get(atom as usize).map(|atom| atom.scope) else { return String::new() };
    let around = outwards(fsm, own).filter_map(|(number, bracket)| match bracket.kind {
        // The plan itself encloses every atom, so its name is left out.
        Kind::Scope { .. } => Some(plan.name(number)).filter(|name| number > 0 && !name.is_empty()).map(str::to_owned),
        Kind::Loop { times: 0, .. } => Some(format!("pass {}", passes.of(number))),
        Kind::Loop { times, .. } => Some(format!("pass {} of {times}", passes.of(number))),
    });
    let mut words: Vec<String> = around.collect();
    words.extend(source.bracket(own).map(|own| file_line(source, own.at)));
    words.reverse();
    words.join(", ")
}
