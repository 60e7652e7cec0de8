//! The state machine of a plan: its tables, and a view of each scope, loop and atom in them.
//!
//! Only this file and [`validate`](super::validate) read the tables of a machine by number.

use std::fmt;
use std::iter;

use mdle_runtime::fsm::{Bracket, Kind};
use mdle_runtime::{Follows, Fsm, Here};

use super::draft::{Draft, RecordPlace, Sizes};
use crate::diagnostic::Span;
use crate::plan::{Condition, Interrupt, Mark, Quark, QuarkId, RecordId};

/// The state machine of a plan, validated against the plan; only [`lower`](super::lower) constructs it.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine(Draft);

impl Machine {
    /// Returns the machine with these validated tables.
    pub(super) fn new(draft: Draft) -> Self {
        Self(draft)
    }

    /// Returns a machine with tables that were not validated, for tests of tables that no plan has.
    #[cfg(test)]
    pub(crate) fn unvalidated(draft: Draft) -> Self {
        Self(draft)
    }

    /// Returns a copy of the tables, for tests that falsify them.
    #[must_use]
    pub fn draft(&self) -> Draft {
        self.0.clone()
    }

    /// Returns the tables as the run-time system takes them.
    #[must_use]
    pub fn tables(&self) -> Fsm<'_> {
        Fsm { brackets: &self.0.brackets, atoms: &self.0.atoms, termination: self.0.termination }
    }

    /// Returns the element of the plan itself.
    #[must_use]
    pub fn root(&self) -> Element<'_> {
        self.element(0)
    }

    /// Returns all scopes, loops and atoms in pre-order: an element comes before its nested elements.
    pub fn elements(&self) -> impl DoubleEndedIterator<Item = Element<'_>> + ExactSizeIterator {
        (0..self.0.brackets.len()).map(|index| self.element(as_number(index)))
    }

    /// Returns two visits of each element, at its entry and at its end; the visits of nested elements come
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

    /// Returns the atoms as written, from left to right.
    pub fn atoms(&self) -> impl DoubleEndedIterator<Item = Atom<'_>> + ExactSizeIterator {
        (0..self.0.atoms.len()).map(|index| self.atom(as_number(index)))
    }

    /// Returns the element of this machine with this number.
    #[must_use]
    pub fn element(&self, number: u32) -> Element<'_> {
        Element { machine: self, number }
    }

    /// Returns the atom of this machine with this number.
    #[must_use]
    pub fn atom(&self, number: u32) -> Atom<'_> {
        Atom { machine: self, number }
    }

    /// Returns the number of states, including the termination state.
    #[must_use]
    pub fn states(&self) -> u64 {
        self.0.termination
    }

    /// Returns the maximum number of scopes that enclose each other, including the plan and an atom's own
    /// scope.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.elements().filter_map(Element::level).max().map_or(0, |level| usize::from(level) + 1)
    }

    /// Returns the quarks with their arguments, each once.
    #[must_use]
    pub fn quarks(&self) -> &[Quark] {
        &self.0.quarks
    }

    /// Returns the quark with this id.
    #[must_use]
    pub fn quark(&self, id: QuarkId) -> &Quark {
        &self.0.quarks[id.0 as usize]
    }

    /// Returns the frame of each atom; `None` for an atom that is not inside a `FRAME here`.
    #[must_use]
    pub fn frames(&self) -> &[Option<Here>] {
        &self.0.frames
    }

    /// Returns the place of a record; `None` if `after` does not read this record.
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

fn as_number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

/// A step of a walk over the elements of a machine.
#[derive(Debug, Clone, Copy)]
pub enum Visit<'m> {
    /// Visit at the entry of the element.
    Enter(Element<'m>),
    /// Visit at the end of the element.
    Leave(Element<'m>),
}

/// A scope, a loop or an atom of a machine.
#[derive(Clone, Copy)]
pub struct Element<'m> {
    machine: &'m Machine,
    number: u32,
}

