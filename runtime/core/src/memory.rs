//! Memory of a plan: for RISING in each entered scope, and for `after` about the latest endings
//! (docs/src/reference/semantics.md, 2.2 and 2.3).

use crate::Slots;

/// The memories of a plan, a row for each level of scopes; `()` for a plan that remembers nothing.
pub trait Memory<'a> {
    /// `true` if the plan has memories, which is known when it is compiled.
    const KEEPS: bool;

    /// Returns `true` if this memory of the scope of this level is set.
    fn is_set(&self, level: u16, memory: u32) -> bool;
    /// Sets this memory of the scope of this level, or clears it.
    fn set(&mut self, level: u16, memory: u32, value: bool);
    /// Clears the memories of this level and of all nested levels.
    fn forget(&mut self, level: u16);
    /// Returns the labels of the parts of the plan that end with a bracket.
    fn marks(&self, bracket: u32) -> &'a [MarkRow<'a>];
}

impl<'a> Memory<'a> for () {
    const KEEPS: bool = false;

    fn is_set(&self, _: u16, _: u32) -> bool {
        false
    }

    fn set(&mut self, _: u16, _: u32, _: bool) {}

    fn forget(&mut self, _: u16) {}

    fn marks(&self, _: u32) -> &'a [MarkRow<'a>] {
        &[]
    }
}

/// A label of what ends with a bracket, and the record that it is written down in.
#[derive(Debug, Clone, Copy)]
pub struct MarkRow<'a> {
    /// The bracket.
    pub bracket: u32,
    /// The level of the record.
    pub level: u16,
    /// The first of its memories ...
    pub first: u32,
    /// ... and how many there are.
    pub count: u32,
    /// Memories that `after` reads about the label, each with the operand of the bracket's interrupt that must be the
    /// cause, if the condition names one.
    pub facts: &'a [(u32, Option<u32>)],
}

/// The memories of a plan that remembers.
#[derive(Debug, Clone, Copy)]
pub struct Memories<'a, S> {
    /// Number of memories of each level.
    width: u32,
    /// Labels in the order of their brackets.
    marks: &'a [MarkRow<'a>],
    set: S,
}

impl<'a, S: Slots<bool>> Memories<'a, S> {
    /// Memories that are empty: `width` for each level of scopes, as many as `set` has room for.
    #[must_use]
    pub const fn new(width: u32, marks: &'a [MarkRow<'a>], set: S) -> Self {
        Self { width, marks, set }
    }

    fn place(&self, level: u16, memory: u32) -> usize {
        (self.width as usize).saturating_mul(usize::from(level)).saturating_add(memory as usize)
    }
}

impl<'a, S: Slots<bool>> Memory<'a> for Memories<'a, S> {
    const KEEPS: bool = true;

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

    fn marks(&self, bracket: u32) -> &'a [MarkRow<'a>] {
        let behind = |bound: u32| self.marks.partition_point(|mark| mark.bracket < bound);
        self.marks.get(behind(bracket)..behind(bracket.saturating_add(1))).unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_forgets_what_is_inside_it_and_nothing_else() {
        let mut memories = Memories::new(2, &[], [false; 6]);
        for (level, memory) in [(0, 1), (1, 0), (2, 1)] {
            memories.set(level, memory, true);
        }
        memories.forget(1);
        assert!(memories.is_set(0, 1) && !memories.is_set(1, 0) && !memories.is_set(2, 1));
        // What there is no room for is never set.
        memories.set(9, 0, true);
        assert!(!memories.is_set(9, 0));
    }

    #[test]
    fn marks_are_found_by_their_bracket() {
        let mark = |bracket, first| MarkRow { bracket, level: 0, first, count: 1, facts: &[] };
        let marks = [mark(1, 0), mark(3, 1), mark(3, 2), mark(4, 3)];
        let memories = Memories::new(1, &marks, [false; 1]);
        let found = |bracket| memories.marks(bracket).iter().map(|mark| mark.first).sum::<u32>();
        assert_eq!([0, 1, 2, 3, 4, 5].map(found), [0, 0, 0, 3, 3, 0]);
    }
}
