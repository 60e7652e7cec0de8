//! Memories of a plan (docs/src/reference/semantics.md, 2.2 and 2.3). Each RISING in an entered scope has a memory. The
//! memories of labels record which elements ended last; `after` reads them.

use crate::Slots;

/// Storage for the memories of a plan, with one row for each level of scopes. `()` is the storage of a plan without
/// memories.
pub trait Memory {
    /// Returns `true` if the plan has memories.
    fn keeps(&self) -> bool;
    /// Returns `true` if the memory with this index in the row of this level is set.
    fn is_set(&self, level: u16, memory: u32) -> bool;
    /// Sets or clears the memory with this index in the row of this level.
    fn set(&mut self, level: u16, memory: u32, value: bool);
    /// Clears the memories of this level and of all nested levels.
    fn forget(&mut self, level: u16);
}

impl Memory for () {
    #[inline(always)]
    fn keeps(&self) -> bool {
        false
    }

    fn is_set(&self, _: u16, _: u32) -> bool {
        false
    }

    fn set(&mut self, _: u16, _: u32, _: bool) {}

    fn forget(&mut self, _: u16) {}
}

/// A label of an element, with the bracket at which the element ends, and the positions of the label's memories.
#[derive(Debug, Clone, Copy)]
pub struct MarkRow {
    /// Number of the bracket with which the labelled element ends.
    pub bracket: u32,
    /// Level of the row that contains the label's memories.
    pub level: u16,
    /// Number of the label's first memory in the row.
    pub first: u32,
    /// Number of the label's memories.
    pub count: u32,
    /// Index of the label's first fact in [`Table::facts`](crate::Table::facts).
    pub first_fact: u32,
    /// Number of the label's facts.
    pub facts: u32,
}

/// A memory that belongs to a label and that `after` reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fact {
    /// Number of the memory, in the row that [`MarkRow::level`] gives.
    pub memory: u32,
    /// Index of the operand, within the bracket's interrupt, that must have fired; `None` if the `after` names no
    /// cause.
    pub operand: Option<u32>,
}

impl MarkRow {
    /// Returns the labels of the elements that end with `bracket`; `marks` contains the labels of the plan, in the
    /// order of their brackets.
    pub(crate) fn of(marks: &[Self], bracket: u32) -> &[Self] {
        let before = |bound: u32| marks.partition_point(|mark| mark.bracket < bound);
        marks.get(before(bracket)..before(bracket.saturating_add(1))).unwrap_or(&[])
    }

    /// Returns the facts of this label; `facts` contains the facts of the plan.
    pub(crate) fn facts(self, facts: &[Fact]) -> &[Fact] {
        let (first, count) = (self.first_fact as usize, self.facts as usize);
        facts.get(first..first.saturating_add(count)).unwrap_or(&[])
    }
}

/// Memories of a plan with RISING or `after`.
#[derive(Debug, Clone, Copy)]
pub struct Memories<S> {
    /// Number of memories for each level.
    width: u32,
    set: S,
}

impl<S: Slots<bool>> Memories<S> {
    /// Creates storage with `width` memories for each level of scopes. `set` contains the values, which must all be
    /// `false`; a memory for which `set` has no place is never set.
    #[must_use]
    pub const fn new(width: u32, set: S) -> Self {
        Self { width, set }
    }

    fn place(&self, level: u16, memory: u32) -> usize {
        (self.width as usize).saturating_mul(usize::from(level)).saturating_add(memory as usize)
    }
}

impl<S: Slots<bool>> Memory for Memories<S> {
    #[inline(always)]
    fn keeps(&self) -> bool {
        self.width > 0
    }

    fn is_set(&self, level: u16, memory: u32) -> bool {
        self.set.as_ref().get(self.place(level, memory)).copied().unwrap_or(false)
    }

    fn set(&mut self, level: u16, memory: u32, value: bool) {
        let place = self.place(level, memory);
        if let Some(memory) = self.set.as_mut().get_mut(place) {
            *memory = value;
        }
    }

    fn forget(&mut self, level: u16) {
        let first = self.place(level, 0);
        self.set.as_mut().iter_mut().skip(first).for_each(|memory| *memory = false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_forgets_what_is_inside_it_and_nothing_else() {
        let mut memories = Memories::new(2, [false; 6]);
        for (level, memory) in [(0, 1), (1, 0), (2, 1)] {
            memories.set(level, memory, true);
        }
        memories.forget(1);
        assert!(memories.is_set(0, 1) && !memories.is_set(1, 0) && !memories.is_set(2, 1));
        // A memory without a place in the storage is never set.
        memories.set(9, 0, true);
        assert!(!memories.is_set(9, 0));
    }

    #[test]
    fn marks_are_found_by_their_bracket() {
        let mark = |bracket, first| MarkRow { bracket, level: 0, first, count: 1, first_fact: 0, facts: 0 };
        let marks = [mark(1, 0), mark(3, 1), mark(3, 2), mark(4, 3)];
        let first_memory = |bracket| MarkRow::of(&marks, bracket).iter().map(|mark| mark.first).sum::<u32>();
        assert_eq!([0, 1, 2, 3, 4, 5].map(first_memory), [0, 0, 0, 3, 3, 0]);
    }

    #[test]
    fn a_label_has_the_facts_that_it_numbers() {
        let facts = [3, 1, 2].map(|memory| Fact { memory, operand: None });
        let of = |first_fact, count| {
            let mark = MarkRow { bracket: 0, level: 0, first: 0, count: 0, first_fact, facts: count };
            mark.facts(&facts).iter().map(|fact| fact.memory).sum::<u32>()
        };
        assert_eq!([of(0, 1), of(1, 2), of(2, 0), of(2, 9), of(u32::MAX, u32::MAX)], [3, 3, 0, 0, 0]);
    }

    #[test]
    fn a_plan_without_memories_keeps_none() {
        assert!(!().keeps() && !Memories::new(0, [false; 4]).keeps() && Memories::new(1, [false; 4]).keeps());
    }
}
