//! Theorem 1 in both directions (paper, Theorem 1; docs/src/reference/semantics.md, 8.5): finds the MDLe string of a
//! machine, or the reasons why it has no string.
//!
//! In a string, the positions of the states are counted from 0, the termination state has the last position, and any
//! two runs or loops are nested or disjoint.

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

/// Default maximum number of steps in the search among orders. This many steps take a few seconds.
pub const STEPS: u64 = 1_000_000;

/// Name of the interrupt that fires when a law completes; plans do not contain it.
const COMPLETED: &str = "completed";

/// A state of a machine, as its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct State(pub u32);

/// An interrupt of a machine, as its index in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct InterruptId(pub u32);

/// A machine as in an FSM file. Its last state is the termination state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Machine {
    states: Vec<String>,
    laws: Option<Vec<String>>,
    start: Option<State>,
    interrupts: Vec<NamedInterrupt>,
    exits: Vec<Vec<Exit>>,
}

/// An interrupt's name and the text of its condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedInterrupt {
    /// Name of the interrupt.
    pub name: String,
    /// Condition of the interrupt; `None` if the file contains none.
    pub text: Option<String>,
}

/// A transition from a state: an interrupt and its destination.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exit {
    /// Interrupt of the transition.
    pub interrupt: InterruptId,
    /// Destination. It can be the state itself, which is then entered again.
    pub to: State,
}

/// Result of applying the theorem to a machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum TheoremResult {
    /// The machine has this string.
    String(Found),
    /// The machine has no string, for these reasons.
    None(Vec<Broken>),
    /// The search among the orders of the machine's states stopped after this number of steps.
    Stopped(u64),
}

/// A string of a machine: an order of the states, with the scopes and loops that enclose them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found {
    /// States in the order of their positions, with the termination state last.
    pub order: Vec<State>,
    /// Scopes of the string.
    pub runs: Vec<ScopeRun>,
    /// Endless loops of the string.
    pub loops: Vec<Loop>,
}

/// A scope of a string: an interrupt, and the consecutive positions from which it leads to the same position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScopeRun {
    /// Interrupt of the scope.
    pub interrupt: InterruptId,
    /// First position of the scope.
    pub first: usize,
    /// Last position of the scope.
    pub last: usize,
    /// Position to which the interrupt leads: the position after `last`, or the start of a loop.
    pub to: usize,
}

/// An endless loop, as the range of positions that it encloses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Loop {
    /// First position of the loop.
    pub first: usize,
    /// Last position of the loop.
    pub last: usize,
}

impl Machine {
    /// Creates a machine with these states and interrupts. Each interrupt has its transitions as pairs of source and
    /// destination, at most one from each state. Transitions from or to unknown states are ignored.
    #[must_use]
    pub fn new(states: Vec<String>, interrupts: Vec<(NamedInterrupt, Vec<(State, State)>)>) -> Self {
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

    /// Sets the start state, which must be the first state of an order.
    #[must_use]
    pub fn starting(self, start: State) -> Self {
        Self { start: Some(start), ..self }
    }

    /// Returns the names of the states.
    #[must_use]
    pub fn states(&self) -> &[String] {
        &self.states
    }

    /// Returns the interrupts.
    #[must_use]
    pub fn interrupts(&self) -> &[NamedInterrupt] {
        &self.interrupts
    }

    /// Returns the transitions from a state, in the order of the file.
    #[must_use]
    pub fn exits(&self, state: State) -> &[Exit] {
        &self.exits[state.0 as usize]
    }

    /// Returns the start state in the file, if the file has one.
    #[must_use]
    pub fn start(&self) -> Option<State> {
        self.start
    }

    /// Returns the termination state.
    #[must_use]
    pub fn end(&self) -> State {
        State(number(self.states.len().saturating_sub(1)))
    }

    /// Returns the state to which an interrupt leads from the state `from`, `None` if it leads nowhere.
    fn destination(&self, from: State, interrupt: InterruptId) -> Option<State> {
        let exits = self.exits(from);
        let place = exits.binary_search_by_key(&interrupt, |exit| exit.interrupt).ok()?;
        exits.get(place).map(|exit| exit.to)
    }

    /// Returns all states except the termination state.
    fn atoms(&self) -> impl DoubleEndedIterator<Item = State> {
        (0..self.end().0).map(State)
    }

    /// Returns the interrupt that fires when a law completes, `None` if the machine has no such interrupt.
    fn completed(&self) -> Option<InterruptId> {
        let place = self.interrupts.iter().position(|interrupt| interrupt.name == COMPLETED)?;
        Some(InterruptId(number(place)))
    }

    fn name(&self, state: State) -> &str {
        &self.states[state.0 as usize]
    }

    fn interrupt(&self, interrupt: InterruptId) -> &NamedInterrupt {
        &self.interrupts[interrupt.0 as usize]
    }
}

/// Converts an index to 32 bits; no file that can be read has more entries.
fn number(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}

/// Returns the string of a machine, if there is one. For a machine with a cycle, the string is searched for in at most
/// `steps` steps; for other machines the string is computed directly.
#[must_use]
pub fn decompile(machine: &Machine, steps: u64) -> TheoremResult {
    let broken = conditions::of_every_order(machine);
    if !broken.is_empty() {
        return TheoremResult::None(broken);
    }
    let order = order::forwards(machine);
    if !order::leads_forwards(machine, &order) {
        return loops::search(machine, &order, steps);
    }
    match loop_free::runs(machine, &order) {
        Ok(runs) => TheoremResult::String(Found { order, runs, loops: Vec::new() }),
        Err(broken) => TheoremResult::None(broken),
    }
}
