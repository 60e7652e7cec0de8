//! What waits for the list that it is in to be complete.

use bumpalo::Bump;

use super::tree::{Arg, Condition, Element, Param};
use crate::diagnostic::Span;

/// Where a list begins among those of its kind that wait.
pub(super) type First = usize;

/// The nodes that wait, in the order of the text: a list that is inside another one is complete before that is.
pub(super) struct Waiting<'s> {
    pub(super) args: Vec<Arg<'s>>,
    pub(super) conditions: Vec<Condition<'s>>,
    pub(super) elements: Vec<Element<'s>>,
    pub(super) params: Vec<Param<'s>>,
}

/// Puts the list that begins at `first` into the arena.
pub(super) fn complete<'s, T: Copy>(waiting: &mut Vec<T>, first: First, arena: &'s Bump) -> &'s [T] {
    let list = arena.alloc_slice_copy(waiting.get(first..).unwrap_or(&[]));
    waiting.truncate(first);
    list
}

impl<'s> Waiting<'s> {
    /// Nothing yet, with room for as much as waits in most plans.
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

    /// Forgets what begins at this empty place or behind it. What is empty there ends there as well, and stays.
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
