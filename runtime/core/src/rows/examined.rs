//! The value of every part of a condition in a turn, for explanations: read beside a run, never by it.

use super::{InRows, OutputOf, reading};
use crate::{Completes as _, Cursor, Entries, Measured, Memory, Nanos, Slots, Table};

/// A condition or a part of one in a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Examined {
    /// `true` if it has fired.
    pub fired: bool,
    /// The values from which it was evaluated.
    pub measured: Measured,
}

impl<T: Table, E: Entries, P: Slots<u64>, M: Memory> InRows<T, E, P, M> {
    /// Calls `tell` with the condition of `scope`, which encloses the current atom, and with all its parts: a part
    /// comes before its own operands, which come from left to right. `stuck` is one part.
    pub fn examine(
        &self,
        cursor: &Cursor<E, P>,
        scope: u32,
        y: &OutputOf<T>,
        t: Nanos,
        tell: &mut dyn FnMut(Examined),
    ) {
        if let Some(guard) = self.table.guards().get(scope as usize) {
            guard.condition.examine(&reading(&self.table, &self.memory, guard, cursor, y, t), 0, tell);
        }
    }

    /// Returns `true` if the law of the current atom is done, whether or not an interrupt has fired.
    pub fn is_completed(&self, y: &OutputOf<T>, t: Nanos) -> bool {
        self.running.as_ref().is_some_and(|law| law.completed(y, t))
    }
}
