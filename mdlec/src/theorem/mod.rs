//! Theorem 1 both ways (paper, Theorem 1; docs/src/reference/semantics.md, 8.5): the MDLe string of a machine, or why
//! there is none.
//!
//! Afterwards: in what is found, the places of the states count from 0, the termination state has the last, and runs and loops
//! are pairwise nested or disjoint.

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

/// How many steps the search among orders makes unless it is told otherwise: a few seconds.
pub const STEPS: u64 = 1_000_000;

/// The interrupt that laws raise when they are done: a plan has it without writing it.
const COMPLETED: &str = "completed";

/// A state of a machine, by its place in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct State(pub u32);

/// An interrupt of a machine, by its place in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct InterruptId(pub u32);

/// A machine as an FSM file has it: its last state is the termination state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    states: Vec<String>,
    laws: Option<Vec<String>>,
    start: Option<State>,
    interrupts: Vec<Named>,
    exits: Vec<Vec<Exit>>,
}

/// What an interrupt is called, and the text of its condition where the file has it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// Its condition.
    pub text: Option<String>,
}

/// Where an interrupt leads from a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit {
    /// The interrupt.
    pub interrupt: InterruptId,
    /// Where it leads; perhaps to the same state, which is entered anew.
    pub to: State,
}

/// What the theorem says of a machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// It has this string.
    String(Found),
    /// It has none, because of all this.
    None(Vec<Broken>),
    /// The search among the orders of its states was stopped after so many steps.
    Stopped(u64),
}

/// A string, as an order of the states and what encloses them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// The states by their places, the termination state last.
    pub order: Vec<State>,
    /// The scopes.
    pub runs: Vec<Run>,
    /// The loops without end.
    pub loops: Vec<Loop>,
}

/// A scope: an interrupt and the neighbouring places from which it leads to one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The interrupt.
    pub interrupt: InterruptId,
    /// The first place.
    pub first: usize,
    /// The last place.
    pub last: usize,
    /// The place where it leads: behind the last, or where a loop begins.
    pub to: usize,
}

/// A loop without end, as the places it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loop {
    /// The first place.
    pub first: usize,
    /// The last place.
    pub last: usize,
}

impl Machine {
    /// The machine with these names, and for each interrupt its moves from state to state, one a state at most. Moves of states
    /// that there are not are left out.
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

    /// The same with a state that has to be the first.
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

    /// Where interrupts lead from a state, in the order of the file.
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

    /// Where an interrupt leads from a state, if it does from there.
    fn destination(&self, from: State, interrupt: InterruptId) -> Option<State> {
        let exits = self.exits(from);
        let place = exits.binary_search_by_key(&interrupt, |exit| exit.interrupt).ok()?;
        exits.get(place).map(|exit| exit.to)
    }

    /// All states but the termination state.
    fn atoms(&self) -> impl DoubleEndedIterator<Item = State> {
        (0..self.end().0).map(State)
    }

    /// The interrupt of laws that are done.
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

/// A place in a list as a number; no file that can be read has more.
fn number(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}

/// The string of a machine, if it has one. Machines without a way back are decided at once, others by a search of
/// `steps` steps at most.
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
