//! A plan as rows of tables: the meaning of its scopes and atoms, as values instead of code.
//!
//! `mdlec` emits rows for plans that are too long to be code of their own, and a plan loaded at run time has rows. A
//! row costs rustc next to nothing, and a turn reads as many rows as there are scopes that enclose the current atom.

use crate::fsm::Kind;
use crate::{
    Alphabet, Begin, Cause, Completes, Control, Cursor, Ending, Entries, Follows, Fsm, Interrupt, Law, Measured,
    Memory, Nanometers, Nanos, Plan, Radians, Slots,
};

/// Meaning of the brackets and atoms of a plan.
pub struct Rows<'a, A: Alphabet> {
    /// The machine's tables.
    pub fsm: Fsm<'a>,
    /// Condition by which each bracket ends, in the order of the brackets.
    pub guards: &'a [Guard<A::Interrupt>],
    /// The operands of conditions. The operands of an operand come after it, so there can be no cycle.
    pub operands: &'a [Condition<A::Interrupt>],
    /// Law of each atom, in the order of the atoms.
    pub laws: &'a [LawRow<A::Control>],
    /// Texts of the plan, for traces and messages.
    pub texts: Texts<'a>,
}

/// Condition by which a scope ends, and the successor; a loop has a row that never fires.
#[derive(Debug)]
pub struct Guard<I> {
    /// Condition of the scope's interrupt.
    pub condition: Condition<I>,
    /// Number of enclosing scopes.
    pub level: u16,
    /// Nearest enclosing bracket whose condition can fire; the bracket's own number if there is no such bracket.
    pub around: u32,
    /// Successor of the scope, if it is known beforehand: [`Fsm::follows`].
    pub follows: Option<Follows>,
}

/// The condition of an interrupt, or an operand of one.
#[derive(Debug)]
pub enum Condition<I> {
    /// Never fires.
    Null,
    /// A quark.
    Quark(I),
    /// Fires once this much time has passed since its scope was entered.
    Wait(Nanos),
    /// Fires while the time since its scope was entered is at least the first value and below the second.
    Elapsed(Nanos, Nanos),
    /// Fires while the length of the path driven since its scope was entered is at least the first value and below the
    /// second.
    Driven(Nanometers, Nanometers),
    /// Fires when any operand fires: the number of the first operand, and the number of operands.
    Or(u32, u32),
    /// Fires when all operands fire: the number of the first operand, and the number of operands.
    And(u32, u32),
    /// Fires when its operand does not: the number of the operand.
    Not(u32),
    /// Fires when its operand fires and did not in an earlier turn of this scope, as the memory records: the numbers of
    /// the memory and of the operand.
    Rising(u32, u32),
    /// Fires while a memory of an ending is set: the level of its scope, and its number.
    After(u16, u32),
}

/// Values that a condition reads.
pub(crate) struct Reading<'r, I, Y, M> {
    pub(crate) y: &'r Y,
    /// Time since the scope of the condition was entered, and the number of that scope's enclosing scopes.
    pub(crate) since: Nanos,
    pub(crate) level: u16,
    /// The length of the path driven since then.
    pub(crate) way: Nanometers,
    pub(crate) operands: &'r [Condition<I>],
    pub(crate) memory: &'r M,
}

impl<I> Condition<I> {
    /// Returns `true` if the condition has fired; reads every operand, whose numbers are `from` or more. The recursion
    /// is as deep as the text's parentheses.
    pub(crate) fn fired<'m, Y, M: Memory<'m>>(&self, at: &Reading<'_, I, Y, M>, from: u32) -> bool
    where
        I: Interrupt<Y>,
    {
        let operand = |number: u32| {
            let operand = at.operands.get(number as usize).filter(|_| number >= from);
            operand.is_some_and(|operand| operand.fired(at, number.saturating_add(1)))
        };
        let all = |first: u32, count: u32| (first..first.saturating_add(count)).map(operand);
        match self {
            Self::Null => false,
            Self::Quark(interrupt) => interrupt.fired(at.y),
            Self::Wait(time) => at.since >= *time,
            Self::Elapsed(from, until) => (*from..*until).contains(&at.since),
            Self::Driven(from, until) => (*from..*until).contains(&at.way),
            Self::Or(first, count) => all(*first, *count).fold(false, |fired, operand| fired | operand),
            Self::And(first, count) => all(*first, *count).fold(true, |fired, operand| fired & operand),
            Self::Not(number) => !operand(*number),
            Self::Rising(memory, number) => at.memory.is_set(at.level, *memory) & operand(*number),
            Self::After(level, memory) => at.memory.is_set(*level, *memory),
        }
    }

    /// Returns the place of the first operand of an OR that has fired; 0 for any other condition.
    fn cause<'m, Y, M: Memory<'m>>(&self, at: &Reading<'_, I, Y, M>) -> u32
    where
        I: Interrupt<Y>,
    {
        let Self::Or(first, count) = self else { return 0 };
        let mut operands = (0..*count).zip(*first..).filter_map(|(place, number)| {
            let operand = at.operands.get(number as usize)?;
            operand.fired(at, number.saturating_add(1)).then_some(place)
        });
        operands.next().unwrap_or(0)
    }

    /// Calls `tell` with the memory of every RISING in the condition whose operand has not fired.
    fn low<'m, Y, M: Memory<'m>>(&self, at: &Reading<'_, I, Y, M>, from: u32, tell: &mut impl FnMut(u32))
    where
        I: Interrupt<Y>,
    {
        let inside = match self {
            Self::Null | Self::Quark(_) | Self::Wait(_) | Self::Elapsed(..) | Self::Driven(..) | Self::After(..) => {
                return;
            }
            Self::Or(first, count) | Self::And(first, count) => *first..first.saturating_add(*count),
            Self::Not(number) | Self::Rising(_, number) => *number..number.saturating_add(1),
        };
        for number in inside {
            let Some(operand) = at.operands.get(number as usize).filter(|_| number >= from) else { continue };
            let behind = number.saturating_add(1);
            if let Self::Rising(memory, _) = self
                && !operand.fired(at, behind)
            {
                tell(*memory);
            }
            operand.low(at, behind, tell);
        }
    }
}

/// The law of an atom, and the angle by which its frame is turned.
#[derive(Debug)]
pub struct LawRow<C> {
    /// The law with its arguments.
    pub control: C,
    /// Counter-clockwise.
    pub frame: Radians,
}

/// The texts of a plan; empty for a plan without texts.
#[derive(Debug)]
pub struct Texts<'a> {
    /// The quark text of each atom's law.
    pub laws: &'a [&'a str],
    /// The condition text of each bracket.
    pub conditions: &'a [&'a str],
    /// The name of each bracket.
    pub names: &'a [&'a str],
}

