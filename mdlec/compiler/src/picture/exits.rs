//! Determines the elements that follow when an element of a plan ends; loops are not expanded
//! (docs/src/reference/semantics.md, 5.3).

use super::texts::until;
use crate::fsm::{Element, ElementKind, Exit, Machine};

/// A destination to which the end of an element can lead.
#[derive(Debug, Clone, Copy)]
pub(super) enum Destination<'m> {
    /// The next element; `last_pass` is `true` if only the last pass of a loop leads there.
    After { next: Element<'m>, last_pass: bool },
    /// The beginning of the loop `repeated`, for its next pass; `times` is `None` for a loop without end.
    Again { repeated: Element<'m>, times: Option<u64> },
    /// The end of the plan; `last_pass` is `true` if only the last pass of a loop leads there.
    Over { last_pass: bool },
}

/// Returns the destinations of an element: the beginnings of loops that end together with the element, and the element
/// after these loops.
pub(super) fn destinations(element: Element<'_>) -> Vec<Destination<'_>> {
    let (mut all, mut exit, mut last_pass) = (Vec::new(), element.exit(), false);
    loop {
        let parent = match exit {
            Exit::Last(parent) => parent,
            Exit::Next(next) => {
                all.push(Destination::After { next, last_pass });
                return all;
            }
            Exit::Over => {
                all.push(Destination::Over { last_pass });
                return all;
            }
        };
        if let ElementKind::Loop { times } = parent.kind()
            && times != Some(1)
        {
            all.push(Destination::Again { repeated: parent, times });
            last_pass = true;
            if times.is_none() {
                return all;
            }
        }
        exit = parent.exit();
    }
}

/// Ways in which an element can end.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WaysOut {
    /// `true` if the element can end, either by itself or together with its last element.
    pub(super) ever: bool,
    /// `true` if the element can end together with its last element, or is an atom that can end.
    pub(super) at_its_end: bool,
}

/// Returns the ways in which each element can end; the index is the element's number.
pub(super) fn ends(machine: &Machine) -> Vec<WaysOut> {
    let mut ends = vec![WaysOut::default(); machine.elements().len()];
    // In reverse order, nested elements come before the elements that enclose them.
    for element in machine.elements().rev() {
        let by_itself = until(element).ends();
        let at_its_end = match element.kind() {
            ElementKind::Atom(_) => by_itself,
            ElementKind::Loop { times: None } => false,
            ElementKind::Loop { times: Some(_) } | ElementKind::Scope => {
                element.children().last().is_some_and(|last| ends[last.index()].ever)
            }
        };
        ends[element.index()] = WaysOut { ever: by_itself || at_its_end, at_its_end };
    }
    ends
}
