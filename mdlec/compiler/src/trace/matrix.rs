//! The machine `matrix`: computes an execution as a product of transition matrices, as in the paper (Eq. 4;
//! docs/src/reference/semantics.md, 8.4 and 9). It is the oracle for the machines that robots run, and shares no
//! stepping code with them.
//!
//! The factors of the product `E_i(tm) … E_i(t2) E_i(t1)` are the matrices of the interrupts that have fired, in order.
//! Only the column of the first state is computed: `e(t)` is the product applied to `e(0)`. The matrices do not express
//! which scopes restart when a state is entered.

use std::collections::BTreeSet;

use mdle_runtime::{Frame, TRANSITIONS_PER_TURN};

use super::{COMPLETED, EntryTime, Fired, Machine, Reports, ScriptedInput, TurnResult};
use crate::diagnostic::Diagnostic;
use crate::fsm::{Matrices, Transition, UnitVector, matrices};
use crate::plan::{Nondegenerate, Plan, Quark, QuarkId, RecordId, Situation};

/// The transition matrices of a plan, and the vector to which they are applied.
#[derive(Debug)]
pub struct MatrixProduct<'p> {
    plan: &'p Plan,
    matrices: Matrices<'p>,
    /// For each column, the indices of the interrupts that list it; the outermost comes first.
    listing: Vec<Vec<u32>>,
    /// For each interrupt, the time at which its scope was entered.
    entered: Vec<EntryTime>,
    /// Memories of RISING that are set. Each is given by the index of its interrupt and its index in that interrupt.
    risen: BTreeSet<(usize, u32)>,
    /// Facts that are true in the records of the elements that ended last.
    facts: BTreeSet<(RecordId, u32)>,
    /// The product so far, applied to the first state.
    e: UnitVector,
    /// `true` once the first turn has begun.
    has_begun: bool,
}

/// The next factor of the product: the matrix of the interrupt that has fired or, if the law has completed, of the
/// atom's own interrupt.
struct Factor<'p> {
    number: usize,
    /// Text of the interrupt, as the trace shows it.
    by: &'p str,
    /// Texts of the interrupt's operands that have fired.
    operands: Vec<String>,
    /// Number of the operand that was the cause; `None` if the law has completed.
    operand: Option<u32>,
}

/// Data for evaluating an interrupt's condition: the state of the product, and the reports of the turn.
struct ProductSituation<'t, 'p> {
    product: &'t MatrixProduct<'p>,
    number: usize,
    y: &'t Reports,
}

impl Situation for ProductSituation<'_, '_> {
    fn quark(&self, quark: QuarkId) -> bool {
        self.y.fired.contains(&self.product.plan.quark(quark).text)
    }

    fn waited(&self, nanos: u64) -> bool {
        self.product.entered[self.number].waited(nanos, self.y)
    }

    fn driven(&self, nanometers: u64) -> bool {
        self.product.entered[self.number].driven(nanometers, self.y)
    }

    fn remembers(&self, memory: u32) -> bool {
        self.product.risen.contains(&(self.number, memory))
    }

    fn recorded(&self, record: RecordId, fact: u32) -> bool {
        self.product.facts.contains(&(record, fact))
    }
}

impl<'p> MatrixProduct<'p> {
    /// Creates the empty product, before the first turn.
    ///
    /// # Errors
    /// Fails with E0501 or E0502 for a plan with too many states.
    pub fn new(plan: &'p Nondegenerate) -> Result<Self, Diagnostic> {
        let matrices = matrices(plan)?;
        let mut listing = vec![Vec::new(); matrices.laws.len() + 1];
        for (number, Transition { matrix, .. }) in (0..).zip(&matrices.transitions) {
            matrix.columns().for_each(|column| listing[column].push(number));
        }
        let entered = vec![EntryTime::default(); matrices.transitions.len()];
        let (risen, facts, e) = (BTreeSet::new(), BTreeSet::new(), UnitVector { row: 0 });
        Ok(Self { plan: plan.plan(), matrices, listing, entered, risen, facts, e, has_begun: false })
    }

    /// Returns the indices of the interrupts whose matrices list the column of the current state.
    fn listed(&self) -> impl DoubleEndedIterator<Item = usize> + use<'_, 'p> {
        self.listing[self.e.row].iter().map(|number| *number as usize)
    }

