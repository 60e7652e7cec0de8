//! A plan as rows of tables: what its scopes and atoms mean, as values instead of code.
//!
//! `mdlec` emits this for plans that are too long to be code of their own, and a plan loaded at run time is this. A row
//! costs rustc next to nothing, and a turn looks at as many of them as there are scopes around the current atom.

use crate::{
    Alphabet, Begin, Cause, Completes, Control, Cursor, Ending, Follows, Fsm, Interrupt, Law, Nanos, Next, Plan,
    Radians, Slots,
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
    /// Fires when one of its operands does: the number of the first, and how many there are.
    Or(u32, u32),
    /// Fires when all of its operands do.
    And(u32, u32),
    /// Fires when its operand, of this number, does not.
    Not(u32),
}

impl<I> Condition<I> {
    /// Whether it has fired, `since` its scope was entered; reads every operand, which stand in `operands` from number
    /// `from` on. It calls itself as deep as the text's parentheses go.
    fn fired<Y>(&self, y: &Y, since: Nanos, operands: &[Self], from: u32) -> bool
    where
        I: Interrupt<Y>,
    {
        let operand = |number: u32| {
            let operand = operands.get(number as usize).filter(|_| number >= from);
            operand.is_some_and(|operand| operand.fired(y, since, operands, number.saturating_add(1)))
        };
        let all = |first: u32, count: u32| (first..first.saturating_add(count)).map(operand);
        match self {
            Self::Null => false,
            Self::Quark(interrupt) => interrupt.fired(y),
            Self::Wait(time) => since >= *time,
            Self::Elapsed(from, until) => (*from..*until).contains(&since),
            Self::Or(first, count) => all(*first, *count).fold(false, |fired, operand| fired | operand),
            Self::And(first, count) => all(*first, *count).fold(true, |fired, operand| fired & operand),
            Self::Not(number) => !operand(*number),
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
pub struct InRows<'a, A: Alphabet, E, P> {
    rows: &'a Rows<'a, A>,
    slots: (E, P),
    running: Option<A::Law>,
    /// The bracket of the current atom.
    own: u32,
}

impl<'a, A: Alphabet, E: Slots<Nanos>, P: Slots<u64>> InRows<'a, A, E, P> {
    /// The plan before it begins, with a place for each level of scopes and of loops; values do not matter.
    #[must_use]
    pub const fn new(rows: &'a Rows<'a, A>, entered: E, left: P) -> Self {
        Self { rows, slots: (entered, left), running: None, own: 0 }
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
                Condition::Elapsed(..) | Condition::Or(..) | Condition::And(..) | Condition::Not(_) => {
                    self.compound(guard, cursor, y, t)
                }
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
        guard.condition.fired(y, cursor.since(guard.level, t), self.rows.operands, 0)
    }
}

impl<A: Alphabet, E: Slots<Nanos> + Clone, P: Slots<u64> + Clone> Plan for InRows<'_, A, E, P> {
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

    fn input(&mut self, y: &A::Output, t: Nanos) -> A::Input {
        self.running.as_mut().map_or_else(A::Input::default, |law| law.input(y, t))
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
mod tests {
    use super::Condition;
    use crate::{Interrupt, Nanos};

    struct Always;

    impl Interrupt<()> for Always {
        fn fired(&self, (): &()) -> bool {
            true
        }
    }

    #[test]
    fn a_condition_that_is_its_own_operand_holds_nobody_up() {
        for operand in [Condition::Not(0), Condition::Or(0, 1), Condition::And(0, 1)] {
            let operands: [Condition<Always>; 1] = [operand];
            let fired = |condition: Condition<Always>| condition.fired(&(), Nanos::ZERO, &operands, 0);
            // What refers to itself or back is as if it were not there, and so has not fired.
            assert_eq!(fired(Condition::Or(0, 1)), matches!(operands[0], Condition::Not(_)));
        }
        assert!(Condition::Or(0, 1).fired(&(), Nanos::ZERO, &[Condition::Quark(Always)], 0));
        assert!(!Condition::Or(0, 1).fired(&(), Nanos::ZERO, &[Condition::Quark(Always)], 1));
    }
}
