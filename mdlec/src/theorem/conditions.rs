//! The conditions of Theorem 1 that a machine breaks (docs/src/reference/semantics.md, 8.5: R1 to R4), each in a
//! sentence.

use std::fmt::Write;

use mdle_runtime::Printable;

use super::{InterruptId, Machine, State};

/// Neighbouring states of an order: the first and the last of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stretch {
    /// The first.
    pub first: State,
    /// The last.
    pub last: State,
}

/// A condition that fails, with what breaks it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Broken {
    /// An interrupt leads on from the termination state.
    EndIsLeft(InterruptId),
    /// Nothing leads on from a state.
    NoExit(State),
    /// The first state of the only order is not the one that the file names.
    StartNotFirst {
        /// The named one.
        start: State,
        /// The first of the order.
        first: State,
    },
    /// Of two states that would have to be neighbours, neither leads to the other.
    SideBySide(State, State),
    /// A state has no interrupt of its own that leads to the next.
    NoOwnInterrupt {
        /// The state.
        state: State,
        /// The one that follows.
        next: State,
        /// An interrupt that leads there, but from the state before as well, which is named.
        shared: Option<(InterruptId, State)>,
    },
    /// An interrupt leads past a state that it does not take along.
    Skips {
        /// The interrupt.
        interrupt: InterruptId,
        /// The state from which it leads.
        from: State,
        /// The state to which it leads.
        to: State,
        /// The state between them.
        past: State,
        /// Where it leads from there, if anywhere.
        other: Option<State>,
    },
    /// What two interrupts enclose overlaps, and neither holds the other.
    Crosses {
        /// The one that begins first.
        interrupt: InterruptId,
        /// What it encloses.
        around: Stretch,
        /// The other.
        other: InterruptId,
        /// The first state that the other encloses.
        begins: State,
        /// A state beyond the first one's, which the other encloses too.
        goes_on: State,
    },
    /// An interrupt leads into the middle of what has ended.
    IntoTheMiddle {
        /// The interrupt.
        interrupt: InterruptId,
        /// The state from which it leads.
        from: State,
        /// The state to which it leads.
        to: State,
        /// What ended as a whole.
        whole: Stretch,
    },
    /// An interrupt would have to lead past the beginning of a loop that ends with it.
    PastALoop {
        /// The interrupt.
        interrupt: InterruptId,
        /// What it encloses.
        around: Stretch,
        /// The state to which it leads.
        to: State,
        /// Where the loop begins.
        begins: State,
    },
    /// No order of the states is without a fault: how the one that gets furthest begins, and why nothing can follow.
    NoOrder {
        /// Its states.
        begins: Vec<State>,
        /// What might follow, and what that breaks.
        tries: Vec<(State, Broken)>,
        /// How many more there are.
        more: usize,
    },
}

/// So many states of an order are named, from its end.
const NAMED: usize = 6;

/// What a machine breaks whatever the order of its states.
pub(super) fn of_every_order(machine: &Machine) -> Vec<Broken> {
    let left = machine.exits(machine.end()).iter().map(|exit| Broken::EndIsLeft(exit.interrupt));
    let stays = machine.atoms().filter(|state| machine.exits(*state).is_empty()).map(Broken::NoExit);
    left.chain(stays).collect()
}

impl Broken {
    /// Says it, the condition's name first.
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
                    // Its tries are never orders themselves.
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

/// A name in a sentence.
fn quoted(name: &str) -> String {
    format!("`{}`", Printable(name))
}
