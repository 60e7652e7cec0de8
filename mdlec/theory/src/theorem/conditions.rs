//! Describes in sentences the conditions of Theorem 1 that a machine breaks (docs/src/reference/semantics.md, 8.5: R1
//! to R4).

use std::fmt::Write;

use mdle_runtime::Printable;

use super::{InterruptId, Machine, State};

/// A range of consecutive states in an order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stretch {
    /// First state of the range.
    pub first: State,
    /// Last state of the range.
    pub last: State,
}

/// A condition that a machine breaks, with the states and interrupts that break it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Broken {
    /// An interrupt leads from the termination state to another state; contains the interrupt.
    EndIsLeft(InterruptId),
    /// No interrupt leads from this state to another state.
    NoExit(State),
    /// The only possible order begins with a state other than the start state in the file.
    StartNotFirst {
        /// Start state in the file.
        start: State,
        /// First state of the order.
        first: State,
    },
    /// Two states must be neighbours, but the first state does not lead to the second.
    SideBySide(State, State),
    /// A state has no interrupt of its own that leads to the next state.
    NoOwnInterrupt {
        /// State without an interrupt of its own.
        state: State,
        /// Next state in the order.
        next: State,
        /// An interrupt that leads to the next state both from `state` and from the state before it, together with this
        /// earlier state; `None` if there is no such interrupt.
        shared: Option<(InterruptId, State)>,
    },
    /// An interrupt leads past a state, but does not lead from that state to the same destination.
    Skips {
        /// Interrupt that leads past the state.
        interrupt: InterruptId,
        /// State from which the interrupt leads.
        from: State,
        /// State to which the interrupt leads.
        to: State,
        /// State between `from` and `to`.
        past: State,
        /// State to which the interrupt leads from `past`, `None` if it leads nowhere from there.
        other: Option<State>,
    },
    /// The ranges of states that two interrupts enclose overlap, and neither range contains the other.
    Crosses {
        /// Interrupt whose range begins first.
        interrupt: InterruptId,
        /// Range of states that this interrupt encloses.
        around: Stretch,
        /// Interrupt whose range begins later.
        other: InterruptId,
        /// First state that the interrupt `other` encloses.
        begins: State,
        /// A state after the range `around` that the interrupt `other` also encloses.
        goes_on: State,
    },
    /// An interrupt leads into the middle of the range that a scope or a loop encloses.
    IntoTheMiddle {
        /// Interrupt that leads into the range.
        interrupt: InterruptId,
        /// State from which the interrupt leads.
        from: State,
        /// State to which the interrupt leads.
        to: State,
        /// Range into whose middle the interrupt leads.
        whole: Stretch,
    },
    /// An interrupt must lead back to the first state of an enclosing loop, but leads to another state.
    PastALoop {
        /// Interrupt that leads to another state.
        interrupt: InterruptId,
        /// States that the interrupt encloses.
        around: Stretch,
        /// State to which the interrupt leads.
        to: State,
        /// First state of the enclosing loop.
        begins: State,
    },
    /// No order of the states satisfies the theorem. The fields describe the longest prefix of an order that was found,
    /// and why no state can follow it.
    NoOrder {
        /// States of the longest prefix, in order.
        begins: Vec<State>,
        /// States that might follow, each with the condition that it breaks.
        tries: Vec<(State, Broken)>,
        /// Number of further states that might follow but are not in `tries`.
        more: usize,
    },
}

/// Maximum number of states of an order that a sentence names; the last states are named.
const NAMED: usize = 6;

/// Returns the conditions that a machine breaks in every order of its states.
pub(super) fn of_every_order(machine: &Machine) -> Vec<Broken> {
    let left = machine.exits(machine.end()).iter().map(|exit| Broken::EndIsLeft(exit.interrupt));
    let stays = machine.atoms().filter(|state| machine.exits(*state).is_empty()).map(Broken::NoExit);
    left.chain(stays).collect()
}

impl Broken {
    /// Returns a sentence that describes the broken condition and begins with the name of the condition.
    #[must_use]
    pub fn sentence(&self, machine: &Machine) -> String {
        let state = |state: State| quoted(machine.name(state));
        let named = |interrupt: InterruptId| quoted(&machine.interrupt(interrupt).name);
        let stretch = |Stretch { first, last }: Stretch| match first == last {
            true => state(first),
            false => format!("{} to {}", state(first), state(last)),
        };
        match self {
            Self::EndIsLeft(interrupt) => format!(
                "R2: {} leads on from {}, the last state, in which the plan is over",
                named(*interrupt),
                state(machine.end())
            ),
            Self::NoExit(stays) => {
                format!("R1: no interrupt leads on from {}, and an atom of a string has one of its own", state(*stays))
            }
            Self::StartNotFirst { start, first } => {
                format!("R1: {} is to be the first, but all leads forwards only if {} is", state(*start), state(*first))
            }
            Self::SideBySide(one, other) => format!(
                "R1: {} and {} would have to stand side by side, but no interrupt leads from one of them to the other",
                state(*one),
                state(*other)
            ),
            Self::NoOwnInterrupt { state: of, next, shared } => {
                let why = match shared {
                    Some((interrupt, before)) => {
                        format!("{} leads there, but from {} as well", named(*interrupt), state(*before))
                    }
                    None => format!("and {} would have to follow", state(*next)),
                };
                format!("R1: {} has no interrupt that leads on from it alone: {why}", state(*of))
            }
            Self::Skips { interrupt, from, to, past, other } => {
                let wrong = match other {
                    Some(other) => format!("leads from there to {}", state(*other)),
                    None => "does not lead on from there".to_owned(),
                };
                format!(
                    "R2: {} leads from {} to {}, past {}, but it {wrong}",
                    named(*interrupt),
                    state(*from),
                    state(*to),
                    state(*past)
                )
            }
            Self::Crosses { interrupt, around, other, begins, goes_on } => format!(
                "R3: {} encloses {}, and {} only a part of that, from {} on, and {} besides: neither is inside the other",
                named(*interrupt),
                stretch(*around),
                named(*other),
                state(*begins),
                state(*goes_on)
            ),
            Self::IntoTheMiddle { interrupt, from, to, whole } => format!(
                "R4: {} leads back from {} to {}, into the middle of {}, which is enclosed as a whole",
                named(*interrupt),
                state(*from),
                state(*to),
                stretch(*whole)
            ),
            Self::PastALoop { interrupt, around, to, begins } => format!(
                "R4: {}, around {}, would have to lead back to {}, where a loop around it begins, and leads to {}",
                named(*interrupt),
                stretch(*around),
                state(*begins),
                state(*to)
            ),
            Self::NoOrder { begins, tries, more } => {
                let mut text = match begins.as_slice() {
                    [] => "no order of the states fits; no state can be the first".to_owned(),
                    begins => {
                        let shown = &begins[begins.len().saturating_sub(NAMED)..];
                        let names: Vec<_> = shown.iter().map(|named| state(*named)).collect();
                        let cut = if shown.len() < begins.len() { "… " } else { "" };
                        format!(
                            "no order of the states fits; the one that gets furthest begins {cut}{}",
                            names.join(", ")
                        )
                    }
                };
                for (next, broken) in tries {
                    // The conditions of `tries` are never `NoOrder` themselves.
                    let _ = write!(text, "\n    then {}? {}", state(*next), broken.sentence(machine));
                }
                if *more > 0 {
                    let _ = write!(text, "\n    … and {more} more");
                }
                text
            }
        }
    }
}

/// Returns a name in quotes for a sentence.
fn quoted(name: &str) -> String {
    format!("`{}`", Printable(name))
}
