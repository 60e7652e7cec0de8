//! The text of an operand inside a NOT or RISING, with units and with the positions of its values. It is needed because
//! the plan's source text contains only the whole operand.

use mdle_compiler::alphabet::Unit;
use mdle_compiler::fsm::Machine;
use mdle_compiler::plan::{Compared, Comparison, Condition, QuarkId, condition_text};
use mdle_runtime::{OperandWords, SourceLine, ValueWords};

/// The text of an operand.
pub(super) struct PartText {
    written: String,
    values: Vec<ValueWords<'static>>,
}

impl PartText {
    /// Creates the text of a condition of this machine.
    pub(super) fn of(condition: &Condition, machine: &Machine) -> Self {
        let written = condition_text(condition, &|id| machine.quark(id).text.clone());
        let own = compared(condition).and_then(|id| {
            let quark = machine.quark(id);
            Some((written.find(&quark.text)?, &quark.text, quark.comparison.as_ref()?))
        });
        let Some((from, text, comparison)) = own else { return Self { written, values: Vec::new() } };
        let Comparison { signal, unit, with, .. } = comparison;
        let end = from + text.len();
        let first = value(from + machine.quark(*signal).text.len(), *unit);
        match with {
            Compared::Signal(_) => Self { written, values: vec![first, value(end, *unit)] },
            Compared::Value(_) => {
                let between = if unit.name.is_empty() { "" } else { " " };
                let (before, after) = written.split_at(end);
                Self { written: format!("{before}{between}{}{after}", unit.name), values: vec![first] }
            }
        }
    }

    /// Returns the words of the operand.
    pub(super) fn words(&self) -> OperandWords<'_> {
        let Self { written, values } = self;
        OperandWords { text: written, written, at: SourceLine { file: 0, line: 0 }, values }
    }
}

fn value(after: usize, unit: Unit) -> ValueWords<'static> {
    ValueWords { after: u32::try_from(after).unwrap_or(u32::MAX), unit: unit.name, scale: unit.to_si(1.0) }
}

/// Returns the quark of a condition that is a quark or a comparison, even if it is inside NOT and RISING; `None` for
/// any other condition.
fn compared(condition: &Condition) -> Option<QuarkId> {
    match condition {
        Condition::Quark(id) | Condition::Elapsed { quark: id, .. } | Condition::Driven { quark: id, .. } => Some(*id),
        Condition::Not(inside) | Condition::Rising { operand: inside, .. } => compared(inside),
        Condition::Null | Condition::Wait { .. } | Condition::Or(_) | Condition::And(_) | Condition::After(_) => None,
    }
}
