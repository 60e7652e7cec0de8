//! Warns about valid plans that probably do not mean what their author intended (docs/src/reference/language.md, 5:
//! W02xx to W04xx).
//!
//! A lint reports only code that is certainly useless, never code that may be intended.

mod ends;
mod frames;
mod goals;
mod numbers;
mod restarts;
mod skipped;
mod sonars;
#[cfg(test)]
mod tests;
mod unanswered;
mod unlimited;

use std::collections::BTreeSet;

pub use numbers::bare_numbers;

use super::Nondegenerate;
use crate::diagnostic::{Code, Diagnostic, Span};

/// Warns about suspicious parts of a plan without degeneracy. Each part is reported only once, even if its plan is used
/// several times.
#[must_use]
pub fn lints(plan: &Nondegenerate) -> Vec<Diagnostic> {
    let plan = plan.plan();
    let mut found = Vec::new();
    ends::check(plan, &mut found);
    frames::check(plan, &mut found);
    goals::check(plan, &mut found);
    restarts::check(plan, &mut found);
    skipped::check(plan, &mut found);
    sonars::check(plan, &mut found);
    unlimited::check(plan, &mut found);
    unanswered::check(plan, &mut found);
    let mut places: BTreeSet<(Option<Span>, Code)> = BTreeSet::new();
    found.retain(|lint| places.insert((lint.span(), lint.code)));
    found
}
