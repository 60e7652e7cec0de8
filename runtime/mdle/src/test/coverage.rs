//! Counts of the atoms, transitions and operands that tests have reached.

use mdle_compiler::fsm::{Element, Machine};
use mdle_compiler::plan::Condition;
use mdle_host::Transitions;
use mdle_runtime::{Cause, Transition};

/// Parts of a plan that runs have reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Coverage {
    /// For each atom, the number of times that its law began.
    pub(super) began: Vec<u64>,
    /// For each atom, the number of times that it was skipped.
    pub(super) skipped: Vec<u64>,
    /// For each element, the number of times that its interrupt ended it.
    pub(super) fired: Vec<u64>,
    /// For each element, the number of times that it ended by the completion of its law.
    pub(super) completed: Vec<u64>,
    /// For each operand of each element's interrupt, the number of evaluations in which it was false, and the number in
    /// which it was true.
    pub(super) operands: Vec<Vec<[u64; 2]>>,
    /// For each element, `true` if each operand alone fires its interrupt. All operands are then false while the
    /// element runs.
    is_any: Vec<bool>,
    /// Number of the current atom; `None` before the plan begins, and once it is over.
    atom: Option<u32>,
    /// Buffer for the operands that have fired.
    fired_now: Vec<u32>,
}

impl Coverage {
    /// Returns the coverage before any run.
    pub(super) fn new(machine: &Machine) -> Self {
        let operands = |element: Element<'_>| {
            let parts = element.condition().joined().into_iter().filter(|part| **part != Condition::Null);
            vec![[0, 0]; parts.count()]
        };
        let elements = machine.elements().len();
        Self {
            began: vec![0; machine.atoms().len()],
            skipped: vec![0; machine.atoms().len()],
            fired: vec![0; elements],
            completed: vec![0; elements],
            operands: machine.elements().map(operands).collect(),
            is_any: machine.elements().map(|element| is_any(element.condition())).collect(),
            atom: None,
            fired_now: Vec::new(),
        }
    }

    /// Prepares the coverage for the next run.
    pub(super) fn begins(&mut self) {
        self.atom = None;
    }

    /// Counts a turn, after which `atom` is current. For an element that encloses that atom, `evaluate` calls its
    /// second argument with the number of each fired operand.
    pub(super) fn turn(
        &mut self,
        machine: &Machine,
        atom: Option<u32>,
        transitions: &Transitions,
        evaluate: impl Fn(u32, &mut dyn FnMut(u32)),
    ) {
        let is_first = self.atom.is_none();
        let mut entered = is_first.then(|| machine.root().first().number());
        for (transition, operands) in transitions.iter() {
            if let Some(skipped) = entered.and_then(|atom| self.skipped.get_mut(atom as usize)) {
                *skipped += 1;
            }
            self.transition(transition, operands.iter().map(|(number, _)| *number));
            entered = transition.atom;
        }
        if let Some(began) = entered.filter(|_| atom == entered).and_then(|atom| self.began.get_mut(atom as usize)) {
            *began += 1;
        }
        self.atom = atom;
        let Some(atom) = atom else { return };
        for element in machine.atom(atom).element().outwards() {
            self.lasts(element, &evaluate);
        }
    }

    fn transition(&mut self, transition: &Transition, operands: impl Iterator<Item = u32>) {
        let scope = transition.scope as usize;
        match transition.cause {
            Cause::Completed(_) => count(&mut self.completed, scope),
            Cause::Fired(_) => {
                count(&mut self.fired, scope);
                self.fired_now.clear();
                self.fired_now.extend(operands);
                self.evaluated(scope);
            }
        }
    }

    /// Counts the operands of an element that does not end.
    fn lasts(&mut self, element: Element<'_>, evaluate: &impl Fn(u32, &mut dyn FnMut(u32))) {
        let scope = element.index();
        if self.operands.get(scope).is_none_or(Vec::is_empty) {
            return;
        }
        self.fired_now.clear();
        if !self.is_any.get(scope).copied().unwrap_or(true) {
            let fired_now = &mut self.fired_now;
            evaluate(element.number(), &mut |number| fired_now.push(number));
        }
        self.evaluated(scope);
    }

    /// Counts an evaluation of the operands of an element, some of which have fired.
    fn evaluated(&mut self, scope: usize) {
        let Some(operands) = self.operands.get_mut(scope) else { return };
        for (number, [is_false, is_true]) in (0..).zip(operands) {
            *(if self.fired_now.contains(&number) { is_true } else { is_false }) += 1;
        }
    }

    /// Adds the counts of other runs of the plan.
    pub(super) fn add(&mut self, other: &Self) {
        let lists = [
            (&mut self.began, &other.began),
            (&mut self.skipped, &other.skipped),
            (&mut self.fired, &other.fired),
            (&mut self.completed, &other.completed),
        ];
        for (own, other) in lists {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
        for (own, other) in self.operands.iter_mut().flatten().zip(other.operands.iter().flatten()) {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
    }
}

fn count(counts: &mut [u64], number: usize) {
    if let Some(count) = counts.get_mut(number) {
        *count += 1;
    }
}

/// Returns `true` if each of the operands fires the condition by itself.
fn is_any(condition: &Condition) -> bool {
    match condition {
        Condition::Or(operands) => operands.iter().all(is_any),
        Condition::And(_) => condition.lasting().is_some(),
        Condition::Null
        | Condition::Quark(_)
        | Condition::Wait { .. }
        | Condition::Elapsed { .. }
        | Condition::Driven { .. }
        | Condition::Not(_)
        | Condition::Rising { .. }
        | Condition::After(_) => true,
    }
}
