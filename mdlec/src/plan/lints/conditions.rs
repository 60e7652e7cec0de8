//! W0203: conditions that are always or never true.

use std::collections::BTreeSet;

use crate::diagnostic::{Code, Diagnostic};
use crate::plan::families::{at_once, family};
use crate::plan::{Condition, Interrupt, Plan, Quark, QuarkId};

/// Warns of them.
pub(super) fn check(plan: &Plan, found: &mut Vec<Diagnostic>) {
    let constants = Constants { quarks: &plan.quarks };
    let mut interrupt = |interrupt: &Interrupt, skipped: &str| found.extend(constants.lint(interrupt, skipped));
    interrupt(&plan.root.interrupt, "the plan is over before it begins");
    super::sequences(plan, &mut |body| {
        for node in body {
            let skipped = match node {
                super::Node::Atom(_) => "the atom is skipped whenever it is reached",
                super::Node::Scope(_) => "the behavior is skipped whenever it is reached",
                super::Node::Loop(_) => continue,
            };
            node.interrupt().into_iter().for_each(|found| interrupt(found, skipped));
        }
    });
}

struct Constants<'p> {
    quarks: &'p [Quark],
}

impl Constants<'_> {
    /// Leaves alone what never fires on purpose: `null`, `wait inf` and removed interrupts are the null condition.
    fn lint(&self, interrupt: &Interrupt, skipped: &str) -> Option<Diagnostic> {
        let Interrupt { condition, text, span, .. } = interrupt;
        if *condition == Condition::Null {
            return None;
        }
        if let Some((one, other)) = self.contradiction(condition) {
            let message = format!("`{one}` and `{other}` are never true at once");
            let lint = Diagnostic::new(Code::W0203, message, *span, "so AND of the two is never true");
            let words = format!("if one of them is enough, join them by OR: `{one} OR {other}`");
            let is_all = matches!(condition, Condition::And(operands) if operands.len() == 2);
            return Some(match is_all {
                true => lint.fix(&words, *span, format!("({one} OR {other})")),
                false => lint.help(words),
            });
        }
        Some(match self.value(condition)? {
            true => Diagnostic::new(Code::W0203, format!("`{text}` is always true: {skipped}"), *span, "always true")
                .help("give it a condition that is not true at once, such as `(wait 1)`, or leave it out"),
            false => Diagnostic::new(Code::W0203, format!("`{text}` is never true"), *span, "never true").fix(
                "if it is never to fire, write {}",
                *span,
                "(null)",
            ),
        })
    }

    /// The value that a condition has whatever its quarks say.
    fn value(&self, condition: &Condition) -> Option<bool> {
        match condition {
            Condition::Null => Some(false),
            // Whoever compares `t` or `way` knows that they begin at 0.
            Condition::Quark(_) | Condition::Elapsed { .. } | Condition::Driven { .. } => None,
            Condition::Rising { .. } | Condition::After(_) => None,
            // A scope that is entered now has been entered for no time at all.
            Condition::Wait { nanos, .. } => (*nanos == 0).then_some(true),
            Condition::Or(operands) => self.joined(operands, true),
            Condition::And(operands) => self.joined(operands, false),
            Condition::Not(operand) => self.value(operand).map(|value| !value),
        }
    }

    /// The value of OR (`decisive` is true) or of AND (it is false).
    fn joined(&self, operands: &[Condition], decisive: bool) -> Option<bool> {
        let mut values = operands.iter().map(|operand| self.value(operand));
        if values.clone().any(|value| value == Some(decisive)) || self.opposites(operands).is_some() {
            return Some(decisive);
        }
        values.all(|value| value == Some(!decisive)).then_some(!decisive)
    }

    /// A quark among the operands that is there with NOT as well.
    fn opposites(&self, operands: &[Condition]) -> Option<QuarkId> {
        let plain: BTreeSet<QuarkId> = operands.iter().filter_map(quark).collect();
        let mut negated = operands
            .iter()
            .filter_map(|operand| if let Condition::Not(operand) = operand { quark(operand) } else { None });
        negated.find(|id| plain.contains(id) && !self.quarks[id.0 as usize].remembers)
    }

    /// Two quarks of which all operands are to be true, and only one can be.
    fn excluding(&self, operands: &[Condition]) -> Option<(&str, &str)> {
        let quarks: Vec<&Quark> = operands.iter().filter_map(quark).map(|id| &self.quarks[id.0 as usize]).collect();
        let pairs =
            quarks.iter().enumerate().flat_map(|(at, one)| quarks.iter().skip(at + 1).map(move |other| (one, other)));
        let mut excluding = pairs.filter(|(one, other)| {
            let is_family = family(one).is_some() && family(one) == family(other);
            is_family && !at_once([**one, **other].into_iter()).iter().any(|values| values.iter().all(|value| *value))
        });
        excluding.next().map(|(one, other)| (one.text.as_str(), other.text.as_str()))
    }

    /// Two operands of an AND somewhere in it that exclude each other: the usual mistake where OR was meant.
    fn contradiction(&self, condition: &Condition) -> Option<(&str, &str)> {
        match condition {
            Condition::Null
            | Condition::Quark(_)
            | Condition::Wait { .. }
            | Condition::Elapsed { .. }
            | Condition::Driven { .. }
            | Condition::After(_) => None,
            Condition::Not(operand) | Condition::Rising { operand, .. } => self.contradiction(operand),
            Condition::Or(operands) => operands.iter().find_map(|operand| self.contradiction(operand)),
            Condition::And(operands) => {
                let inside = || operands.iter().find_map(|operand| self.contradiction(operand));
                self.excluding(operands).or_else(inside)
            }
        }
    }
}

/// The quark that a condition is.
fn quark(condition: &Condition) -> Option<QuarkId> {
    if let Condition::Quark(id) = condition { Some(*id) } else { None }
}