    /// Returns the fired interrupt with the lowest index, or else the completion of the current atom's law; `None` if
    /// neither has happened.
    fn fired(&self, y: &Reports) -> Option<Factor<'p>> {
        for number in self.listed() {
            let (interrupt, at) =
                (self.matrices.transitions[number].interrupt, ProductSituation { product: self, number, y });
            if interrupt.condition.fired(&at) {
                let operands = self.plan.operands_fired(interrupt, &at);
                return Some(Factor {
                    number,
                    by: &interrupt.text,
                    operands,
                    operand: Some(interrupt.condition.cause(&at)),
                });
            }
        }
        let law = self.law()?;
        let done = law.completes && y.completed.contains(&law.text);
        let own = self.listed().next_back().filter(|_| done);
        own.map(|number| Factor { number, by: COMPLETED, operands: Vec::new(), operand: None })
    }

    /// Returns the law of the state; `None` when the plan has ended.
    fn law(&self) -> Option<&'p Quark> {
        self.matrices.laws.iter().copied().nth(self.e.row).map(|law| self.plan.quark(law))
    }

    /// Returns the frame of the law, if an enclosing scope has `FRAME here`. Among several such scopes, the innermost
    /// one has the highest number.
    fn frame(&self) -> Option<Frame> {
        let turned = self.matrices.frames.get(self.e.row)?;
        let anew = self.listed().rev().find(|number| self.matrices.transitions[*number].here)?;
        Some(self.entered[anew].frame(*turned))
    }

    /// Multiplies the product by the matrix of this interrupt.
    fn multiply(&mut self, number: usize, operand: Option<u32>, now: EntryTime) {
        let Transition { matrix, afresh, marks, ends_with, .. } = &self.matrices.transitions[number];
        let own = marks.iter().map(|mark| (mark, operand));
        let ended: Vec<_> = own.chain(ends_with.iter().map(|mark| (*mark, None))).collect();
        self.facts.retain(|(record, _)| ended.iter().all(|(mark, _)| mark.record != *record));
        for (mark, operand) in ended {
            let facts = mark.facts.iter().filter(|fact| fact.holds(operand));
            self.facts.extend(facts.map(|fact| (mark.record, fact.number)));
        }
        self.e = matrix * self.e;
        let afresh = self.listing[self.e.row].iter().map(|number| *number as usize).filter(|number| number >= afresh);
        for number in afresh {
            self.entered[number] = now;
            self.risen.retain(|(interrupt, _)| *interrupt != number);
            if let Some(kept) = self.matrices.transitions[number].record {
                self.facts.retain(|(record, _)| *record != kept.id);
            }
        }
    }

    /// Sets the memory of each RISING whose operand is false, for all interrupts that list the column of the current
    /// state.
    fn settle(&mut self, y: &Reports) {
        let mut set = Vec::new();
        for number in self.listed() {
            let at = ProductSituation { product: self, number, y };
            self.matrices.transitions[number].interrupt.condition.each_rising(&mut |memory, operand| {
                if !operand.fired(&at) {
                    set.push((number, memory));
                }
            });
        }
        self.risen.extend(set);
    }

    /// Returns the number of the state, counted from 1.
    fn state(&self) -> u64 {
        self.e.row as u64 + 1
    }
}

impl<'p> Machine<'p> for MatrixProduct<'p> {
    fn turn(&mut self, y: &Reports) -> TurnResult<'p> {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.entered.fill(y.moment());
        }
        let mut fired = Vec::new();
        while let Some(Factor { number, by, operands, operand }) = self.fired(y) {
            if fired.len() == TRANSITIONS_PER_TURN as usize {
                self.settle(y);
                return TurnResult { state: self.state(), applied: ScriptedInput::Cut, frame: None, fired };
            }
            fired.push(Fired { from: self.state(), level: self.matrices.transitions[number].level, by, operands });
            self.multiply(number, operand, y.moment());
        }
        self.settle(y);
        let applied = self.law().map_or(ScriptedInput::Over, |law| ScriptedInput::Law(&law.text));
        TurnResult { state: self.state(), applied, frame: self.frame(), fired }
    }
}
