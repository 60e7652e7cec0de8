//! A plan as rows of tables: what its scopes and atoms mean, as values instead of code.
//!
//! `mdlec` emits this for plans that are too long to be code of their own, and a plan loaded at run time is this. A row
//! costs rustc next to nothing, and a turn looks at as many of them as there are scopes around the current atom.

use crate::fsm::Kind;
use crate::{
    Alphabet, Begin, Cause, Completes, Control, Cursor, Ending, Entries, Follows, Fsm, Interrupt, Law, Measured,
    Memory, Nanometers, Nanos, Next, Plan, Radians, Slots,
};

/// What the brackets and atoms of a plan mean.
pub struct Rows<'a, A: Alphabet> {
    /// The machine's tables.
    pub fsm: Fsm<'a>,
    /// When each bracket ends, in their order.
    pub guards: &'a [Guard<A::Interrupt>],
    /// The operands of conditions; those of operands stand further behind, so that no table goes round in a circle.
    pub operands: &'a [Condition<A::Interrupt>],
    /// What each atom does, in their order.
    pub laws: &'a [LawRow<A::Control>],
    /// What traces and messages call all this.
    pub texts: Texts<'a>,
}

/// When a scope ends, and what then; a loop has a row that never fires.
#[derive(Debug)]
pub struct Guard<I> {
    /// Its interrupt.
    pub condition: Condition<I>,
    /// How many scopes are around it.
    pub level: u16,
    /// The nearest bracket around it whose condition can fire; its own number where there is none.
    pub around: u32,
    /// What follows, if that is known beforehand: [`Fsm::follows`].
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
    /// Fires from this time since its scope was entered until that one.
    Elapsed(Nanos, Nanos),
    /// Fires from this length of path driven since its scope was entered until that one.
    Driven(Nanometers, Nanometers),
    /// Fires when one of its operands does: the number of the first, and how many there are.
    Or(u32, u32),
    /// Fires when all of its operands do.
    And(u32, u32),
    /// Fires when its operand, of this number, does not.
    Not(u32),
    /// Fires when its operand does and the memory is set that it once did not: the memory of the scope, and the operand.
    Rising(u32, u32),
    /// Fires while this memory of the scope of this level is set: something has ended last.
    After(u16, u32),
}

/// What a condition is read with.
pub(crate) struct Reading<'r, I, Y, M> {
    pub(crate) y: &'r Y,
    /// The time since its scope was entered, and how many scopes are around that.
    pub(crate) since: Nanos,
    pub(crate) level: u16,
    /// The length of the path driven since then.
    pub(crate) way: Nanometers,
    pub(crate) operands: &'r [Condition<I>],
    pub(crate) memory: &'r M,
}

impl<I> Condition<I> {
    /// Whether it has fired; reads every operand, which stand from number `from` on. It calls itself as deep as the text's
    /// parentheses go.
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

    /// The first operand of its OR that has fired; the first where it is none.
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

    /// Tells the memory of every RISING in it whose operand has not fired.
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

/// The texts of a plan; empty where there is none.
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
    /// The same for a plan that remembers; its memories are empty.
    #[must_use]
    pub const fn remembering(rows: &'a Rows<'a, A>, entered: E, left: P, memory: M) -> Self {
        Self { rows, slots: (entered, left), memory, running: None, own: 0 }
    }

    /// The outermost scope around the current atom whose interrupt has fired.
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

    /// Whether a condition that is made of others has fired.
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

    /// Sets the memory of every RISING around the current atom whose operand has not fired.
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
    fn next(&mut self, cursor: &mut Cursor<E, P>, y: &A::Output, begin: Begin, direct: bool) -> Next {
        let t = begin.now;
        if let Some(Guard { level, follows, .. }) = self.outermost(cursor, y, t) {
            let ending = Ending { cause: Cause::Fired(*level), follows: *follows };
            return self.end(cursor, ending, y, begin, direct);
        }
        if !self.running.as_ref().is_some_and(|law| law.completed(y, t)) {
            return Next::Stays;
        }
        match self.rows.guards.get(self.own as usize) {
            Some(Guard { level, follows, .. }) => {
                let ending = Ending { cause: Cause::Completed(*level), follows: *follows };
                self.end(cursor, ending, y, begin, direct)
            }
            None => Next::Stays,
        }
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
