//! Removes degeneracy (paper, Definition 4; semantics, section 7): afterwards no interrupt is repeated inside its scope.
//!
//! The outer interrupt is read first and so always wins; replacing the inner ones by the null interrupt changes no trace.

use std::collections::{BTreeMap, BTreeSet};

use super::{Atom, Condition, Interrupt, Node, Plan, Quark, QuarkId, RecordId, Scope};
use crate::diagnostic::{Code, Diagnostic, Span};

/// A plan without degeneracy; only [`remove_degeneracy`] makes one.
#[derive(Debug, Clone, PartialEq)]
pub struct Nondegenerate(Plan);

impl Nondegenerate {
    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.0
    }

    /// The plan with its outermost scope rewritten in a way that repeats no interrupt, such as expansion.
    #[must_use]
    pub(crate) fn map(&self, rewrite: impl FnOnce(&Scope) -> Scope) -> Self {
        Self(Plan { root: rewrite(&self.0.root), quarks: self.0.quarks.clone() })
    }
}

/// Replaces every repeated interrupt by the null interrupt and warns of each, once.
#[must_use]
pub fn remove_degeneracy(mut plan: Plan) -> (Nondegenerate, Vec<Diagnostic>) {
    let mut removal = Removal { same: same_functions(&plan.quarks), quarks: &plan.quarks, ..Removal::default() };
    removal.scope(&mut plan.root);
    let warnings = removal.warnings;
    (Nondegenerate(plan), warnings)
}

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

/// For each quark the first one that is the same function.
fn same_functions(quarks: &[Quark]) -> Vec<QuarkId> {
    let mut first = BTreeMap::new();
    let ids = quarks.iter().zip((0..).map(QuarkId));
    ids.map(|(quark, id)| *first.entry((&quark.name, quark.overload, &quark.args, &quark.comparison)).or_insert(id))
        .collect()
}

/// The interrupts of the scopes around the place where the removal is, each with its scope's name and its own place.
#[derive(Default)]
struct Removal<'a> {
    same: Vec<QuarkId>,
    quarks: &'a [Quark],
    around: BTreeMap<Normal, (String, Span)>,
    warned: BTreeSet<(Span, Span)>,
    warnings: Vec<Diagnostic>,
}

impl Removal<'_> {
    fn scope(&mut self, scope: &mut Scope) {
        // New, or it would have been removed.
        let normal = self.interrupt(&mut scope.interrupt, None);
        if let Some(normal) = &normal {
            self.around.insert(normal.clone(), (scope.name.clone(), scope.interrupt.span));
        }
        self.sequence(&mut scope.body);
        if let Some(normal) = &normal {
            self.around.remove(normal);
        }
    }

    fn sequence(&mut self, body: &mut [Node]) {
        for node in body {
            match node {
                Node::Atom(Atom { law, interrupt, .. }) => {
                    self.interrupt(interrupt, Some(*law));
                }
                Node::Scope(scope) => self.scope(scope),
                Node::Loop(repeated) => self.sequence(&mut repeated.body),
            }
        }
    }

    /// Removes the interrupt if it is repeated; else gives its normal form, if it can be repeated at all.
    fn interrupt(&mut self, interrupt: &mut Interrupt, law: Option<QuarkId>) -> Option<Normal> {
        if !self.can_be_repeated(&interrupt.condition, false) {
            return None;
        }
        let normal = self.normal(&interrupt.condition);
        if normal == Normal::Null {
            return None;
        }
        let Some((scope, outer)) = self.around.get(&normal).cloned() else { return Some(normal) };
        if self.warned.insert((interrupt.span, outer)) {
            self.warnings.push(self.warning(interrupt, law, &scope, outer));
        }
        interrupt.condition = Condition::Null;
        interrupt.removed = true;
        None
    }

    /// Whether the condition is the same function wherever it stands.
    fn can_be_repeated(&self, condition: &Condition, under_not: bool) -> bool {
        match condition {
            Condition::Null => true,
            Condition::Quark(id) => self.quarks.get(id.0 as usize).is_some_and(|quark| !quark.remembers),
            Condition::Wait { .. } => !under_not,
            Condition::Elapsed { .. } | Condition::Rising { .. } => false,
            // It is the same label of the same use of a plan, or it is another one.
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
            Condition::Quark(id) | Condition::Wait { quark: id, .. } | Condition::Elapsed { quark: id, .. } => {
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

    fn warning(&self, interrupt: &Interrupt, law: Option<QuarkId>, scope: &str, outer: Span) -> Diagnostic {
        let whose = if scope.is_empty() { "the scope around it".to_owned() } else { format!("`{scope}`") };
        let warning = Diagnostic::new(
            Code::W0101,
            format!("`{}` is repeated inside {whose}, which has the same interrupt", interrupt.text),
            interrupt.span,
            "removed: it can never be the one that fires",
        )
        .also(outer, format!("{whose} is ended by this one first"));
        match law.and_then(|law| self.quarks.get(law.0 as usize)) {
            Some(law) if law.completes => warning.help(format!("the atom now ends when `{}` is done", law.text)),
            Some(law) => warning.help(format!(
                "`{}` never ends by itself: give the atom another condition if something is to follow it",
                law.text
            )),
            None => warning.help("write `(null)` if nothing else is to end this scope"),
        }
    }
}

/// A set of one operand is that operand.
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
