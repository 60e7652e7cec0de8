//! Lints (docs/src/reference/language.md, 5: W02xx to W04xx): plans that have a meaning, though hardly the one that was
//! meant.
//!
//! A lint speaks where something is useless for certain; what may be meant as it is written is left alone.

mod conditions;
mod ends;
mod frames;
mod neighbours;
mod numbers;
mod shadows;
mod skipped;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

pub use numbers::bare_numbers;

use super::{Interrupt, Node, Nondegenerate, Plan};
use crate::diagnostic::{Code, Diagnostic, Span};

/// What is suspicious in a plan without degeneracy, each place told once, however often its plan is used.
#[must_use]
pub fn lints(plan: &Nondegenerate) -> Vec<Diagnostic> {
    let plan = plan.plan();
    let mut found = Vec::new();
    conditions::check(plan, &mut found);
    ends::check(plan, &mut found);
    frames::check(plan, &mut found);
    shadows::check(plan, &mut found);
    skipped::check(plan, &mut found);
    neighbours::check(plan, &mut found);
    let mut told: BTreeSet<(Option<Span>, Code)> = BTreeSet::new();
    found.retain(|lint| told.insert((lint.span(), lint.code)));
    found
}

/// Calls `visit` with each sequence of a plan: those of its scopes and of its loops.
fn sequences<'p>(plan: &'p Plan, visit: &mut impl FnMut(&'p [Node])) {
    fn inside<'p>(body: &'p [Node], visit: &mut impl FnMut(&'p [Node])) {
        visit(body);
        for node in body {
            match node {
                Node::Atom(_) => {}
                Node::Scope(scope) => inside(&scope.body, visit),
                Node::Loop(repeated) => inside(&repeated.body, visit),
            }
        }
    }
    inside(&plan.root.body, visit);
}

impl Node {
    /// Its own interrupt; a loop has none.
    fn interrupt(&self) -> Option<&Interrupt> {
        match self {
            Self::Atom(atom) => Some(&atom.interrupt),
            Self::Scope(scope) => Some(&scope.interrupt),
            Self::Loop(_) => None,
        }
    }

    /// Where it is.
    fn span(&self) -> Span {
        match self {
            Self::Atom(atom) => atom.span,
            Self::Scope(scope) => scope.span,
            Self::Loop(repeated) => repeated.span,
        }
    }
}
