//! How long a plan runs at most: as long as its timers say, whatever the robot senses and whatever its laws do.
//!
//! A timer is read once a turn, so each may be over as much later as the time from one turn to the next.

use mdle_runtime::TRANSITIONS_PER_TURN;
use mdle_runtime::fsm::Kind;

use super::transitions::Most;
use super::walk::{Found, Reach};
use crate::fsm::Machine;
use crate::plan::Condition;

/// The longest time of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Longest {
    /// No longer than these nanoseconds and so many times from one turn to the next.
    Bounded { nanos: u128, turns: u64 },
    /// As long as this bracket, an atom or a loop, goes on.
    Unbounded(u32),
}

impl Longest {
    const NONE: Self = Self::Bounded { nanos: 0, turns: 0 };

    /// This, and behind it that.
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

    /// So many passes of this, a loop of this bracket; 0 is for ever.
    fn times(self, times: u64, bracket: u32) -> Self {
        match self {
            Self::Bounded { .. } if times == 0 => Self::Unbounded(bracket),
            Self::Bounded { nanos, turns } => {
                Self::Bounded { nanos: nanos.saturating_mul(u128::from(times)), turns: turns.saturating_mul(times) }
            }
            Self::Unbounded(inside) => Self::Unbounded(inside),
        }
    }

    /// The shorter of both: each holds.
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

/// Adds up the longest times of all that is reached.
pub(super) fn longest(lowered: &Machine, found: &[Found], most: Most) -> Longest {
    let mut inside = vec![Longest::NONE; lowered.brackets.len()];
    // The last bracket first: so what is inside of one is known, and what stands behind it.
    for (place, bracket) in lowered.brackets.iter().enumerate().rev() {
        let number = u32::try_from(place).unwrap_or(u32::MAX);
        let is_atom = lowered.atoms.get(bracket.first as usize).is_some_and(|atom| atom.scope == number);
        let body = if is_atom { Longest::Unbounded(number) } else { inside[place] };
        let element = match (bracket.kind, &lowered.scopes[place]) {
            _ if found[place].reach != Reach::Runs => Longest::NONE,
            (Kind::Loop { times, .. }, _) => body.times(times, number),
            (Kind::Scope { .. }, scope) => {
                let fires = scope.as_ref().and_then(|scope| certain(&scope.interrupt.condition, true));
                let timer = fires.map(|nanos| Longest::Bounded { nanos: nanos.into(), turns: u64::from(nanos > 0) });
                timer.map_or(body, |timer| timer.or(body))
            }
        };
        if number == 0 {
            return searched(element, lowered, most);
        }
        let parent = bracket.parent as usize;
        inside[parent] = element.then(inside[parent]);
    }
    Longest::NONE
}

/// With the turns in which a search is cut: each has made as many transitions as a turn makes, and each transition leads to
/// another state.
fn searched(longest: Longest, lowered: &Machine, most: Most) -> Longest {
    match longest {
        Longest::Bounded { nanos, turns } if most.is_cut => {
            let cut = lowered.termination / u64::from(TRANSITIONS_PER_TURN);
            Longest::Bounded { nanos, turns: turns.saturating_add(cut) }
        }
        Longest::Bounded { .. } | Longest::Unbounded(_) => longest,
    }
}

/// The nanoseconds from which on a condition certainly has fired, or certainly has not.
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
