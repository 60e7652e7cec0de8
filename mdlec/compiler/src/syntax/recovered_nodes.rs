//! Constructors for the alternatives of the grammar that recover from errors. They create nodes in place of tokens that
//! were dropped.

use super::nodes::{Head, Nodes, Recovery};
use super::source::{Location, TextRange};
use super::tree::{Call, Condition, ConditionNode, Element, Name, Primary};
use super::waiting::First;
use crate::diagnostic::Span;

impl<'s> Nodes<'_, 's> {
    /// Removes the unfinished nodes after `start`, so that they do not become part of a list.
    pub(super) fn dropped(&mut self, start: Location, error: Recovery<'s>) {
        self.errors.push(error);
        self.waiting.forget(self.between(start, start));
    }

    pub(super) fn broken_head(&mut self, start: Location, error: Recovery<'s>) -> &'s Head<'s> {
        self.dropped(start, error);
        self.put(Head::default())
    }

    /// Keeps the robots of a group that were read before the error.
    pub(super) fn broken_robots(
        &mut self,
        first: Option<First>,
        error: Recovery<'s>,
        name: Name<'s>,
        condition: Option<Condition<'s>>,
    ) -> &'s Head<'s> {
        self.errors.push(error);
        self.group_head(first, name, condition)
    }

    /// Keeps the parameters that were read before the error.
    pub(super) fn broken_params(&mut self, error: Recovery<'s>) {
        self.errors.push(error);
    }

    /// Records an error in a group of arguments, and drops the arguments in the group.
    pub(super) fn broken_group(&mut self, start: Location, error: Recovery<'s>) -> First {
        self.dropped(start, error);
        self.waiting.args.len()
    }

    /// Records an error in the arguments of a call, and keeps the arguments that were read before the error.
    pub(super) fn broken_args(
        &mut self,
        start: Location,
        name: Name<'s>,
        first: Option<First>,
        error: Recovery<'s>,
        end: Location,
    ) -> &'s Call<'s> {
        self.errors.push(error);
        self.call(start, name, first, end)
    }

    pub(super) fn broken_condition(&mut self, start: Location, error: Recovery<'s>, end: Location) -> Condition<'s> {
        self.dropped(start, error);
        Condition { node: ConditionNode::Broken, span: self.around(start, end) }
    }

    pub(super) fn broken_element(&mut self, start: Location, error: Recovery<'s>, end: Location) -> First {
        self.dropped(start, error);
        let span = self.around(start, end);
        self.waiting.element(Element { primary: Primary::Broken, marks: None, span })
    }

    pub(super) fn broken_primary(&mut self, start: Location, error: Recovery<'s>) -> Primary<'s> {
        self.dropped(start, error);
        Primary::Broken
    }

    pub(super) fn broken_call(&mut self, start: Location, error: Recovery<'s>) -> Option<&'s Call<'s>> {
        self.dropped(start, error);
        None
    }

    /// Returns the span between two locations, even if dropped text begins or ends at them.
    fn around(&self, start: Location, end: Location) -> Span {
        let first = self.tokens.get(start.token as usize).map_or(self.source.text.len(), |token| token.place.start);
        let last = (end.token as usize).checked_sub(1).and_then(|last| self.tokens.get(last));
        let last = last.map_or(first, |token| token.place.end);
        self.source.span(TextRange::new(first, last.max(first)))
    }
}
