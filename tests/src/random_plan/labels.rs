//! Fills in the operands of `after` in random plans: a label of the same definition, with or without a cause.

use super::{Element, Scope};
use crate::chance::Chance;
use crate::random_condition::{AFTER, operands};

/// Labels, each with the condition of its element; `None` for an element without a condition.
type Labels = Vec<(String, Option<String>)>;

impl Scope {
    /// Replaces every [`AFTER`] in the scope by an `after` with a label of this definition.
    pub(super) fn ask(&mut self, chance: &mut Chance) {
        let mut labels = Labels::new();
        self.body.iter().for_each(|element| element.labels(&mut labels));
        self.fill(chance, &labels);
    }

    fn fill(&mut self, chance: &mut Chance, labels: &Labels) {
        self.condition.iter_mut().for_each(|condition| fill(condition, chance, labels));
        self.body.iter_mut().for_each(|element| element.fill(chance, labels));
    }
}

impl Element {
    fn labels(&self, labels: &mut Labels) {
        match self {
            Self::Labelled(label, element) => {
                labels.push((label.clone(), element.condition()));
                element.labels(labels);
            }
            Self::Framed(_, element) => element.labels(labels),
            Self::Scope(Scope { body, .. }) | Self::Loop { body, .. } | Self::String(body) => {
                body.iter().for_each(|element| element.labels(labels));
            }
            Self::Atom { .. } | Self::Reference(..) => {}
        }
    }

    /// Returns the condition that ends the element, if it has one.
    fn condition(&self) -> Option<String> {
        match self {
            Self::Atom { condition, .. } => Some(condition.clone()),
            Self::Scope(scope) => scope.condition.clone(),
            Self::Framed(_, element) => element.condition(),
            Self::Labelled(..) | Self::Loop { .. } | Self::String(_) | Self::Reference(..) => None,
        }
    }

    fn fill(&mut self, chance: &mut Chance, labels: &Labels) {
        match self {
            Self::Labelled(_, element) | Self::Framed(_, element) => element.fill(chance, labels),
            Self::Atom { condition, .. } => fill(condition, chance, labels),
            Self::Scope(scope) => scope.fill(chance, labels),
            Self::Loop { body, .. } | Self::String(body) => {
                body.iter_mut().for_each(|element| element.fill(chance, labels));
            }
            Self::Reference(..) => {}
        }
    }
}

/// Replaces each placeholder [`AFTER`] in a condition by an `after` with one of these labels, with or without a cause.
fn fill(condition: &mut String, chance: &mut Chance, labels: &Labels) {
    while let Some(at) = condition.find(AFTER) {
        let after = if labels.is_empty() { "a".to_owned() } else { asked(chance, labels) };
        condition.replace_range(at..at + AFTER.len(), &after);
    }
}

fn asked(chance: &mut Chance, labels: &Labels) -> String {
    let (label, condition) = &labels[chance.below(labels.len())];
    let mut operands = condition.as_deref().map(operands).unwrap_or_default();
    // Parentheses around the whole condition do not belong to an operand.
    operands
        .retain(|operand| *operand != "null" && !(operand.starts_with('(') && Some(*operand) == condition.as_deref()));
    // An operand that contains an `after` itself is not filled in yet.
    let operands: Vec<_> = operands.into_iter().filter(|operand| !operand.contains(AFTER)).collect();
    if operands.is_empty() || chance.percent(40) {
        return format!("(after {label})");
    }
    let operand = operands[chance.below(operands.len())];
    if is_call(operand) && chance.percent(50) {
        return format!("(after {label} {operand})");
    }
    format!("(after {label} ({operand}))")
}

/// Returns `true` if the operand is only an interrupt with its arguments.
fn is_call(operand: &str) -> bool {
    let is_a_name = operand.split([' ', '(']).next().is_some_and(|word| !matches!(word, "NOT" | "RISING" | ""));
    is_a_name && !operand.contains(" AND ") && !operand.contains(['<', '=', '>', '≤', '≥', '\\'])
}
