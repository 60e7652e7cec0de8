//! Explains a turn: shows the conditions of the scopes that enclose the atom, before each transition and at the end of
//! the turn.

use mdle_compiler::fsm::Machine;
use mdle_compiler::load::{PlanMoment, ScopeMoment};
use mdle_compiler::plan::Condition;
use mdle_quantity::operand_words;
use mdle_runtime::{Examined, OperandWords, Words};
use serde_json::{Value, json};

/// Explains the moments of a turn.
pub(crate) fn moments(machine: &Machine, words: &dyn Words, moments: &[PlanMoment]) -> Value {
    let moment = |moment: &PlanMoment| {
        json!({
            "atom": moment.atom,
            "ends": moment.cause.is_some(),
            "is_new": moment.is_new(),
            "completed": moment.is_completed,
            "scopes": moment.scopes.iter().map(|moment| scope(machine, words, moment)).collect::<Vec<_>>(),
        })
    };
    moments.iter().map(moment).collect()
}

fn scope(machine: &Machine, words: &dyn Words, moment: &ScopeMoment) -> Value {
    let element = machine.element(moment.bracket);
    let mut parts = Vec::new();
    operands(element.condition(), &mut moment.parts.iter(), &mut parts);
    let source: Vec<_> = words.operands_of(moment.bracket).collect();
    let operand = |(number, (part, holds)): (usize, &(Examined, bool))| {
        let words = source.get(number).map(|words: &OperandWords<'_>| operand_words(words, part.measured, *holds));
        json!({ "fired": part.fired, "words": words })
    };
    json!({
        "element": moment.bracket,
        "since": moment.since.seconds(),
        "fired": moment.parts.first().is_some_and(|part| part.fired),
        "operands": parts.iter().enumerate().map(operand).collect::<Vec<_>>(),
    })
}

/// Appends to `joined` the operands of the AND and OR operators of a condition, each with the value of the comparison
/// that is shown for it. `parts` are the values of the condition and its operands in the order of the text, an operator
/// before its operands.
fn operands(condition: &Condition, parts: &mut std::slice::Iter<'_, Examined>, joined: &mut Vec<(Examined, bool)>) {
    let Some(part) = parts.next().copied() else { return };
    if condition.lasting().is_some() {
        return joined.push((part, part.fired));
    }
    match condition {
        Condition::Null => {}
        Condition::Or(inside) | Condition::And(inside) => {
            inside.iter().for_each(|operand| operands(operand, parts, joined));
        }
        Condition::Not(inside) | Condition::Rising { operand: inside, .. } => {
            joined.push((part, innermost(inside, parts).unwrap_or(part.fired)));
        }
        Condition::Quark(_)
        | Condition::Wait { .. }
        | Condition::Elapsed { .. }
        | Condition::Driven { .. }
        | Condition::After(_) => joined.push((part, part.fired)),
    }
}

/// Removes from `parts` the values of a condition inside NOT or RISING, and returns the value of the innermost
/// comparison.
fn innermost(condition: &Condition, parts: &mut std::slice::Iter<'_, Examined>) -> Option<bool> {
    let part = parts.next()?;
    let inside = if condition.lasting().is_some() { &[] } else { condition.children() };
    let values: Vec<_> = inside.iter().map(|condition| innermost(condition, parts)).collect();
    values.first().copied().flatten().or(Some(part.fired))
}
