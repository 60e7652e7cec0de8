//! Theorem 1 in both directions (paper, Theorem 1; docs/src/reference/semantics.md, 8.5): the MDLe string of a machine,
//! or the reasons why none exists.
//!
//! In a string that is found, the places of the states count from 0, the termination state has the last, and runs and
//! loops are pairwise nested or disjoint.

mod augment;
mod beginning;
mod conditions;
mod loop_free;
mod loops;
mod names;
mod order;
mod printed;
mod read;
mod string;

pub use augment::augment;
pub use conditions::{Broken, Stretch};

pub use printed::{Rule, as_printed, monomial};
pub use read::{FileError, read};
pub use string::string;

/// Default limit of steps in the search among orders: a few seconds.
pub const STEPS: u64 = 1_000_000;

/// Name of the interrupt that a law raises when it completes, which is not written in a plan.
const COMPLETED: &str = "completed";

/// A state of a machine, by its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct State(pub u32);

/// An interrupt of a machine, by its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct InterruptId(pub u32);

/// A machine as in an FSM file: its last state is the termination state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    states: Vec<String>,
    laws: Option<Vec<String>>,
    start: Option<State>,
    interrupts: Vec<Named>,
    exits: Vec<Vec<Exit>>,
}

/// Name of an interrupt, with the text of its condition if the file has one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Name of the interrupt.
    pub name: String,
    /// Condition of the interrupt, if the file has one.
    pub text: Option<String>,
}

/// A transition out of a state: an interrupt with its destination.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit {
    /// The interrupt.
    pub interrupt: InterruptId,
    /// Destination; it can be the same state, which is then entered again.
    pub to: State,
}

/// Result of applying the theorem to a machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// The machine has this string.
    String(Found),
    /// The machine has no string, for all these reasons.
    None(Vec<Broken>),
    /// The search among the orders of its states stopped after this number of steps.
    Stopped(u64),
}

/// A string: an order of the states, with the scopes and loops that enclose them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The states by their places, the termination state last.
    pub order: Vec<State>,
    /// The scopes.
    pub runs: Vec<Run>,
    /// The endless loops.
    pub loops: Vec<Loop>,
}

/// A scope: an interrupt, and the neighbouring places from which it leads to one place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The interrupt.
    pub interrupt: InterruptId,
    /// First place of the range, in the order of the states.
    pub first: usize,
    /// Last place of the range, in the order of the states.
    pub last: usize,
    /// The place to which it leads: after the last one, or the start of a loop.
    pub to: usize,
}

/// An endless loop, as the places that it encloses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loop {
    /// First place of the range, in the order of the states.
    pub first: usize,
    /// Last place of the range, in the order of the states.
    pub last: usize,
}

impl Machine {
    /// Builds a machine with these states and, for each interrupt, its moves from state to state, at most one per
    /// state. Moves of unknown states are left out.
    #[must_use]
    pub fn new(states: Vec<String>, interrupts: Vec<(Named, Vec<(State, State)>)>) -> Self {
        let mut exits = vec![Vec::new(); states.len()];
        let mut named = Vec::with_capacity(interrupts.len());
        for (interrupt, (name, moves)) in (0..).map(InterruptId).zip(interrupts) {
            for (from, to) in moves.into_iter().filter(|(_, to)| (to.0 as usize) < states.len()) {
                if let Some(exits) = exits.get_mut(from.0 as usize) {
                    exits.push(Exit { interrupt, to });
                }
            }
            named.push(name);
        }
        Self { states, laws: None, start: None, interrupts: named, exits }
    }

    /// Sets the state that must be the first.
    #[must_use]
    pub fn starting(self, start: State) -> Self {
        Self { start: Some(start), ..self }
    }

    /// The names of the states.
    #[must_use]
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// The interrupts.
    #[must_use]
    pub fn interrupts(&self) -> &[Named] {
        &self.interrupts
    }

    /// Transitions out of a state, in the order of the file.
    #[must_use]
    pub fn exits(&self, state: State) -> &[Exit] {
        &self.exits[state.0 as usize]
    }

    /// The state that the file names as the first.
    #[must_use]
    pub fn start(&self) -> Option<State> {
        self.start
    }

    /// The termination state.
    #[must_use]
    pub fn end(&self) -> State {
        State(number(self.states.len().saturating_sub(1)))
    }

    /// State to which an interrupt leads from the state `from`, if it leads anywhere.
    fn destination(&self, from: State, interrupt: InterruptId) -> Option<State> {
        let exits = self.exits(from);
        let place = exits.binary_search_by_key(&interrupt, |exit| exit.interrupt).ok()?;
        exits.get(place).map(|exit| exit.to)
    }

    /// All states except the termination state.
    fn atoms(&self) -> impl DoubleEndedIterator<Item = State> {
        (0..self.end().0).map(State)
    }

    /// The interrupt of laws that complete.
    fn completed(&self) -> Option<InterruptId> {
        let place = self.interrupts.iter().position(|interrupt| interrupt.name == COMPLETED)?;
        Some(InterruptId(number(place)))
    }

    fn name(&self, state: State) -> &str {
        &self.states[state.0 as usize]
    }

    fn interrupt(&self, interrupt: InterruptId) -> &Named {
        &self.interrupts[interrupt.0 as usize]
    }
}

/// Converts an index to a number; no file that can be read has more entries.
fn number(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}

/// Finds the string of a machine, if one exists. A machine without a cycle is decided at once, any other by a search of
/// at most `steps` steps.
#[must_use]
pub fn decompile(machine: &Machine, steps: u64) -> Answer {
    let broken = conditions::of_every_order(machine);
    if !broken.is_empty() {
        return Answer::None(broken);
    }
    let order = order::forwards(machine);
    if !order::leads_forwards(machine, &order) {
        return loops::search(machine, &order, steps);
    }
    match loop_free::runs(machine, &order) {
        Ok(runs) => Answer::String(Found { order, runs, loops: Vec::new() }),
        Err(broken) => Answer::None(broken),
    }
}
