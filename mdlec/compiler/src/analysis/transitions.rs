//! Computes the maximum number of transitions in one turn (docs/src/reference/semantics.md, 5.5).
//!
//! All conditions of a turn read the same output at the same time. Therefore, if there are few interrupt quarks, the
//! transitions are counted for each choice of the quarks' values. Otherwise, the count assumes that a quark may have
//! another value each time it is read, and is an upper bound.

use std::collections::BTreeSet;

use mdle_runtime::TRANSITIONS_PER_TURN;

use super::choices::Choices;
use super::possible::possible;
use super::variables::Variable;
use crate::fsm::{ElementKind, Machine};
use crate::plan::families::Readings;
use crate::plan::{Condition, Interrupt, QuarkId};

/// Maximum number of transitions in one turn; not more than the machine allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Most {
    pub(super) count: u64,
    /// `true` if a search may need more transitions than one turn allows.
    pub(super) is_cut: bool,
}

/// Returns the maximum number of transitions in a turn of a machine.
pub(super) fn most(machine: &Machine) -> Most {
    /// Maximum number of quarks for which every choice is counted.
    const QUARKS: usize = 8;
    /// Maximum product of the number of brackets and the number of choices up to which every choice is counted.
    const WORK: usize = 2_000_000;
    let mut quarks: Vec<QuarkId> = Vec::new();
    for element in machine.elements() {
        element.condition().each_quark(&mut |id| {
            if !machine.quark(id).remembers && quarks.len() <= QUARKS && !quarks.contains(&id) {
                quarks.push(id);
            }
        });
    }
    if quarks.len() > QUARKS || machine.elements().len() << quarks.len() > WORK {
        quarks.clear();
    }
    // The bits of a choice are in the order of the variables.
    quarks.sort_unstable();
    let variables: BTreeSet<Variable> = quarks.iter().map(|id| Variable::Quark(*id)).collect();
    let possible =
        Choices::new(&variables, |_| None).map(|free| possible(&free, machine.quarks(), Readings::Any, &|_| 0));
    let is_possible = |choice: &usize| possible.as_ref().is_none_or(|possible| possible.holds(*choice));
    let choices = (0..1_usize << quarks.len()).filter(is_possible);
    let count = choices.map(|choice| longest(machine, &quarks, choice)).max().unwrap_or(0);
    let limit = u64::from(TRANSITIONS_PER_TURN);
    Most { count: count.min(limit), is_cut: count > limit }
}

/// Lengths of the longest chains of transitions that one turn can make within an element, or within consecutive
/// elements.
#[derive(Debug, Clone, Copy)]
struct Chains {
    /// Length of a chain from the beginning to the end; `None` if the element cannot be passed in one turn.
    pass: Option<u64>,
    /// Length of a chain from the beginning to a position inside.
    first: u64,
    /// Length of a chain from a position inside to the end; `None` if the element cannot end.
    last: Option<u64>,
    /// Length of a chain between any two positions inside.
    inside: u64,
}

impl Chains {
    const NONE: Self = Self { pass: Some(0), first: 0, last: None, inside: 0 };

    /// Returns the chains of `self` and then `next`.
    fn then(self, next: Self) -> Self {
        let last = plus(self.last, next.pass);
        let through = self.last.map_or(0, |last| last.saturating_add(next.first));
        Self {
            pass: plus(self.pass, next.pass),
            first: self.first.max(self.pass.map_or(0, |pass| pass.saturating_add(next.first))),
            last: last.max(next.last),
            inside: self.inside.max(next.inside).max(through),
        }
    }

    /// Returns the chains of a loop with `times` passes, where `self` contains the chains of one pass; 0 passes mean an
    /// endless loop.
    fn times(self, times: u64) -> Self {
        let through = |passes: u64| self.pass.map_or(0, |pass| pass.saturating_mul(passes));
        let again = |passes: u64| self.last.map_or(0, |last| last.saturating_add(through(passes)));
        match times {
            1 => self,
            0 if self.pass.is_some_and(|pass| pass > 0) => {
                Self { pass: None, first: u64::MAX, last: None, inside: u64::MAX }
            }
            0 => Self { pass: None, last: None, inside: self.inside.max(again(0).saturating_add(self.first)), ..self },
            _ => Self {
                pass: self.pass.map(|pass| pass.saturating_mul(times)),
                first: self.first.max(through(times - 1).saturating_add(self.first)),
                last: self.last.map(|last| last.saturating_add(through(times - 1))),
                inside: self.inside.max(again(times - 2).saturating_add(self.first)),
            },
        }
    }