/// A plan in rows that a [`Machine`](crate::Machine) runs.
pub struct InRows<'a, A: Alphabet, E, P, M = ()> {
    rows: &'a Rows<'a, A>,
    slots: (E, P),
    memory: M,
    running: Option<A::Law>,
    /// The bracket of the current atom.
    own: u32,
}

impl<'a, A: Alphabet, E: Entries, P: Slots<u64>> InRows<'a, A, E, P> {
    /// The plan before it begins, with a place for each level of scopes and of loops; values do not matter.
    #[must_use]
    pub const fn new(rows: &'a Rows<'a, A>, entered: E, left: P) -> Self {
        Self { rows, slots: (entered, left), memory: (), running: None, own: 0 }
    }
}

impl<'a, A: Alphabet, E: Entries, P: Slots<u64>, M: Memory<'a>> InRows<'a, A, E, P, M> {
    /// Returns a plan in rows that remembers; `memory` is empty at first.
    #[must_use]
    pub const fn remembering(rows: &'a Rows<'a, A>, entered: E, left: P, memory: M) -> Self {
        Self { rows, slots: (entered, left), memory, running: None, own: 0 }
    }

    /// Returns the guard of the outermost enclosing scope whose interrupt has fired.
    #[inline(always)]
    fn outermost(&self, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) -> Option<&'a Guard<A::Interrupt>> {
        // From inside out, and the last one found counts: so the outermost wins, however deep scopes are nested.
        let (mut here, mut found) = (self.own, None);
        while let Some(guard) = self.rows.guards.get(here as usize) {
            let fired = match &guard.condition {
                Condition::Null => false,
                Condition::Quark(interrupt) => interrupt.fired(y),
                Condition::Wait(time) => cursor.since(guard.level, t) >= *time,
                Condition::Elapsed(..)
                | Condition::Driven(..)
                | Condition::Or(..)
                | Condition::And(..)
                | Condition::Not(_)
                | Condition::Rising(..)
                | Condition::After(..) => self.compound(guard, cursor, y, t),
            };
            if fired {
                found = Some(guard);
            }
            if guard.around >= here {
                break;
            }
            here = guard.around;
        }
        found
    }

    /// Returns `true` if a condition that consists of others has fired.
    #[cold]
    #[inline(never)]
    fn compound(&self, guard: &Guard<A::Interrupt>, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) -> bool {
        guard.condition.fired(&self.reading(guard, cursor, y, t), 0)
    }

    fn reading<'r>(
        &'r self,
        guard: &Guard<A::Interrupt>,
        cursor: &Cursor<E, P>,
        y: &'r A::Output,
        t: Nanos,
    ) -> Reading<'r, A::Interrupt, A::Output, M> {
        let (since, way) = (cursor.since(guard.level, t), cursor.way(guard.level));
        Reading { y, since, way, level: guard.level, operands: self.rows.operands, memory: &self.memory }
    }

    /// Writes down what ends with the scope that has this cause, and forgets what was inside.
    fn record(&mut self, cursor: &Cursor<E, P>, cause: Cause, y: &A::Output, t: Nanos) {
        let fsm = self.rows.fsm;
        let ended = self.rows.guards.get(cursor.scope(fsm, cause.level()) as usize);
        let operand = match (cause, ended) {
            (Cause::Fired(_), Some(guard)) => Some(guard.condition.cause(&self.reading(guard, cursor, y, t))),
            (Cause::Completed(_), _) | (_, None) => None,
        };
        let mut outermost = cause.level();
        for (number, bracket) in cursor.ending(fsm, cause.level()) {
            if let Kind::Scope { level } = bracket.kind {
                outermost = level;
            }
            for mark in self.memory.marks(number) {
                let record = mark.first..mark.first.saturating_add(mark.count);
                record.for_each(|memory| self.memory.set(mark.level, memory, false));
            }
        }
        for (place, (number, _)) in cursor.ending(fsm, cause.level()).enumerate() {
            let operand = operand.filter(|_| place == 0);
            for mark in self.memory.marks(number) {
                let hold = mark.facts.iter().filter(|(_, cause)| cause.is_none() || *cause == operand);
                hold.for_each(|(memory, _)| self.memory.set(mark.level, *memory, true));
            }
        }
        self.memory.forget(outermost);
    }

    /// Sets the memory of every RISING in the enclosing scopes' conditions whose operand has not fired.
    fn remember(&mut self, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) {
        let (rows, mut here) = (self.rows, self.own);
        while let Some(guard) = rows.guards.get(here as usize) {
            let mut memory = 0;
            // One after the other: a memory that is set changes nothing about those that are still to be.
            while let Some(low) = self.low(guard, cursor, y, t, memory) {
                self.memory.set(guard.level, low, true);
                memory = low.saturating_add(1);
            }
            if guard.around >= here {
                break;
            }
            here = guard.around;
        }
    }

    /// The first RISING of a scope, from this memory on, whose operand has not fired.
    fn low(
        &self,
        guard: &Guard<A::Interrupt>,
        cursor: &Cursor<E, P>,
        y: &A::Output,
        t: Nanos,
        from: u32,
    ) -> Option<u32> {
        let mut first: Option<u32> = None;
        guard.condition.low(&self.reading(guard, cursor, y, t), 0, &mut |memory| {
            if memory >= from && first.is_none_or(|first| memory < first) {
                first = Some(memory);
            }
        });
        first
    }
}

