//! Plans of a document that a user can run and draw.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::mentions::{Role, mentions};
use crate::view::View;

/// A plan that a user can run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Runnable {
    /// Name of the plan.
    pub name: String,
    /// Byte range of the name.
    pub range: Range<usize>,
}

/// Returns the plans of the document that are not used by another plan and have no parameters.
#[must_use]
pub fn runnables(view: &View<'_>) -> Vec<Runnable> {
    let mentions = mentions(view.files, view.alphabet);
    let uses = mentions.iter().filter(|mention| mention.role == Role::Plan && !mention.is_definition());
    let used: BTreeSet<_> = uses.filter_map(|mention| mention.defined).collect();
    let roots = view.own().iter().filter(|plan| plan.params.is_empty() && !used.contains(&plan.name.span));
    let runnable = |plan: &mdle_compiler::syntax::tree::Plan<'_>| {
        let range = view.range(plan.name.span).filter(|range| !range.is_empty())?;
        Some(Runnable { name: plan.name.node.to_owned(), range })
    };
    roots.filter_map(runnable).collect()
}