    /// Returns the chains of a scope that contains elements with the chains `self`. `at_once` is the certainty that the
    /// scope's interrupt has fired in the turn of entry, and `later` the certainty in any turn; `asks_after` is `true`
    /// if the interrupt contains `after`.
    fn within(self, at_once: Certainty, later: Certainty, asks_after: bool) -> Self {
        let one = |certainty: Certainty| certainty.can.then_some(1);
        if at_once.must {
            let inside = if later.must { 1 } else { self.inside.max(1) };
            return Self { pass: Some(1), first: 0, last: Some(1), inside };
        }
        // An element that `after` tests may have ended earlier in this turn.
        let [first, inside] = [self.first, self.inside].map(|count| if asks_after { count } else { 0 });
        let pass =
            self.pass.max(if asks_after { one(later).map(|one: u64| first.saturating_add(one)) } else { one(at_once) });
        let last = self.last.max(one(later).map(|one| inside.saturating_add(one)));
        let last = if later.must { Some(1) } else { last };
        Self { pass, first: self.first, last, inside: self.inside.max(last.unwrap_or(0)) }
    }
}

fn plus(one: Option<u64>, other: Option<u64>) -> Option<u64> {
    Some(one?.saturating_add(other?))
}

/// Returns the length of the longest chain of transitions, assuming that the quarks have the values in the bits of
/// `choice`.
fn longest(machine: &Machine, quarks: &[QuarkId], choice: usize) -> u64 {
    let mut inside = vec![Chains::NONE; machine.elements().len()];
    // The last element first: then the elements inside and after an element are known.
    for element in machine.elements().rev() {
        let body = match element.kind() {
            ElementKind::Loop { times } => inside[element.index()].times(times.unwrap_or(0)),
            ElementKind::Scope => inside[element.index()],
            ElementKind::Atom(atom) => {
                let done = atom.law().completes.then_some(1);
                Chains { pass: done, last: done, ..Chains::NONE }
            }
        };
        let chains = element.interrupt().map_or(body, |Interrupt { condition, .. }| {
            let read = |is_entered| certainty(condition, quarks, choice, is_entered);
            let asks_after = condition.any(&|part| matches!(part, Condition::After(_)));
            body.within(read(true), read(false), asks_after)
        });
        let Some(parent) = element.parent() else {
            return chains.inside.max(chains.first).max(chains.pass.unwrap_or(0)).max(chains.last.unwrap_or(0));
        };
        inside[parent.index()] = chains.then(inside[parent.index()]);
    }
    0
}

/// Tells whether an event is possible, and whether it is certain.
#[derive(Debug, Clone, Copy)]
struct Certainty {
    can: bool,
    must: bool,
}

/// Returns the certainty that a condition has fired: if `entered` is `true`, in the turn in which its scope is entered;
/// otherwise, in any turn.
fn certainty(condition: &Condition, quarks: &[QuarkId], choice: usize, entered: bool) -> Certainty {
    let known = |value| Certainty { can: value, must: value };
    let unknown = Certainty { can: true, must: false };
    let inside = |operand| certainty(operand, quarks, choice, entered);
    let timer = |nanos: u64| {
        if nanos == 0 {
            known(true)
        } else if entered {
            known(false)
        } else {
            unknown
        }
    };
    let not = |Certainty { can, must }| Certainty { can: !must, must: !can };
    match condition {
        Condition::Null => known(false),
        Condition::Quark(id) => {
            quarks.iter().position(|quark| quark == id).map_or(unknown, |bit| known(choice >> bit & 1 == 1))
        }
        Condition::Wait { nanos, .. } => timer(*nanos),
        // At the entry of a scope, its path has length zero, just as its timer is at zero.
        Condition::Elapsed { from, until, .. } | Condition::Driven { from, until, .. } => {
            let (from, until) = (timer(*from), until.map_or(known(true), |until| not(timer(until))));
            Certainty { can: from.can && until.can, must: from.must && until.must }
        }
        Condition::Or(operands) => operands
            .iter()
            .map(inside)
            .fold(known(false), |one, other| Certainty { can: one.can || other.can, must: one.must || other.must }),
        Condition::And(operands) => operands
            .iter()
            .map(inside)
            .fold(known(true), |one, other| Certainty { can: one.can && other.can, must: one.must && other.must }),
        Condition::Not(operand) => not(inside(operand)),
        Condition::Rising { .. } if entered => known(false),
        Condition::Rising { operand, .. } => Certainty { can: inside(operand).can, must: false },
        Condition::After(_) => unknown,
    }
}
