//! A view of each scope, loop and atom of a state machine.
//!
//! Only this file and [`validate`](super::validate) access the tables of a machine by index.

use std::fmt;
use std::iter;

use mdle_runtime::Follows;
use mdle_runtime::fsm::{Bracket, Kind};

use super::draft::MachineDraft;
use crate::diagnostic::Span;
use crate::plan::{Condition, Interrupt, Mark, Quark, QuarkId};

/// A scope, a loop or an atom of a machine.
#[derive(Clone, Copy)]
pub struct Element<'m> {
    tables: &'m MachineDraft,
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

/// Consequence of the end of an element, without further steps.
#[derive(Debug, Clone, Copy)]
pub enum Exit<'m> {
    /// The plan is over.
    Over,
    /// The element is followed by another element in the same string, which is entered.
    Next(Element<'m>),
    /// The element was the last one in the string of its enclosing element; contains the enclosing element. If the
    /// enclosing element is a loop, it may begin its next pass.
    Last(Element<'m>),
}

impl<'m> Element<'m> {
    /// Creates the element with this number in these tables.
    pub(super) fn new(tables: &'m MachineDraft, number: u32) -> Self {
        Self { tables, number }
    }

    /// Returns the index of the element among all elements in pre-order.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the index of the element as `usize`, for lists with an entry for each element.
    #[must_use]
    pub fn index(self) -> usize {
        self.number as usize
    }

    fn bracket(self) -> &'m Bracket {
        &self.tables.brackets[self.index()]
    }

    /// Returns the kind of the element.
    #[must_use]
    pub fn kind(self) -> ElementKind<'m> {
        match self.bracket().kind {
            Kind::Loop { times, .. } => ElementKind::Loop { times: (times > 0).then_some(times) },
            Kind::Scope { .. } => self.atom().map_or(ElementKind::Scope, ElementKind::Atom),
        }
    }

    /// Returns the atom if the element is an atom; `None` otherwise.
    #[must_use]
    pub fn atom(self) -> Option<Atom<'m>> {
        let first = self.first();
        (self.tables.atoms[first.index()].scope == self.number).then_some(first)
    }

    /// Returns `true` if the element is a behavior or the plan, and not a loop or an atom.
    #[must_use]
    pub fn is_scope(self) -> bool {
        matches!(self.kind(), ElementKind::Scope)
    }

    /// Returns the enclosing element; `None` for the plan.
    #[must_use]
    pub fn parent(self) -> Option<Self> {
        (self.number > 0).then(|| Self::new(self.tables, self.bracket().parent))
    }

    /// Returns the elements of the element's string, in order.
    pub fn children(self) -> impl Iterator<Item = Self> {
        let first = self.atom().is_none().then(|| Self::new(self.tables, self.number + 1));
        iter::successors(first, |child| match child.exit() {
            Exit::Next(next) => Some(next),
            Exit::Last(_) | Exit::Over => None,
        })
    }

    /// Returns an iterator over the element itself and all elements that enclose it, from the innermost to the plan.
    pub fn outwards(self) -> impl Iterator<Item = Self> {
        iter::successors(Some(self), |element| element.parent())
    }

    /// Returns the first atom in the element.
    #[must_use]
    pub fn first(self) -> Atom<'m> {
        Atom::new(self.tables, self.bracket().first)
    }

    /// Returns the last atom in the element.
    #[must_use]
    pub fn last(self) -> Atom<'m> {
        Atom::new(self.tables, self.bracket().last)
    }

    /// Returns the name of a scope; empty for a loop, an atom and a scope in formal notation.
    #[must_use]
    pub fn name(self) -> &'m str {
        self.tables.scopes[self.index()].as_ref().map_or("", |scope| &scope.name)
    }

    /// Returns the interrupt of a scope or an atom; `None` for a loop.
    #[must_use]
    pub fn interrupt(self) -> Option<&'m Interrupt> {
        self.tables.scopes[self.index()].as_ref().map(|scope| &scope.interrupt)
    }

    /// Returns the condition of the element's interrupt; the null condition for a loop.
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

    /// Returns the index of a loop's counter, and the number of states of one pass in the expanded plan (0 for a loop
    /// without end); `None` for an element that is not a loop.
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

    /// Returns the labels of the elements that end together with this element.
    #[must_use]
    pub fn marks(self) -> &'m [Mark] {
        self.tables.marks.get(&self.number).map_or(&[], Vec::as_slice)
    }

    /// Returns the consequence of the element's end, without further steps.
    #[must_use]
    pub fn exit(self) -> Exit<'m> {
        let Some(parent) = self.parent() else { return Exit::Over };
        let last = self.bracket().last;
        if parent.bracket().last == last {
            return Exit::Last(parent);
        }
        // In pre-order, the first atoms of elements ascend, so the next element begins with the atom after this
        // element's last atom. If this element is an atom, the next element follows it directly in the table.
        let after = self.index() + 1;
        let rest = &self.tables.brackets[after..];
        let nested = match rest.first() {
            Some(next) if next.first > last => 0,
            _ => rest.partition_point(|bracket| bracket.first <= last),
        };
        Exit::Next(Self::new(self.tables, as_number(after + nested)))
    }

    /// Returns the successor of the element; `None` if it depends on a loop at run time.
    #[must_use]
    pub fn follows(self) -> Option<Follows> {
        self.tables.tables().follows(self.number)
    }

    /// Returns the span of an atom, of a loop, or of a scope's definition.
    #[must_use]
    pub fn span(self) -> Span {
        self.tables.spans[self.index()]
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
    tables: &'m MachineDraft,
    number: u32,
}

impl<'m> Atom<'m> {
    /// Creates the atom with this number in these tables.
    pub(super) fn new(tables: &'m MachineDraft, number: u32) -> Self {
        Self { tables, number }
    }

    /// Returns the index of the atom in the order of the plan's text.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the index of the atom as `usize`, for lists with an entry for each atom.
    #[must_use]
    pub fn index(self) -> usize {
        self.number as usize
    }

    /// Returns this atom as an element.
    #[must_use]
    pub fn element(self) -> Element<'m> {
        Element::new(self.tables, self.tables.atoms[self.index()].scope)
    }

    /// Returns the number of the atom's state, counted from 1, in the first pass of all loops.
    #[must_use]
    pub fn state(self) -> u64 {
        self.tables.atoms[self.index()].state
    }

    /// Returns the id of the atom's law.
    #[must_use]
    pub fn law_id(self) -> QuarkId {
        self.tables.laws[self.index()].quark
    }

    /// Returns the atom's law.
    #[must_use]
    pub fn law(self) -> &'m Quark {
        self.tables.quark(self.law_id())
    }

    /// Returns the angle, in radians, by which the atom's frame is turned. It is relative to the innermost enclosing
    /// `FRAME here`; if there is none, it is relative to the plan's frame.
    #[must_use]
    pub fn frame(self) -> f64 {
        self.tables.laws[self.index()].frame
    }

    /// Returns the angle, in radians, by which the atom's frame is turned relative to the plan's frame; 0 inside a
    /// `FRAME here`, whose angle the run-time system adds.
    #[must_use]
    pub fn turned(self) -> f64 {
        if self.tables.frames[self.index()].is_some() { 0.0 } else { self.frame() }
    }
}

impl fmt::Debug for Atom<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "atom {}", self.number)
    }
}

/// Converts an index into the tables to the type in which the tables store numbers.
pub(super) fn as_number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
