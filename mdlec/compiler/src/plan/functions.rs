//! Decides which interrupts are the same function in every scope (paper, Definition 4; docs/src/reference/semantics.md,
//! 7.2 and 7.3).
//!
//! Whole interrupts are compared in a normal form: AND and OR are flattened, sorted and deduplicated, and double NOT is
//! removed.

use std::collections::{BTreeMap, BTreeSet};

use super::{Condition, Quark, QuarkId, RecordId};

/// Compares the interrupts of one plan.
#[derive(Debug)]
pub struct Functions<'q> {
    quarks: &'q [Quark],
    /// For each quark, the first quark that has the same name, signature, arguments and comparison.
    same: Vec<QuarkId>,
}

/// An interrupt as a function. Interrupts with equal functions are the same interrupt (Definition 4, Eq. 3).
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Function(Normal);

/// The normal form that decides whether two interrupts are the same.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Normal {
    Null,
    Quark(QuarkId),
    Or(BTreeSet<Normal>),
    And(BTreeSet<Normal>),
    Not(Box<Normal>),
    Rising(Box<Normal>),
    After(RecordId, u32),
}

/// Returns, for each quark, the first quark in `quarks` with the same name, signature, arguments and comparison.
fn same_functions(quarks: &[Quark]) -> Vec<QuarkId> {
    let mut first = BTreeMap::new();
    let ids = quarks.iter().zip((0..).map(QuarkId));
    ids.map(|(quark, id)| *first.entry((&quark.name, quark.overload, &quark.args, &quark.comparison)).or_insert(id))
        .collect()
}

impl<'q> Functions<'q> {
    /// Prepares the comparison for a plan with these quarks.
    #[must_use]
    pub fn new(quarks: &'q [Quark]) -> Self {
        Self { quarks, same: same_functions(quarks) }
    }

    /// Returns the function of a condition; `None` if the condition never fires, or if its function differs from scope
    /// to scope.
    #[must_use]
    pub fn function(&self, condition: &Condition) -> Option<Function> {
        if !self.can_be_repeated(condition, false) {
            return None;
        }
        let normal = self.normal(condition);
        (normal != Normal::Null).then_some(Function(normal))
    }

    /// Returns `true` if the condition is the same function in every scope.
    fn can_be_repeated(&self, condition: &Condition, under_not: bool) -> bool {
        match condition {
            Condition::Null => true,
            Condition::Quark(id) => self.quarks.get(id.0 as usize).is_some_and(|quark| !quark.remembers),
            Condition::Wait { .. } => !under_not,
            Condition::Elapsed { .. } | Condition::Driven { .. } | Condition::Rising { .. } => false,
            // Equal `after` conditions read the same label of the same use of a plan in every place.
            Condition::After(_) => true,
            Condition::Or(operands) | Condition::And(operands) => {
                operands.iter().all(|operand| self.can_be_repeated(operand, under_not))
            }
            Condition::Not(operand) => self.can_be_repeated(operand, true),
        }
    }

    fn normal(&self, condition: &Condition) -> Normal {
        match condition {
            Condition::Null => Normal::Null,
            Condition::Quark(id)
            | Condition::Wait { quark: id, .. }
            | Condition::Elapsed { quark: id, .. }
            | Condition::Driven { quark: id, .. } => {
                Normal::Quark(self.same.get(id.0 as usize).copied().unwrap_or(*id))
            }
            Condition::Or(operands) => {
                let mut all = BTreeSet::new();
                for operand in operands {
                    match self.normal(operand) {
                        Normal::Or(inner) => all.extend(inner),
                        other @ (Normal::Null | Normal::Quark(_) | Normal::And(_) | Normal::Not(_))
                        | other @ (Normal::Rising(_) | Normal::After(..)) => {
                            all.insert(other);
                        }
                    }
                }
                single(all, Normal::Or)
            }
            Condition::And(operands) => {
                let mut all = BTreeSet::new();
                for operand in operands {
                    match self.normal(operand) {
                        Normal::And(inner) => all.extend(inner),
                        other @ (Normal::Null | Normal::Quark(_) | Normal::Or(_) | Normal::Not(_))
                        | other @ (Normal::Rising(_) | Normal::After(..)) => {
                            all.insert(other);
                        }
                    }
                }
                single(all, Normal::And)
            }
            Condition::Not(operand) => match self.normal(operand) {
                Normal::Not(inner) => *inner,
                other @ (Normal::Null | Normal::Quark(_) | Normal::Or(_) | Normal::And(_))
                | other @ (Normal::Rising(_) | Normal::After(..)) => Normal::Not(Box::new(other)),
            },
            Condition::Rising { operand, .. } => Normal::Rising(Box::new(self.normal(operand))),
            Condition::After(after) => Normal::After(after.record, after.fact),
        }
    }
}

/// Joins operands with `join`; a single operand is returned unchanged.
fn single(mut operands: BTreeSet<Normal>, join: impl Fn(BTreeSet<Normal>) -> Normal) -> Normal {
    match operands.pop_first() {
        Some(only) if operands.is_empty() => only,
        Some(first) => {
            operands.insert(first);
            join(operands)
        }
        None => Normal::Null,
    }
}
