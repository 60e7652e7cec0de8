//! Evaluates every part of a condition in a turn, for explanations. A run itself never uses these values.

use super::{InRows, OutputOf, reading};
use crate::{Completes as _, Cursor, Entries, Measured, Memory, Nanos, Slots, Table};

/// The value of a condition, or of a part of a condition, in a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Examined {
    /// `true` if the condition or part has fired.
    pub fired: bool,
    /// Values from which the condition or part was evaluated.
    pub measured: Measured,
}

impl<T: Table, E: Entries, P: Slots<u64>, M: Memory> InRows<T, E, P, M> {
    /// Calls `tell` with the value of the condition of `scope`, which encloses the current atom, and with the values of
    /// all parts of the condition. A part comes before its own operands, and operands come from left to right. `stuck`
    /// counts as one part.
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