/// Kind of an element.
#[derive(Debug, Clone, Copy)]
pub enum ElementKind<'m> {
    /// A behavior, or the plan.
    Scope,
    /// A string that is run several times.
    Loop {
        /// Number of passes; `None` for a loop without end.
        times: Option<u64>,
    },
    /// An atom.
    Atom(Atom<'m>),
}

/// Consequence of the end of an element, one step outwards.
#[derive(Debug, Clone, Copy)]
pub enum Exit<'m> {
    /// The plan is over.
    Over,
    /// The next element of the same string is entered.
    Next(Element<'m>),
    /// The string of the enclosing element has ended: a loop may begin its next pass.
    Last(Element<'m>),
}

impl<'m> Element<'m> {
    /// Returns the element's number among all elements in pre-order, from 0.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the element's number as an index into a list with an entry for each element.
    #[must_use]
    pub fn index(self) -> usize {
        self.number as usize
    }

    fn bracket(self) -> &'m Bracket {
        &self.machine.0.brackets[self.index()]
    }

    /// Returns the kind of the element.
    #[must_use]
    pub fn kind(self) -> ElementKind<'m> {
        match self.bracket().kind {
            Kind::Loop { times, .. } => ElementKind::Loop { times: (times > 0).then_some(times) },
            Kind::Scope { .. } => self.atom().map_or(ElementKind::Scope, ElementKind::Atom),
        }
    }

    /// Returns the atom, if the element is an atom.
    #[must_use]
    pub fn atom(self) -> Option<Atom<'m>> {
        let first = self.first();
        (self.machine.0.atoms[first.index()].scope == self.number).then_some(first)
    }

    /// Returns `true` if the element is a scope, but neither a loop nor an atom.
    #[must_use]
    pub fn is_scope(self) -> bool {
        matches!(self.kind(), ElementKind::Scope)
    }

    /// Returns the enclosing element; `None` for the plan.
    #[must_use]
    pub fn parent(self) -> Option<Self> {
        (self.number > 0).then(|| self.machine.element(self.bracket().parent))
    }

    /// Returns the elements of the element's string, in order.
    pub fn children(self) -> impl Iterator<Item = Self> {
        let first = self.atom().is_none().then(|| self.machine.element(self.number + 1));
        iter::successors(first, |child| match child.exit() {
            Exit::Next(next) => Some(next),
            Exit::Last(_) | Exit::Over => None,
        })
    }

    /// Returns the element itself and all elements that enclose it, outwards to the plan.
    pub fn outwards(self) -> impl Iterator<Item = Self> {
        iter::successors(Some(self), |element| element.parent())
    }

    /// Returns the first atom in the element.
    #[must_use]
    pub fn first(self) -> Atom<'m> {
        self.machine.atom(self.bracket().first)
    }

    /// Returns the last atom in the element.
    #[must_use]
    pub fn last(self) -> Atom<'m> {
        self.machine.atom(self.bracket().last)
    }

    /// Returns the name of a scope; empty for a loop, an atom and a scope in formal notation.
    #[must_use]
    pub fn name(self) -> &'m str {
        self.machine.0.scopes[self.index()].as_ref().map_or("", |scope| &scope.name)
    }

    /// Returns the interrupt of a scope or an atom; `None` for a loop.
    #[must_use]
    pub fn interrupt(self) -> Option<&'m Interrupt> {
        self.machine.0.scopes[self.index()].as_ref().map(|scope| &scope.interrupt)
    }

    /// Returns the condition of the element's interrupt; null for a loop.
    #[must_use]
    pub fn condition(self) -> &'m Condition {
        self.interrupt().map_or(&Condition::Null, |interrupt| &interrupt.condition)
    }

    /// Returns the text of the element's condition; empty for a loop.
    #[must_use]
    pub fn condition_text(self) -> &'m str {
        self.interrupt().map_or("", |interrupt| &interrupt.text)
    }

    /// Returns the number of scopes that enclose a scope or an atom; `None` for a loop, which has no level of
    /// its own.
    #[must_use]
    pub fn level(self) -> Option<u16> {
        match self.bracket().kind {
            Kind::Scope { level } => Some(level),
            Kind::Loop { .. } => None,
        }
    }

    /// Returns the number of a loop's counter, and the number of states of one pass in the expanded plan (0 for
    /// a loop without end); `None` for an element that is no loop.
    #[must_use]
    pub fn counter(self) -> Option<(u16, u64)> {
        match self.bracket().kind {
            Kind::Scope { .. } => None,
            Kind::Loop { slot, stride, .. } => Some((slot, stride)),
        }
    }

    /// Returns `true` if the element is an atom whose law may complete.
    #[must_use]
    pub fn completes(self) -> bool {
        self.atom().is_some_and(|atom| atom.law().completes)
    }

    /// Returns the labels of the elements that end together with this one.
    #[must_use]
    pub fn marks(self) -> &'m [Mark] {
        self.machine.0.marks.get(&self.number).map_or(&[], Vec::as_slice)
    }

    /// Returns the consequence of the element's end, one step outwards.
    #[must_use]
    pub fn exit(self) -> Exit<'m> {
        let Some(parent) = self.parent() else { return Exit::Over };
        let last = self.bracket().last;
        if parent.bracket().last == last {
            return Exit::Last(parent);
        }
        // First atoms ascend in pre-order: the next element begins with the first atom after this one's last. After an
        // atom it is the next of all.
        let after = self.index() + 1;
        let rest = &self.machine.0.brackets[after..];
        let nested = match rest.first() {
            Some(next) if next.first > last => 0,
            _ => rest.partition_point(|bracket| bracket.first <= last),
        };
        Exit::Next(self.machine.element(as_number(after + nested)))
    }

    /// Returns the successor of the element; `None` if it depends on a loop at run time.
    #[must_use]
    pub fn follows(self) -> Option<Follows> {
        self.machine.tables().follows(self.number)
    }

    /// Returns the span of an atom, of a loop, or of a scope's definition.
    #[must_use]
    pub fn span(self) -> Span {
        self.machine.0.spans[self.index()]
    }
}

