//! Stacks of nodes whose enclosing list is still being parsed.

use bumpalo::Bump;

use super::tree::{Arg, Condition, Element, Param};
use crate::diagnostic::Span;

/// Index of a list's first node in its stack.
pub(super) type First = usize;

/// Stacks of waiting nodes in the order of the text. A nested list is completed before its enclosing list.
pub(super) struct WaitingNodes<'s> {
    pub(super) args: Vec<Arg<'s>>,
    pub(super) conditions: Vec<Condition<'s>>,
    pub(super) elements: Vec<Element<'s>>,
    pub(super) params: Vec<Param<'s>>,
}

/// Moves the list that begins at `first` into the arena.
pub(super) fn complete<'s, T: Copy>(waiting: &mut Vec<T>, first: First, arena: &'s Bump) -> &'s [T] {
    let list = arena.alloc_slice_copy(waiting.get(first..).unwrap_or(&[]));
    waiting.truncate(first);
    list
}

impl<'s> WaitingNodes<'s> {
    /// Returns empty stacks with room for the waiting nodes of most plans.
    pub(super) fn new() -> Self {
        Self {
            args: Vec::with_capacity(8),
            conditions: Vec::with_capacity(8),
            elements: Vec::with_capacity(32),
            params: Vec::new(),
        }
    }

    pub(super) fn arg(&mut self, arg: Arg<'s>) -> First {
        self.args.push(arg);
        self.args.len() - 1
    }

    pub(super) fn condition(&mut self, condition: Condition<'s>) -> First {
        self.conditions.push(condition);
        self.conditions.len() - 1
    }

    pub(super) fn element(&mut self, element: Element<'s>) -> First {
        self.elements.push(element);
        self.elements.len() - 1
    }

    /// Removes the nodes that begin at or after the empty place `at`. An empty node that ends at this place is kept.
    pub(super) fn forget(&mut self, at: Span) {
        forget(&mut self.args, at, Arg::span);
        forget(&mut self.conditions, at, |condition| condition.span);
        forget(&mut self.elements, at, |element| element.span);
        forget(&mut self.params, at, |param| param.name.span);
    }
}

fn forget<T>(waiting: &mut Vec<T>, at: Span, span: impl Fn(&T) -> Span) {
    while waiting.last().map(&span).is_some_and(|last| last > at) {
        waiting.pop();
    }
}
