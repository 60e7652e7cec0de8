//! Determines which operands of a condition have fired, and their values, when a scope ends and an observer is
//! attached.
//!
//! The operands of a condition are the parts that AND and OR join, from left to right. A NOT or RISING is one operand
//! together with its own operand.

use crate::condition::ConditionValues;
use crate::fsm::Kind;
use crate::{Condition, Cursor, Entries, Examined, Fsm, Interrupt, Measured, Memory, Nanos, Slots};

/// The conditions of a plan in generated code, as rows. They are read only when a scope has ended and an
/// observer is attached.
pub struct Conditions<'a, I> {
    /// The condition of each bracket, in the order of the brackets.
    pub conditions: &'a [Condition<I>],
    /// The operands of conditions. The operands of an operand come after it in this list.
    pub operands: &'a [Condition<I>],
}

impl<I> Conditions<'_, I> {
    /// Calls `tell` with the number and the values of each fired operand in the interrupt of `scope`.
    pub fn fired<Y, E: Entries, P: Slots<u64>>(
        &self,
        fsm: Fsm<'_>,
        cursor: &Cursor<E, P>,
        scope: u32,
        y: &Y,
        t: Nanos,
        tell: &mut dyn FnMut(u32, Measured),
    ) where
        I: Interrupt<Y>,
    {
        let bracket = fsm.brackets.get(scope as usize).map(|bracket| bracket.kind);
        let (Some(Kind::Scope { level }), Some(condition)) = (bracket, self.conditions.get(scope as usize)) else {
            return;
        };
        let (since, way, stalled) = (cursor.since(level, t), cursor.way(level), cursor.stalled());
        condition
            .tell_fired(&ConditionValues { y, since, way, stalled, level, operands: self.operands, memory: &() }, tell);
    }
}

impl<I> Condition<I> {
    /// Calls `tell` with the number and the values of each fired operand, in order.
    pub(crate) fn tell_fired<Y, M: Memory>(
        &self,
        at: &ConditionValues<'_, I, Y, M>,
        tell: &mut dyn FnMut(u32, Measured),
    ) where
        I: Interrupt<Y>,
    {
        let mut number: u32 = 0;
        self.each_operand(at.operands, 0, &mut |operand, from| {
            if operand.fired(at, from) {
                tell(number, operand.measured(at, from));
            }
            number = number.saturating_add(1);
        });
    }

    /// Calls `tell` with the value of the condition and of all its parts; a part comes before its own operands.
    pub(crate) fn examine<Y, M: Memory>(
        &self,
        at: &ConditionValues<'_, I, Y, M>,
        from: u32,
        tell: &mut dyn FnMut(Examined),
    ) where
        I: Interrupt<Y>,
    {
        tell(Examined { fired: self.fired(at, from), measured: self.measured(at, from) });
        let inside = match self {
            Self::Null | Self::Quark(_) | Self::Wait(_) | Self::Lasting(..) => return,
            Self::Elapsed(..) | Self::Driven(..) | Self::After(..) => return,
            Self::Or(first, count) | Self::And(first, count) => *first..first.saturating_add(*count),
            Self::Not(number) | Self::Rising(_, number) => *number..number.saturating_add(1),
        };
        for number in inside {
            let Some(operand) = at.operands.get(number as usize).filter(|_| number >= from) else { continue };
            operand.examine(at, number.saturating_add(1), tell);
        }
    }

    /// Calls `visit` with each operand of the condition, and with the lowest number that the operand's own operands can
    /// have.
    fn each_operand(&self, operands: &[Self], from: u32, visit: &mut dyn FnMut(&Self, u32)) {
        match self {
            Self::Or(first, count) | Self::And(first, count) => {
                for number in *first..first.saturating_add(*count) {
                    let Some(operand) = operands.get(number as usize).filter(|_| number >= from) else { continue };
                    operand.each_operand(operands, number.saturating_add(1), visit);
                }
            }
            Self::Null | Self::Quark(_) | Self::Wait(_) | Self::Lasting(..) => visit(self, from),
            Self::Elapsed(..) | Self::Driven(..) | Self::Not(_) => visit(self, from),
            Self::Rising(..) | Self::After(..) => visit(self, from),
        }
    }

    /// Returns the values from which an operand was evaluated. For a NOT or RISING, these are the values of its own
    /// operand; an AND or OR has none.
    fn measured<Y, M: Memory>(&self, at: &ConditionValues<'_, I, Y, M>, from: u32) -> Measured
    where
        I: Interrupt<Y>,
    {
        match self {
            Self::Quark(interrupt) => interrupt.measured(at.y),
            Self::Lasting(interrupt, _) => interrupt.measured(at.y),
            Self::Wait(_) | Self::Elapsed(..) => Measured::Elapsed(at.since),
            Self::Driven(..) => Measured::Driven(at.way),
            Self::Not(number) | Self::Rising(_, number) => {
                let operand = at.operands.get(*number as usize).filter(|_| *number >= from);
                operand.map_or(Measured::Nothing, |operand| operand.measured(at, number.saturating_add(1)))
            }
            Self::Null | Self::Or(..) | Self::And(..) | Self::After(..) => Measured::Nothing,
        }
    }
}