impl fmt::Debug for Element<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "element {}", self.number)
    }
}

/// An atom of a machine.
#[derive(Clone, Copy)]
pub struct Atom<'m> {
    machine: &'m Machine,
    number: u32,
}

impl<'m> Atom<'m> {
    /// Returns the atom's number among the atoms as written, from 0.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the atom's number as an index into a list with an entry for each atom.
    #[must_use]
    pub fn index(self) -> usize {
        self.number as usize
    }

    /// Returns this atom as an element.
    #[must_use]
    pub fn element(self) -> Element<'m> {
        self.machine.element(self.machine.0.atoms[self.index()].scope)
    }

    /// Returns the number of the atom's state, from 1, in the first pass of every loop.
    #[must_use]
    pub fn state(self) -> u64 {
        self.machine.0.atoms[self.index()].state
    }

    /// Returns the id of the atom's law.
    #[must_use]
    pub fn law_id(self) -> QuarkId {
        self.machine.0.laws[self.index()].quark
    }

    /// Returns the atom's law.
    #[must_use]
    pub fn law(self) -> &'m Quark {
        self.machine.quark(self.law_id())
    }

    /// Returns the angle by which the atom's frame is turned, in radians; relative to the innermost enclosing
    /// `FRAME here`, if there is one.
    #[must_use]
    pub fn frame(self) -> f64 {
        self.machine.0.laws[self.index()].frame
    }

    /// Returns the angle by which the plan's own frame is turned for the atom, in radians; 0 inside a `FRAME
    /// here`, which the run-time system applies.
    #[must_use]
    pub fn turned(self) -> f64 {
        if self.machine.0.frames[self.index()].is_some() { 0.0 } else { self.frame() }
    }
}

impl fmt::Debug for Atom<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "atom {}", self.number)
    }
}
