//! Lints (docs/src/reference/language.md, 5: W02xx to W04xx): plans that have a meaning, though hardly the one that was
//! meant.
//!
//! A lint speaks where something is useless for certain; what may be meant as it is written is left alone.

mod ends;
mod frames;
mod numbers;
mod skipped;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

pub use numbers::bare_numbers;

use super::{Node, Nondegenerate};
use crate::diagnostic::{Code, Diagnostic, Span};

/// What is suspicious in a plan without degeneracy, each place told once, however often its plan is used.
#[must_use]
pub fn lints(plan: &Nondegenerate) -> Vec<Diagnostic> {
    let plan = plan.plan();
    let mut found = Vec::new();
    ends::check(plan, &mut found);
    frames::check(plan, &mut found);
    skipped::check(plan, &mut found);
    let mut told: BTreeSet<(Option<Span>, Code)> = BTreeSet::new();
    found.retain(|lint| told.insert((lint.span(), lint.code)));
    found
}

impl Node {
    /// Where it is.
    fn span(&self) -> Span {
        match self {
            Self::Atom(atom) => atom.span,
            Self::Scope(scope) => scope.span,
            Self::Loop(repeated) => repeated.span,
        }
    }
}
