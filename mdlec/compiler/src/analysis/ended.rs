//! Determines the facts that records can contain. If an element never ends, its label never gets into its record
//! (docs/src/reference/semantics.md, 2.3).
//!
//! Which elements can end depends on the conditions that test the records. Therefore, the analysis begins without
//! facts, and repeats its walk until no new fact is found.

use std::collections::BTreeSet;

use super::facts::PossibleFacts;
use super::walk::{BracketFacts, OperandOutcome, PlanFacts, Reach, walk};
use crate::fsm::{Element, ElementKind, Machine};
use crate::plan::RecordId;

/// Walks over a machine repeatedly, until a walk finds no new fact that its records can contain. `one_turn` is passed
/// to [`walk`].
pub(super) fn walk_with_records(machine: &Machine, one_turn: bool) -> PlanFacts {
    /// Maximum number of walks. Each walk except the last finds elements that can end only because of facts that the
    /// previous walk has found.
    const WALKS: usize = 8;
    let mut facts = BTreeSet::new();
    for _ in 1..WALKS {
        let walked = walk(machine, one_turn, &PossibleFacts::Only(facts.clone()));
        let before = facts.len();
        facts.extend(recorded(machine, &walked.found));
        if facts.len() == before {
            return walked;
        }
    }
    walk(machine, one_turn, &PossibleFacts::Any)
}

/// Returns the facts that are recorded by elements that can end according to `found`.
fn recorded(machine: &Machine, found: &[BracketFacts]) -> BTreeSet<(RecordId, u32)> {
    let mut ends = vec![false; found.len()];
    let mut facts = BTreeSet::new();
    // Nested elements have higher numbers, so the reverse order visits them first.
    for (element, found) in machine.elements().zip(found).rev() {
        ends[element.index()] = can_end(element, found, &ends);
        let marks = element.marks().iter().flat_map(|mark| mark.facts.iter().map(|fact| (mark.record, fact)));
        facts.extend(marks.filter_map(|(record, fact)| {
            let is_possible = match fact.operand {
                None => ends[element.index()],
                Some(number) => found.operands.get(number as usize).is_none_or(|outcome| can_fire(found, *outcome)),
            };
            is_possible.then_some((record, fact.number))
        }));
    }
    facts
}

/// Returns `true` if an element can end; `ends` contains this result for the elements inside it.
fn can_end(element: Element<'_>, found: &BracketFacts, ends: &[bool]) -> bool {
    let inside = || element.children().last().is_some_and(|last| ends[last.index()]);
    let by_its_body = match element.kind() {
        ElementKind::Atom(_) => false,
        ElementKind::Scope => inside(),
        ElementKind::Loop { times } => times.is_some() && inside(),
    };
    found.completes || by_its_body || found.operands.iter().any(|outcome| can_fire(found, *outcome))
}

/// Returns `true` if an element can end by an operand with this outcome.
fn can_fire(found: &BracketFacts, outcome: OperandOutcome) -> bool {
    found.reach != Reach::Never && outcome == OperandOutcome::Possible
}
