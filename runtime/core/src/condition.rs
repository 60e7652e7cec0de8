//! Conditions of interrupts as table rows, and their evaluation (docs/src/reference/semantics.md, 2).

use crate::{Interrupt, Memory, Nanometers, Nanos};

/// The condition of an interrupt, or an operand of a condition.
#[derive(Debug)]
pub enum Condition<I> {
    /// The null interrupt, which never fires.
    Null,
    /// An interrupt quark.
    Quark(I),
    /// Fires once this much time has passed since the condition's scope was entered.
    Wait(Nanos),
    /// Fires while the time since the condition's scope was entered is at least the first value and below the
    /// second.
    Elapsed(Nanos, Nanos),
    /// Fires while the length of the path driven since the condition's scope was entered is at least the first
    /// value and below the second.
    Driven(Nanometers, Nanometers),
    /// Fires when the quark has fired and this much time has passed since the condition's scope was entered. Used for
    /// `stuck`.
    Lasting(I, Nanos),
    /// Fires when any operand fires. Contains the index of the first operand and the count of operands.
    Or(u32, u32),
    /// Fires when all operands fire. Contains the index of the first operand and the count of operands.
    And(u32, u32),
    /// Fires when the operand does not fire. Contains the index of the operand.
    Not(u32),
    /// Fires when the operand fires and a memory records that the operand was false in an earlier turn of this scope.
    /// Contains the indices of the memory and of the operand.
    Rising(u32, u32),
    /// Fires while the memory that records the end of an element is set. Contains the level of the memory's scope and
    /// the index of the memory.
    After(u16, u32),
}

/// Values that a condition reads.
pub(crate) struct ConditionValues<'r, I, Y, M> {
    pub(crate) y: &'r Y,
    /// Time since the scope of the condition was entered.
    pub(crate) since: Nanos,
    pub(crate) level: u16,
    /// Length of the path driven since the scope of the condition was entered.
    pub(crate) way: Nanometers,
    /// Time for which the law of the previous turn has made no progress.
    pub(crate) stalled: Option<Nanos>,
    pub(crate) operands: &'r [Condition<I>],
    pub(crate) memory: &'r M,
}

impl<I> Condition<I> {
    /// Returns `true` if the condition has fired; operands with numbers below `from` are ignored. The recursion depth
    /// equals the nesting depth of the parentheses in the condition's text.
    pub(crate) fn fired<Y, M: Memory>(&self, at: &ConditionValues<'_, I, Y, M>, from: u32) -> bool
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
            Self::Lasting(interrupt, time) => interrupt.fired_during(at.y, at.stalled) & (at.since >= *time),
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

    /// Returns the index, counted from 0, of the first operand of an OR that has fired; 0 for any other condition.
    pub(crate) fn cause<Y, M: Memory>(&self, at: &ConditionValues<'_, I, Y, M>) -> u32
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

    /// Returns the lowest memory number, starting at `from`, among the RISINGs in the condition whose operands have not
    /// fired; `None` if there is no such RISING.
    pub(crate) fn first_low<Y, M: Memory>(&self, at: &ConditionValues<'_, I, Y, M>, from: u32) -> Option<u32>
    where
        I: Interrupt<Y>,
    {
        let mut first: Option<u32> = None;
        self.low(at, 0, &mut |memory| {
            if memory >= from && first.is_none_or(|first| memory < first) {
                first = Some(memory);
            }
        });
        first
    }

    /// Calls `tell` with the memory number of every RISING in the condition whose operand has not fired. Operands with
    /// numbers below `from` are ignored.
    pub(crate) fn low<Y, M: Memory>(&self, at: &ConditionValues<'_, I, Y, M>, from: u32, tell: &mut impl FnMut(u32))
    where
        I: Interrupt<Y>,
    {
        let inside = match self {
            Self::Null | Self::Quark(_) | Self::Wait(_) | Self::Lasting(..) => return,
            Self::Elapsed(..) | Self::Driven(..) | Self::After(..) => return,
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
