//! A table-driven plan, whose rows the machine looks up.

mod examined;

use crate::condition::ConditionValues;
use crate::fsm::Kind;
use crate::{
    Alphabet, Begin, Cause, Completes, Condition, Control, Cursor, Ending, Entries, Fsm, Guard, Interrupt, Law, LawRow,
    MarkRow, Measured, Meeting, Memory, ModuleRead, Nanos, Plan, Radians, Slots, Table, Words,
};

pub use examined::Examined;

/// A table-driven plan that a [`Machine`](crate::Machine) runs.
pub struct InRows<T: Table, E, P, M = ()> {
    table: T,
    slots: (E, P),
    memory: M,
    running: Option<<T::Alphabet as Alphabet>::Law>,
    /// Number of the current atom's bracket.
    own: u32,
}

type InterruptOf<T> = <<T as Table>::Alphabet as Alphabet>::Interrupt;
type OutputOf<T> = <<T as Table>::Alphabet as Alphabet>::Output;
type InputOf<T> = <<T as Table>::Alphabet as Alphabet>::Input;

impl<T: Table, E: Entries, P: Slots<u64>> InRows<T, E, P> {
    /// Creates the plan, which has not begun yet. `entered` and `left` are the storage for each level of scopes and of
    /// loops; their initial values do not matter.
    #[must_use]
    pub const fn new(table: T, entered: E, left: P) -> Self {
        Self { table, slots: (entered, left), memory: (), running: None, own: 0 }
    }
}

impl<T: Table, E: Entries, P: Slots<u64>, M: Memory> InRows<T, E, P, M> {
    /// Creates a plan with the memories `memory` for RISING and `after`; no memory is set at first.
    #[must_use]
    pub const fn remembering(table: T, entered: E, left: P, memory: M) -> Self {
        Self { table, slots: (entered, left), memory, running: None, own: 0 }
    }

    /// Returns the guard of the outermost enclosing scope whose interrupt has fired; `None` if no interrupt has fired.
    #[inline(always)]
    fn outermost(&self, cursor: &Cursor<E, P>, y: &OutputOf<T>, t: Nanos) -> Option<&Guard<InterruptOf<T>>> {
        // The search goes from the inside outwards and keeps the last match, so the outermost interrupt wins at any
        // nesting depth.
        let (guards, mut here, mut outermost) = (self.table.guards(), self.own, None);
        while let Some(guard) = guards.get(here as usize) {
            let fired = match &guard.condition {
                Condition::Null => false,
                Condition::Quark(interrupt) => interrupt.fired(y),
                Condition::Wait(time) => cursor.since(guard.level, t) >= *time,
                Condition::Lasting(..)
                | Condition::Elapsed(..)
                | Condition::Driven(..)
                | Condition::Or(..)
                | Condition::And(..)
                | Condition::Not(_)
                | Condition::Rising(..)
                | Condition::After(..) => self.compound(guard, cursor, y, t),
            };
            if fired {
                outermost = Some(guard);
            }
            if guard.around >= here {
                break;
            }
            here = guard.around;
        }
        outermost
    }

    /// Returns `true` if a compound condition has fired.
    #[cold]
    #[inline(never)]
    fn compound(&self, guard: &Guard<InterruptOf<T>>, cursor: &Cursor<E, P>, y: &OutputOf<T>, t: Nanos) -> bool {
        guard.condition.fired(&reading(&self.table, &self.memory, guard, cursor, y, t), 0)
    }

    /// Records, for `after`, which elements end and the cause of their end. Clears the facts of the elements inside the
    /// scope that ends.
    fn record(&mut self, cursor: &Cursor<E, P>, cause: Cause, y: &OutputOf<T>, t: Nanos) {
        let Self { table, memory, .. } = self;
        let (fsm, marks, facts) = (table.fsm(), table.marks(), table.facts());
        let scope = table.guards().get(cursor.scope(fsm, cause.level()) as usize);
        let operand = match (cause, scope) {
            (Cause::Fired(_), Some(guard)) => Some(guard.condition.cause(&reading(table, memory, guard, cursor, y, t))),
            (Cause::Completed(_), _) | (_, None) => None,
        };
        let mut outermost = cause.level();
        for (number, bracket) in cursor.ending(fsm, cause.level()) {
            if let Kind::Scope { level } = bracket.kind {
                outermost = level;
            }
            for mark in MarkRow::of(marks, number) {
                let record = mark.first..mark.first.saturating_add(mark.count);
                record.for_each(|number| memory.set(mark.level, number, false));
            }
        }
        for (place, (number, _)) in cursor.ending(fsm, cause.level()).enumerate() {
            let operand = operand.filter(|_| place == 0);
            for mark in MarkRow::of(marks, number) {
                let hold = mark.facts(facts).iter().filter(|fact| fact.operand.is_none() || fact.operand == operand);
                hold.for_each(|fact| memory.set(mark.level, fact.memory, true));
            }
        }
        memory.forget(outermost);
    }

