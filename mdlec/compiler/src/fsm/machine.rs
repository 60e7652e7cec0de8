//! The state machine of a plan.

use std::iter;

use mdle_runtime::{Fsm, Here};

use super::draft::{MachineDraft, RecordPlace, Sizes};
use super::element::{Atom, Element, Exit, as_number};
use crate::plan::{Quark, QuarkId, RecordId};

/// The state machine of a plan, validated against the plan; only [`lower`](super::lower) constructs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine(MachineDraft);

impl Machine {
    /// Creates the machine with these validated tables.
    pub(super) fn new(draft: MachineDraft) -> Self {
        Self(draft)
    }

    /// Creates a machine with tables that have not been validated, for tests with tables that no plan produces.
    #[cfg(test)]
    pub(crate) fn unvalidated(draft: MachineDraft) -> Self {
        Self(draft)
    }

    /// Returns a copy of the tables, which tests can corrupt.
    #[must_use]
    pub fn draft(&self) -> MachineDraft {
        self.0.clone()
    }

    /// Returns the tables in the form that the run-time system uses.
    #[must_use]
    pub fn tables(&self) -> Fsm<'_> {
        self.0.tables()
    }

    /// Returns the element that is the plan itself.
    #[must_use]
    pub fn root(&self) -> Element<'_> {
        self.element(0)
    }

    /// Returns all scopes, loops and atoms in pre-order: each element comes before its nested elements.
    pub fn elements(&self) -> impl DoubleEndedIterator<Item = Element<'_>> + ExactSizeIterator {
        (0..self.0.brackets.len()).map(|index| self.element(as_number(index)))
    }

    /// Returns two visits of each element, one at its entry and one at its end; the visits of nested elements come
    /// between them.
    pub fn walk(&self) -> impl Iterator<Item = Visit<'_>> {
        iter::successors(Some(Visit::Enter(self.root())), |visit| match *visit {
            Visit::Enter(element) => Some(element.children().next().map_or(Visit::Leave(element), Visit::Enter)),
            Visit::Leave(element) => match element.exit() {
                Exit::Next(next) => Some(Visit::Enter(next)),
                Exit::Last(parent) => Some(Visit::Leave(parent)),
                Exit::Over => None,
            },
        })
    }

    /// Returns the atoms in the order of the plan's text.
    pub fn atoms(&self) -> impl DoubleEndedIterator<Item = Atom<'_>> + ExactSizeIterator {
        (0..self.0.atoms.len()).map(|index| self.atom(as_number(index)))
    }

    /// Returns the element with this number.
    #[must_use]
    pub fn element(&self, number: u32) -> Element<'_> {
        Element::new(&self.0, number)
    }

    /// Returns the atom with this number.
    #[must_use]
    pub fn atom(&self, number: u32) -> Atom<'_> {
        Atom::new(&self.0, number)
    }

    /// Returns the number of states, including the termination state.
    #[must_use]
    pub fn states(&self) -> u64 {
        self.0.termination
    }

    /// Returns the maximum nesting depth of scopes, including the plan and an atom's own scope.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.elements().filter_map(Element::level).max().map_or(0, |level| usize::from(level) + 1)
    }

    /// Returns the quarks with their arguments; each quark is listed once.
    #[must_use]
    pub fn quarks(&self) -> &[Quark] {
        &self.0.quarks
    }

    /// Returns the quark with this id.
    #[must_use]
    pub fn quark(&self, id: QuarkId) -> &Quark {
        self.0.quark(id)
    }

    /// Returns the frame of each atom; `None` for an atom that is not inside a `FRAME here`.
    #[must_use]
    pub fn frames(&self) -> &[Option<Here>] {
        &self.0.frames
    }

    /// Returns the position of a record; `None` if `after` does not read this record.
    #[must_use]
    pub fn record(&self, id: RecordId) -> Option<RecordPlace> {
        self.0.records.get(&id).copied()
    }

    /// Returns the sizes of the state that a machine keeps between turns.
    #[must_use]
    pub fn sizes(&self) -> Sizes {
        self.0.sizes
    }
}

/// One step of a walk over the elements of a machine.
#[derive(Debug, Clone, Copy)]
pub enum Visit<'m> {
    /// Visit at the entry of the element.
    Enter(Element<'m>),
    /// Visit at the end of the element.
    Leave(Element<'m>),
}
