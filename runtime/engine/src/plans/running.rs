//! A plan that runs or is about to run, with its own clock.

use std::sync::Arc;

use mdle_compiler::load::LoadedPlan;
use mdle_runtime::{Alphabet, Machine, ModuleRead, Nanos, Plan, Published, Turn, Watch};

use super::reads::{self, Unready};
use crate::board::Board;

/// Alphabet of a robot whose plans an engine can run: its quarks can move between threads.
pub trait EngineAlphabet:
    Alphabet<
        Output: Clone + Send + Sync + 'static,
        Input: Send + 'static,
        Interrupt: Send + Sync,
        Control: Send + Sync,
        Law: Send,
    > + 'static
{
}

impl<A> EngineAlphabet for A
where
    A: Alphabet + 'static,
    A::Output: Clone + Send + Sync + 'static,
    A::Input: Send + 'static,
    A::Interrupt: Send + Sync,
    A::Control: Send + Sync,
    A::Law: Send,
{
}

/// A plan of the engine.
pub(crate) struct Running<A: Alphabet> {
    /// Number of the request for the plan.
    pub(crate) ticket: u32,
    /// Number of the plan among the plans that have begun, counting from 1; 0 before the plan begins.
    pub(crate) number: u32,
    pub(crate) name: Arc<str>,
    /// The loaded plan before its first turn; `None` afterwards.
    ready: Option<LoadedPlan<A>>,
    pub(crate) machine: Option<Machine<LoadedPlan<A>>>,
    /// Start time of the plan on the engine's clock, plus the time for which the plan was suspended.
    pub(crate) zero: Nanos,
    /// Attributes of modules that the plan reads.
    pub(crate) reads: &'static [ModuleRead],
    /// Names of the other robots that the plan refers to.
    pub(crate) robots: Box<[&'static str]>,
    /// Time at which the plan began to wait for the attributes that it reads; `None` if it has never waited.
    waits_since: Option<Nanos>,
    /// `true` if the plan continues in this turn after it was suspended.
    is_back: bool,
}

impl<A: Alphabet> Running<A> {
    /// Creates a plan before its first turn.
    pub(crate) fn new(ticket: u32, plan: LoadedPlan<A>) -> Self {
        let (reads, robots) = (Plan::reads(&plan), Plan::robots(&plan).into());
        let name = Plan::name(&plan, 0).into();
        Self {
            ticket,
            number: 0,
            name,
            ready: Some(plan),
            machine: None,
            zero: Nanos::ZERO,
            reads,
            robots,
            waits_since: None,
            is_back: false,
        }
    }

    /// Returns the values that the plan reads from modules in the turn at `now`; `None` if the plan cannot begin yet.
    ///
    /// # Errors
    /// Fails with a sentence if the plan can never begin.
    pub(crate) fn published(&mut self, board: &Board, now: Nanos) -> Result<Option<Published>, String> {
        if self.ready.is_none() {
            return Ok(Some(reads::current(self.reads, board, now)));
        }
        let since = *self.waits_since.get_or_insert(now);
        match reads::published(self.reads, board, now) {
            Ok(published) => Ok(Some(published)),
            Err(Unready::OtherKind(sentence)) => Err(sentence),
            Err(Unready::Missing(missing)) if now.since(since) < reads::patience(&missing, board) => Ok(None),
            Err(Unready::Missing(missing)) => Err(reads::in_vain(&missing, board)),
        }
    }

    /// Makes a turn at `now` on the engine's clock. The plan's own time is zero in its first turn.
    pub(crate) fn turn<W: Watch>(&mut self, y: &A::Output, now: Nanos, watch: &mut W) -> Turn<A::Input> {
        if let Some(plan) = self.ready.take() {
            self.zero = now;
            self.machine = Some(Machine::begin(plan, y, Nanos::ZERO));
        }
        let Some(machine) = &mut self.machine else { return Turn::Over };
        let t = now.since(self.zero);
        if std::mem::take(&mut self.is_back) {
            machine.reenter(y, t);
        }
        machine.turn(y, t, watch)
    }

    /// Suspends the plan. `y` is the output after the plan's last input.
    pub(crate) fn suspend(&mut self, y: &A::Output) {
        if let Some(machine) = &mut self.machine {
            machine.suspend(y);
        }
    }

    /// Continues the plan at `now` as if no time had passed since it was suspended. The law of the current atom
    /// restarts, because the robot may have moved.
    pub(crate) fn resume(&mut self, suspended: Nanos, now: Nanos) {
        self.zero = Nanos(self.zero.0.saturating_add(now.since(suspended).0));
        self.is_back = true;
    }
}