impl<'a, A: Alphabet, E: Entries + Clone, P: Slots<u64> + Clone, M: Memory<'a>> Plan for InRows<'a, A, E, P, M> {
    type Output = A::Output;
    type Input = A::Input;
    type Entered = E;
    type Left = P;

    fn fsm(&self) -> Fsm<'_> {
        self.rows.fsm
    }

    fn slots(&self) -> (E, P) {
        self.slots.clone()
    }

    #[inline(always)]
    fn enter(&mut self, atom: u32, y: &A::Output, begin: Begin) {
        self.own = self.rows.fsm.atoms.get(atom as usize).map_or(0, |atom| atom.scope);
        let row = self.rows.laws.get(atom as usize);
        self.running = row.map(|LawRow { control, frame }| {
            let turned = *frame != Radians(0.0);
            control.begin(y, if turned { begin.turned(*frame) } else { begin })
        });
    }

    #[inline(always)]
    fn next(&self, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) -> Option<Ending> {
        if let Some(Guard { level, follows, .. }) = self.outermost(cursor, y, t) {
            return Some(Ending { cause: Cause::Fired(*level), follows: *follows });
        }
        if !self.running.as_ref()?.completed(y, t) {
            return None;
        }
        let Guard { level, follows, .. } = self.rows.guards.get(self.own as usize)?;
        Some(Ending { cause: Cause::Completed(*level), follows: *follows })
    }

    #[inline(always)]
    fn leave(&mut self, cursor: &Cursor<E, P>, cause: Cause, y: &A::Output, t: Nanos) {
        if M::KEEPS {
            self.record(cursor, cause, y, t);
        }
    }

    #[inline(always)]
    fn settle(&mut self, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) {
        if M::KEEPS {
            self.remember(cursor, y, t);
        }
    }

    #[inline(always)]
    fn input(&mut self, y: &A::Output, t: Nanos) -> A::Input {
        self.running.as_mut().map_or_else(A::Input::default, |law| law.input(y, t))
    }

    fn operands(
        &self,
        cursor: &Cursor<E, P>,
        scope: u32,
        y: &A::Output,
        t: Nanos,
        tell: &mut dyn FnMut(u32, Measured),
    ) {
        if let Some(guard) = self.rows.guards.get(scope as usize) {
            guard.condition.tell_fired(&self.reading(guard, cursor, y, t), tell);
        }
    }

    fn law(&self, atom: u32) -> &str {
        text(self.rows.texts.laws, atom)
    }

    fn condition(&self, scope: u32) -> &str {
        text(self.rows.texts.conditions, scope)
    }

    fn name(&self, scope: u32) -> &str {
        text(self.rows.texts.names, scope)
    }
}

fn text<'a>(texts: &[&'a str], index: u32) -> &'a str {
    texts.get(index as usize).copied().unwrap_or("")
}

#[cfg(test)]
mod tests;
