//! A plan as rows of tables: what its scopes and atoms mean, as values instead of code.
//!
//! `mdlec` emits this for plans that are too long to be code of their own, and a plan loaded at run time is this. A row
//! costs rustc next to nothing, and a turn looks at as many of them as there are scopes around the current atom.

use crate::fsm::Kind;
use crate::{Alphabet, Begin, Cause, Completes, Control, Cursor, Fsm, Interrupt, Law, Nanos, Plan, Radians, Slots};

/// What the brackets and atoms of a plan mean.
pub struct Rows<'a, A: Alphabet> {
    /// The machine's tables.
    pub fsm: Fsm<'a>,
    /// When each scope ends, in the order of the brackets, [`Condition::Null`] for a loop; behind them the operands.
    pub conditions: &'a [Condition<A::Interrupt>],
    /// What each atom does, in their order.
    pub laws: &'a [LawRow<A::Control>],
    /// What traces and messages call all this.
    pub texts: Texts<'a>,
}

/// The condition of an interrupt, or an operand of one. Operands stand further behind in the table, so that no table
/// goes round in a circle.
#[derive(Debug)]
pub enum Condition<I> {
    /// Never fires.
    Null,
    /// A quark.
    Quark(I),
    /// Fires once this much time has passed since its scope was entered.
    Wait(Nanos),
    /// Fires when one of its operands does: the number of the first, and how many there are.
    Or(u32, u32),
    /// Fires when all of its operands do.
    And(u32, u32),
    /// Fires when its operand, of this number, does not.
    Not(u32),
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
#[derive(Debug, Clone, Copy)]
pub struct Texts<'a> {
    /// The quark text of each atom's law.
    pub laws: &'a [&'a str],
    /// The condition text of each bracket.
    pub conditions: &'a [&'a str],
    /// The name of each bracket.
    pub names: &'a [&'a str],
}

impl<A: Alphabet> Clone for Rows<'_, A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Alphabet> Copy for Rows<'_, A> {}

/// Whether the condition of this number has fired; reads every operand. `since` is the time since its scope was entered.
fn fired<Y, I: Interrupt<Y>>(conditions: &[Condition<I>], number: u32, y: &Y, since: Nanos) -> bool {
    let operand = |operand: u32| operand > number && fired(conditions, operand, y, since);
    let operands = |first: u32, count: u32| (first..first.saturating_add(count)).map(operand);
    match conditions.get(number as usize) {
        Some(Condition::Null) | None => false,
        Some(Condition::Quark(interrupt)) => interrupt.fired(y),
        Some(Condition::Wait(time)) => since >= *time,
        Some(Condition::Or(first, count)) => operands(*first, *count).fold(false, |fired, operand| fired | operand),
        Some(Condition::And(first, count)) => operands(*first, *count).fold(true, |fired, operand| fired & operand),
        Some(Condition::Not(number)) => !operand(*number),
    }
}

/// A plan in rows that a [`Machine`](crate::Machine) runs.
pub struct InRows<'a, A: Alphabet, E, P> {
    rows: Rows<'a, A>,
    slots: (E, P),
    running: Option<A::Law>,
}

impl<'a, A: Alphabet, E, P> InRows<'a, A, E, P> {
    /// The plan before it begins, with a place for each level of scopes and of loops; values do not matter.
    #[must_use]
    pub const fn new(rows: Rows<'a, A>, entered: E, left: P) -> Self {
        Self { rows, slots: (entered, left), running: None }
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
        let row = self.rows.laws.get(atom as usize);
        self.running = row.map(|LawRow { control, frame }| {
            let turned = *frame != Radians(0.0);
            control.begin(y, if turned { begin.turned(*frame) } else { begin })
        });
    }

    fn fired(&self, cursor: &Cursor<E, P>, y: &A::Output, t: Nanos) -> Option<Cause> {
        let own = self.rows.fsm.atoms.get(cursor.atom() as usize)?.scope;
        let mut level_of_own = None;
        // From inside out, and the last one found counts: so the outermost wins, however deep scopes are nested.
        let mut found = None;
        for (bracket, of) in self.rows.fsm.outwards(own) {
            let Kind::Scope { level } = of.kind else { continue };
            level_of_own = level_of_own.or(Some(level));
            if fired(self.rows.conditions, bracket, y, cursor.since(level, t)) {
                found = Some(Cause::Fired(level));
            }
        }
        found.or_else(|| {
            let done = self.running.as_ref().is_some_and(|law| law.completed(y, t));
            level_of_own.filter(|_| done).map(Cause::Completed)
        })
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