    /// Sets the memory of every RISING whose operand has not fired, in the conditions of all enclosing scopes.
    fn remember(&mut self, cursor: &Cursor<E, P>, y: &OutputOf<T>, t: Nanos) {
        let Self { table, memory, own, .. } = self;
        let mut here = *own;
        while let Some(guard) = table.guards().get(here as usize) {
            let mut from = 0;
            // One memory at a time: setting a memory does not affect the search for the next one.
            while let Some(low) = guard.condition.first_low(&reading(table, memory, guard, cursor, y, t), from) {
                memory.set(guard.level, low, true);
                from = low.saturating_add(1);
            }
            if guard.around >= here {
                break;
            }
            here = guard.around;
        }
    }
}

/// Returns the values that the condition of a guard reads.
fn reading<'r, T: Table, E: Entries, P: Slots<u64>, M>(
    table: &'r T,
    memory: &'r M,
    guard: &Guard<InterruptOf<T>>,
    cursor: &Cursor<E, P>,
    y: &'r OutputOf<T>,
    t: Nanos,
) -> ConditionValues<'r, InterruptOf<T>, OutputOf<T>, M> {
    let (since, way) = (cursor.since(guard.level, t), cursor.way(guard.level));
    let (stalled, level) = (cursor.stalled(), guard.level);
    ConditionValues { y, since, way, stalled, level, operands: table.operands(), memory }
}

impl<T: Table, E: Entries + Clone, P: Slots<u64> + Clone, M: Memory> Plan for InRows<T, E, P, M> {
    type Output = OutputOf<T>;
    type Input = InputOf<T>;
    type Entered = E;
    type Left = P;

    fn fsm(&self) -> Fsm<'_> {
        self.table.fsm()
    }

    fn slots(&self) -> (E, P) {
        self.slots.clone()
    }

    #[inline(always)]
    fn enter(&mut self, atom: u32, y: &OutputOf<T>, begin: Begin) {
        self.own = self.table.fsm().atoms.get(atom as usize).map_or(0, |atom| atom.scope);
        let row = self.table.laws().get(atom as usize);
        self.running = row.map(|LawRow { control, frame }| {
            let turned = *frame != Radians(0.0);
            control.begin(y, if turned { begin.turned(*frame) } else { begin })
        });
    }

    #[inline(always)]
    fn next(&self, cursor: &Cursor<E, P>, y: &OutputOf<T>, t: Nanos) -> Option<Ending> {
        if let Some(Guard { level, follows, .. }) = self.outermost(cursor, y, t) {
            return Some(Ending { cause: Cause::Fired(*level), follows: *follows });
        }
        if !self.running.as_ref()?.completed(y, t) {
            return None;
        }
        let Guard { level, follows, .. } = self.table.guards().get(self.own as usize)?;
        Some(Ending { cause: Cause::Completed(*level), follows: *follows })
    }

    #[inline(always)]
    fn stalled(&self, y: &OutputOf<T>, t: Nanos) -> Option<Nanos> {
        self.running.as_ref()?.stalled(y, t)
    }

    #[inline(always)]
    fn leave(&mut self, cursor: &Cursor<E, P>, cause: Cause, y: &OutputOf<T>, t: Nanos) {
        if self.memory.keeps() {
            self.record(cursor, cause, y, t);
        }
    }

    #[inline(always)]
    fn settle(&mut self, cursor: &Cursor<E, P>, y: &OutputOf<T>, t: Nanos) {
        if self.memory.keeps() {
            self.remember(cursor, y, t);
        }
    }

    #[inline(always)]
    fn input(&mut self, y: &OutputOf<T>, t: Nanos) -> InputOf<T> {
        self.running.as_mut().map_or_else(InputOf::<T>::default, |law| law.input(y, t))
    }

    fn operands(
        &self,
        cursor: &Cursor<E, P>,
        scope: u32,
        y: &OutputOf<T>,
        t: Nanos,
        tell: &mut dyn FnMut(u32, Measured),
    ) {
        if let Some(guard) = self.table.guards().get(scope as usize) {
            guard.condition.tell_fired(&reading(&self.table, &self.memory, guard, cursor, y, t), tell);
        }
    }

    fn law(&self, atom: u32) -> &str {
        self.table.law(atom)
    }

    fn condition(&self, scope: u32) -> &str {
        self.table.condition(scope)
    }

    fn name(&self, scope: u32) -> &str {
        self.table.name(scope)
    }

    fn source(&self) -> &dyn Words {
        self.table.source()
    }

    fn paths(&self) -> &[&'static str] {
        self.table.paths()
    }

    fn reads(&self) -> &'static [ModuleRead] {
        self.table.reads()
    }

    fn robots(&self) -> &[&'static str] {
        self.table.robots()
    }

    fn meetings(&self) -> &[Meeting] {
        self.table.meetings()
    }
}

#[cfg(test)]
mod tests;
