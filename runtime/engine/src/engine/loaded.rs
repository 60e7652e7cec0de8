//! A loaded module, and its state.

use std::sync::Arc;

use mdle_runtime::Nanos;

use crate::board::Wires;
use crate::fork::{Seat, Task};
use crate::module::{Candidate, Declared, Form, Ports, Relevance, ThreadGate};

/// A loaded module.
pub(crate) struct LoadedModule<Y> {
    pub(crate) name: Arc<str>,
    pub(crate) declared: Declared,
    /// Position of the module's first attribute on the board.
    pub(crate) first: usize,
    pub(crate) wires: Wires,
    pub(crate) runs: ModuleCode<Y>,
    pub(crate) state: ModuleState,
    /// `true` while a user has stopped the module.
    pub(crate) is_held: bool,
    /// Number of turns that ended without the module because it was late.
    pub(crate) late_turns: u64,
    /// Reason why the module failed or was given up; empty if neither has happened.
    pub(crate) fault: String,
}

/// Code of a loaded module, and the thread that runs it.
pub(crate) enum ModuleCode<Y> {
    /// A module that makes turns. The threads that run turns reach the module through its seat.
    InTurns(Arc<Seat<Y>>),
    /// A background module, with its own thread.
    InBackground(ExchangeState),
}

/// State of a background module's exchange of values with the turn breaks.
pub(crate) struct ExchangeState {
    pub(crate) gate: ThreadGate,
    /// Time at which the module's next exchange is due, in stepped time.
    pub(crate) due: Nanos,
    /// Values of the module while a turn break processes them; `None` at any other time.
    pub(crate) ports: Option<Ports>,
}

/// State of a loaded module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModuleState {
    /// The module makes turns, or exchanges values.
    Active,
    /// The module makes no turns for now: a user has stopped it, or nothing reads it.
    Stopped,
    /// The module is late: a thread is still running an earlier turn of the module. Contains the number and the time of
    /// that turn.
    Late(u64, Nanos),
    /// The module was late for too long, and makes no further turn.
    GivenUp,
    /// The module has failed, and makes no further turn.
    Failed,
    /// The thread of this background module has ended.
    Ended,
}

impl ModuleState {
    /// Returns `true` if the module will never make a turn again.
    #[must_use]
    pub fn is_final(self) -> bool {
        match self {
            Self::Active | Self::Stopped | Self::Late(..) => false,
            Self::GivenUp | Self::Failed | Self::Ended => true,
        }
    }
}

impl<Y> LoadedModule<Y> {
    /// Creates a loaded module; `now` is the time of loading. If `lives` is `true`, the thread of a background module
    /// starts to run; otherwise, as in a replay, the thread never runs.
    pub(crate) fn new(candidate: Candidate<Y>, now: Nanos, lives: bool) -> Self {
        let Candidate { name, declared, form } = candidate;
        let (runs, state) = match form {
            Form::Registered(module, ports) => {
                (ModuleCode::InTurns(Seat::new(Arc::clone(&name), module, ports)), ModuleState::Stopped)
            }
            Form::Background(gate) => {
                if lives {
                    gate.begin();
                }
                let latency = if declared.begins_at_once { Nanos::ZERO } else { declared.latency };
                let due = Nanos(now.0.saturating_add(latency.0));
                (ModuleCode::InBackground(ExchangeState { gate, due, ports: None }), ModuleState::Stopped)
            }
        };
        Self {
            name,
            declared,
            first: 0,
            wires: Wires::new(),
            runs,
            state,
            is_held: false,
            late_turns: 0,
            fault: String::new(),
        }
    }

    /// Returns the seat of a registered module; `None` for a background module.
    pub(crate) fn seat(&self) -> Option<&Arc<Seat<Y>>> {
        match &self.runs {
            ModuleCode::InTurns(seat) => Some(seat),
            ModuleCode::InBackground(_) => None,
        }
    }

    /// Returns the module's seat if the module has to run in the next turn; `None` otherwise.
    pub(crate) fn queued(&self) -> Option<&Arc<Seat<Y>>> {
        let seat = self.seat()?;
        let is_queued = match self.state {
            ModuleState::Active => true,
            ModuleState::Stopped => seat.occupant().is_some_and(|occupant| occupant.task == Task::Stop),
            ModuleState::Late(..) | ModuleState::GivenUp | ModuleState::Failed | ModuleState::Ended => false,
        };
        is_queued.then_some(seat)
    }

    /// Returns `true` if the module makes turns even when nothing reads it.
    pub(crate) fn is_always_relevant(&self) -> bool {
        self.declared.relevance == Relevance::Always
    }
}
