//! The data of a plan's turn, which threads pass to each other.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mdle_host::Transitions;
use mdle_runtime::{Alphabet, Nanos, Output as _, Published, Turn};

use super::running::Running;
use super::{EngineAlphabet, When};
use crate::module::{self, Fault, Module, panicked};

/// A plan's turn, with the plan that may take over in this turn.
pub(crate) struct Flight<A: Alphabet> {
    pub(crate) current: Running<A>,
    /// Plan that takes over in this turn if its moment comes; contains the plan and this moment.
    pub(crate) next: Option<(Running<A>, When)>,
    /// Values that the next plan reads from modules.
    pub(crate) published: Published,
    /// Transitions of the current plan.
    pub(crate) transitions: Transitions,
    /// Result of the turn; `None` before the turn was made.
    pub(crate) turn: Option<Turn<A::Input>>,
    /// Time of the turn.
    pub(crate) at: Nanos,
}

/// The desk: storage through which the engine passes a plan's turn to the module that makes the turn, and gets it back.
pub(crate) struct Desk<A: Alphabet>(Mutex<OnDesk<A>>);

struct OnDesk<A: Alphabet> {
    flight: Option<Box<Flight<A>>>,
    /// Plan that was replaced in this turn; `None` if no plan was replaced.
    replaced: Option<Running<A>>,
    /// Panic message of this turn; `None` if the turn did not panic.
    panic: Option<String>,
}

/// A turn that the plan's thread has returned.
pub(crate) struct Landed<A: Alphabet> {
    pub(crate) flight: Option<Box<Flight<A>>>,
    pub(crate) replaced: Option<Running<A>>,
    pub(crate) panic: Option<String>,
}

impl<A: Alphabet> Default for Desk<A> {
    fn default() -> Self {
        Self(Mutex::new(OnDesk { flight: None, replaced: None, panic: None }))
    }
}

impl<A: Alphabet> Desk<A> {
    fn lock(&self) -> MutexGuard<'_, OnDesk<A>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stores a turn for the module that makes it, before the threads are called.
    pub(crate) fn lay(&self, flight: Box<Flight<A>>) {
        self.lock().flight = Some(flight);
    }

    /// Removes and returns the stored turn and its other results.
    pub(crate) fn take(&self) -> Landed<A> {
        let mut desk = self.lock();
        Landed { flight: desk.flight.take(), replaced: desk.replaced.take(), panic: desk.panic.take() }
    }
}

impl<A: EngineAlphabet> Flight<A> {
    /// Creates the data for the turns of a plan that has not begun.
    pub(crate) fn new(current: Running<A>) -> Box<Self> {
        let transitions = Transitions::default();
        Box::new(Self { current, next: None, published: Published::NONE, transitions, turn: None, at: Nanos::ZERO })
    }

    /// Makes the turn. If a plan is replaced, it is stored in `desk` before its successor makes a turn, because the
    /// successor may hang.
    fn fly(&mut self, y: &A::Output, now: Nanos, desk: &Desk<A>) {
        let turn = self.current.turn(y, now, &mut self.transitions);
        let takes_over = match &self.next {
            Some((_, When::Now)) => true,
            Some((_, When::AtomEnds)) => !self.transitions.is_empty() || matches!(turn, Turn::Over),
            Some((_, When::PlanEnds)) => matches!(turn, Turn::Over),
            None => false,
        };
        self.turn = match self.next.take_if(|_| takes_over) {
            Some((next, _)) => {
                // The input of the replaced plan is discarded: the law that computed it has had no effect.
                desk.lock().replaced = Some(std::mem::replace(&mut self.current, next));
                self.transitions.clear();
                let mut y = y.clone();
                y.take_published(self.published);
                Some(self.current.turn(&y, now, &mut self.transitions))
            }
            None => Some(turn),
        };
    }
}

/// Module that makes the turns of plans: in each turn, it makes the plan's turn that is stored on the desk. A late turn
/// that was made lies on the desk until the engine takes it back.
pub(crate) struct PlanModule<A: Alphabet>(pub(crate) Arc<Desk<A>>);

impl<A: EngineAlphabet> Module<A::Output> for PlanModule<A> {
    fn turn(&mut self, turn: &mut module::Turn<'_, A::Output>) -> Result<(), Fault> {
        let Self(desk) = self;
        let unmade = desk.lock().flight.take_if(|flight| flight.turn.is_none());
        let Some(mut flight) = unmade else { return Ok(()) };
        match catch_unwind(AssertUnwindSafe(|| {
            flight.fly(turn.y, turn.now, desk);
            flight
        })) {
            Ok(flight) => desk.lay(flight),
            Err(payload) => desk.lock().panic = Some(panicked(payload)),
        }
        Ok(())
    }
}
