//! W0302: an atom behind one that the same level-triggered condition ends: it is always skipped, for it is true still.

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::{Condition, Interrupt, Node, Plan};

/// Warns of them.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    super::sequences(plan, &mut |body| {
        for pair in body.windows(2) {
            if let [Node::Atom(first), second] = pair
                && let Some(skipped) = second.interrupt()
                && !plan.quark(first.law).completes
                && first.interrupt.condition == skipped.condition
                && is_level(plan, &skipped.condition)
            {
                let text = &skipped.text;
                let message = format!("`{text}` ends the atom before this as well, so this is always skipped");
                let lint = Diagnostic::new(Code::W0302, message, skipped.span, "true at once")
                    .also(first.interrupt.span, "the atom before it ends when this is true")
                    .help(format!(
                        "wait until it is true no more: put `(Atom ({}) stop)` between the two",
                        not(skipped)
                    ))
                    .fix(
                        "or wait here until it becomes true again: {}",
                        skipped.span,
                        format!("({})", rising(skipped)),
                    );
                found.push(lint);
            }
        }
    });
}

/// The text of its opposite.
fn not(Interrupt { condition, text, .. }: &Interrupt) -> String {
    if matches!(condition, Condition::Quark(_)) {
        return format!("NOT {text}");
    }
    text.strip_prefix("NOT ")
        .filter(|_| matches!(condition, Condition::Not(_)))
        .map_or_else(|| format!("NOT ({text})"), str::to_owned)
}

/// The text of the condition that waits for it to become true.
fn rising(Interrupt { condition, text, .. }: &Interrupt) -> String {
    if matches!(condition, Condition::Quark(_)) { format!("RISING {text}") } else { format!("RISING ({text})") }
}

/// Whether it is the same in both places in one turn, and can be true: no timer, no memory.
fn is_level(plan: &Plan, condition: &Condition) -> bool {
    match condition {
        Condition::Null
        | Condition::Wait { .. }
        | Condition::Elapsed { .. }
        | Condition::Driven { .. }
        | Condition::Rising { .. }
        | Condition::After(_) => false,
        Condition::Quark(id) => !plan.quark(*id).remembers,
        Condition::Or(operands) | Condition::And(operands) => operands.iter().all(|operand| is_level(plan, operand)),
        Condition::Not(operand) => is_level(plan, operand),
    }
}
