//! Computes an upper bound of a plan's duration from its timers, regardless of the robot's sensors and of the
//! completion of laws.
//!
//! A timer is read once per turn, so each timer can end later by up to the time between two turns.

use mdle_runtime::TRANSITIONS_PER_TURN;

use super::transitions::Most;
use super::walk::{BracketFacts, Reach};
use crate::fsm::{ElementKind, Machine};
use crate::plan::Condition;

/// Maximum duration of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Longest {
    /// The duration is at most `nanos` nanoseconds plus `turns` periods of a turn.
    Bounded { nanos: u128, turns: u64 },
    /// There is no bound, because this bracket, an atom or a loop, may continue forever.
    Unbounded(u32),
}

impl Longest {
    const NONE: Self = Self::Bounded { nanos: 0, turns: 0 };

    /// Returns the total duration of `self` and then `next`.
    fn then(self, next: Self) -> Self {
        match (self, next) {
            (Self::Bounded { nanos, turns }, Self::Bounded { nanos: more, turns: further }) => {
                Self::Bounded { nanos: nanos.saturating_add(more), turns: turns.saturating_add(further) }
            }
            (Self::Bounded { .. }, Self::Unbounded(bracket)) | (Self::Unbounded(bracket), _) => {
                Self::Unbounded(bracket)
            }
        }
    }

    /// Returns the duration of a loop with `times` passes, where `self` is the duration of one pass; 0 passes mean an
    /// endless loop. `bracket` is the number of the loop's bracket.
    fn times(self, times: u64, bracket: u32) -> Self {
        match self {
            Self::Bounded { .. } if times == 0 => Self::Unbounded(bracket),
            Self::Bounded { nanos, turns } => {
                Self::Bounded { nanos: nanos.saturating_mul(u128::from(times)), turns: turns.saturating_mul(times) }
            }
            Self::Unbounded(inside) => Self::Unbounded(inside),
        }
    }

    /// Returns the shorter of two upper bounds of the same duration.
    fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Bounded { nanos, turns }, Self::Bounded { nanos: more, turns: further }) => {
                if (more, further) < (nanos, turns) { other } else { self }
            }
            (Self::Bounded { .. }, Self::Unbounded(_)) => self,
            (Self::Unbounded(_), _) => other,
        }
    }
}

/// Returns the upper bound of the plan's duration, which is the sum of the bounds of all elements that run.
pub(super) fn longest(machine: &Machine, found: &[BracketFacts], most: Most) -> Longest {
    let mut inside = vec![Longest::NONE; machine.elements().len()];
    // The last element first: then the elements inside and after an element are known.
    for (element, found) in machine.elements().zip(found).rev() {
        let number = element.number();
        let body = match element.kind() {
            ElementKind::Atom(_) => Longest::Unbounded(number),
            ElementKind::Scope => inside[element.index()],
            ElementKind::Loop { times } => inside[element.index()].times(times.unwrap_or(0), number),
        };
        // A loop has no interrupt that could end it earlier.
        let element_takes = if found.reach == Reach::Runs {
            let fires = certain(element.condition(), true);
            let timer = fires.map(|nanos| Longest::Bounded { nanos: nanos.into(), turns: u64::from(nanos > 0) });
            timer.map_or(body, |timer| timer.or(body))
        } else {
            Longest::NONE
        };
        let Some(parent) = element.parent() else { return searched(element_takes, machine, most) };
        inside[parent.index()] = element_takes.then(inside[parent.index()]);
    }
    Longest::NONE
}

/// Adds to `longest` the turns in which a search for the next atom stops at the limit of transitions in a turn. Each
/// such turn makes the maximum number of transitions, and each transition leads to another state.
fn searched(longest: Longest, machine: &Machine, most: Most) -> Longest {
    match longest {
        Longest::Bounded { nanos, turns } if most.is_cut => {
            let cut = machine.states() / u64::from(TRANSITIONS_PER_TURN);
            Longest::Bounded { nanos, turns: turns.saturating_add(cut) }
        }
        Longest::Bounded { .. } | Longest::Unbounded(_) => longest,
    }
}

/// Returns the time, in nanoseconds, after which a condition has certainly fired (`fired` is `true`) or has certainly
/// not fired (`fired` is `false`); `None` if no such time is known.
fn certain(condition: &Condition, fired: bool) -> Option<u64> {
    let any = |operands: &[Condition]| operands.iter().filter_map(|operand| certain(operand, fired)).min();
    let all = |operands: &[Condition]| {
        operands.iter().map(|operand| certain(operand, fired)).try_fold(0, |most, one| Some(one?.max(most)))
    };
    match condition {
        Condition::Null => (!fired).then_some(0),
        Condition::Quark(_) | Condition::Driven { .. } | Condition::After(_) => None,
        Condition::Wait { nanos, .. } => fired.then_some(*nanos),
        Condition::Elapsed { from, until: None, .. } => fired.then_some(*from),
        Condition::Elapsed { until: Some(until), .. } => (!fired).then_some(*until),
        Condition::Or(operands) if fired => any(operands),
        Condition::Or(operands) => all(operands),
        Condition::And(operands) if fired => all(operands),
        Condition::And(operands) => any(operands),
        Condition::Not(operand) => certain(operand, !fired),
        Condition::Rising { operand, .. } => certain(operand, false).filter(|_| !fired),
    }
}
