//! Creates the nodes of projected plans.

use std::collections::{BTreeMap, BTreeSet};

use crate::alphabet::Alphabet;
use crate::diagnostic::{Diagnostic, Span};
use crate::syntax::Arena;
use crate::syntax::tree::{Arg, Atom, Call, Condition, ConditionNode, Element, Marks, Name, Number, Primary, Spanned};

/// State of a projection: the group, the arena for new nodes, and the diagnostics so far.
pub(super) struct Build<'b, 's> {
    pub(super) arena: &'s Arena,
    pub(super) robots: &'b [Name<'s>],
    pub(super) found: &'b mut Vec<Diagnostic>,
    pub(super) alphabet: &'b Alphabet,
    /// Name of the group's plan.
    pub(super) group: &'s str,
    /// For each atom of the group, the number that it has in the plans of all robots except the first. The last entry
    /// is the number of the final stop in these plans.
    pub(super) numbers: Vec<usize>,
    /// Number of atoms that have been projected.
    pub(super) done: usize,
    /// Meetings as written in the group's plan, each with the interrupts that replace it in the first robot's plan.
    pub(super) meetings: BTreeMap<String, BTreeSet<String>>,
    /// For each label of an atom, the number of atoms before that atom.
    pub(super) labels: BTreeMap<&'s str, usize>,
}

/// Returns an empty span at the start of `span`.
pub(super) fn begin(span: Span) -> Span {
    Span { end: span.start, ..span }
}

impl<'s> Build<'_, 's> {
    /// Returns the number that the current atom has in the plans of all robots except the first.
    pub(super) fn own_number(&self) -> usize {
        self.numbers.get(self.done).copied().unwrap_or(1)
    }

    /// Returns the number that the final stop has in the plans of all robots except the first.
    pub(super) fn last_number(&self) -> usize {
        self.numbers.last().copied().unwrap_or(1)
    }

    pub(super) fn atom(
        &self,
        condition: Condition<'s>,
        control: &'s Call<'s>,
        marks: Option<&'s Marks<'s>>,
        span: Span,
    ) -> Element<'s> {
        Element { primary: Primary::Atom(self.arena.alloc(Atom { condition, control })), marks, span }
    }

    pub(super) fn list(&self, elements: &[Element<'s>]) -> &'s [Element<'s>] {
        self.arena.alloc_slice_copy(elements)
    }

    pub(super) fn call(&self, name: &'s str, args: &[Arg<'s>], span: Span) -> &'s Call<'s> {
        self.arena.alloc(Call { name, args: self.arena.alloc_slice_copy(args), span })
    }

    /// Returns the condition `past ROBOT NUMBER` at `span`. If the span is empty, reports of runs show the text of this
    /// condition.
    pub(super) fn past(&self, robot: &Name<'s>, number: usize, span: Span) -> Condition<'s> {
        let number = Number::new(self.arena.alloc_str(&number.to_string()), span);
        let call = self.call("past", &[Arg::Name(Name { node: robot.node, span }), Arg::Number(number)], span);
        Condition { node: ConditionNode::Call(call), span }
    }

    /// Returns the condition that fires once the first robot has reached the atom with this number in its plan.
    pub(super) fn past_first(&self, number: usize, span: Span) -> Condition<'s> {
        let first = self.robots.first().copied().unwrap_or(Spanned { node: "", span });
        self.past(&first, number, begin(span))
    }

    /// Joins conditions with `join`. A single condition is returned unchanged.
    pub(super) fn join(
        &self,
        parts: &[Condition<'s>],
        span: Span,
        join: fn(&'s &'s [Condition<'s>]) -> ConditionNode<'s>,
    ) -> Condition<'s> {
        match parts {
            [only] => *only,
            _ => Condition { node: join(self.arena.alloc(&*self.arena.alloc_slice_copy(parts))), span },
        }
    }

    /// Returns an argument at `span` for a length in metres, which is rounded to the millimetre.
    pub(super) fn length(&self, metres: f64, span: Span) -> Arg<'s> {
        let digits = format!("{metres:.3}");
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        let digits = if digits == "-0" { "0" } else { digits };
        Arg::Number(Number::new(self.arena.alloc_str(&format!("{digits}m")), span))
    }

    /// Returns the name of the first robot as an argument at `span`.
    pub(super) fn first(&self, span: Span) -> Arg<'s> {
        Arg::Name(Name { node: self.robots.first().map_or("", |first: &Spanned<&'s str>| first.node), span })
    }
}
