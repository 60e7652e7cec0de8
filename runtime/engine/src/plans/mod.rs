//! Plans at run time: the plan that drives, the plan that is to follow, and the suspended plan to which the engine can
//! roll back (paper, section III-D).
//!
//! A front end makes requests with [`Plans::swap`], [`Plans::cancel`] and [`Plans::rollback`] at a turn break, and
//! reads the answers from [`Plans::take_events`] after each turn.

mod compiler;
mod flight;
mod reads;
mod running;

use std::fmt;
use std::io;
use std::sync::Arc;

pub use compiler::Compile;
use compiler::{Compiled, Compiler, Order};
pub(crate) use flight::PlanModule;
use flight::{Desk, Flight, Landed};
use mdle_compiler::load::LoadedPlan;
use mdle_host::Transitions;
use mdle_runtime::{Machine, ModuleRead, Nanos, Published, Turn};
pub use running::EngineAlphabet;
use running::Running;

use crate::board::Board;

/// Time for which a new plan is on trial, unless [`Plans::set_trial`] sets another.
pub const TRIAL: Nanos = Nanos(3_000_000_000);

/// Moment at which a new plan takes over. In each case the robot has exactly one input in that turn, that of the new
/// plan's first turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// In the next turn.
    Now,
    /// In the turn in which the current atom ends.
    AtomEnds,
    /// In the turn in which the current plan is over.
    PlanEnds,
}

/// An event of a plan, by the number that [`Plans::swap`] has returned for it; the first plan has number 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlanEvent {
    /// The text has errors, and nothing has changed: the diagnostics.
    Refused(u32, String),
    /// Another request came before this one was compiled, and replaces it.
    Superseded(u32),
    /// The plan is compiled, and takes over when its moment comes.
    Armed(u32),
    /// The plan was cancelled before it took over.
    Cancelled(u32),
    /// The plan has taken over: this was its first turn.
    Began(u32),
    /// The trial of the plan is over, and the plan before it is gone.
    Accepted(u32),
    /// The plan on trial was ended, and the plan before it goes on.
    RolledBack {
        /// The plan that was ended.
        from: u32,
        /// The plan that goes on.
        to: u32,
        /// Why: a sentence.
        why: String,
    },
}

/// Reason why there is nothing to roll back to: no plan is on trial.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoTrial;

/// The plans of one robot.
pub struct Plans<A: EngineAlphabet> {
    /// The plan that drives; `None` before the first, and while its turn is late.
    current: Option<Box<Flight<A>>>,
    /// The plan that is to follow.
    armed: Option<(Running<A>, When)>,
    /// The plan before the one on trial, with the time of the turn in which it was suspended.
    suspended: Option<(Running<A>, Nanos)>,
    /// Since when the plan has been suspended that goes on in the next turn.
    resumes: Option<Nanos>,
    trial: Nanos,
    trial_ends: Nanos,
    compiler: Option<Compiler<A>>,
    desk: Arc<Desk<A>>,
    /// Number of the last request.
    last: u32,
    /// Number of the plan that drives.
    driving: u32,
    events: Vec<PlanEvent>,
    /// Plans to be dropped on another thread.
    spent: Vec<Running<A>>,
}

/// Result of the plan's turn.
pub(crate) enum PlanTurn<U> {
    /// The plan has made its turn.
    Made(Turn<U>),
    /// The plan has not ended its turn yet.
    Late,
    /// The plan panicked: the message.
    Panicked(String),
}

impl<A: EngineAlphabet> Plans<A> {
    /// Returns the plans of a robot whose first plan is this one.
    #[must_use]
    pub fn new(first: LoadedPlan<A>) -> Self {
        Self {
            current: Some(Flight::new(Running::new(1, first))),
            armed: None,
            suspended: None,
            resumes: None,
            trial: TRIAL,
            trial_ends: Nanos::ZERO,
            compiler: None,
            desk: Arc::default(),
            last: 1,
            driving: 1,
            events: Vec::new(),
            spent: Vec::new(),
        }
    }

    /// Lets plans be replaced by texts, which `compile` makes plans of on a thread of its own.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn compile_with(&mut self, compile: Box<Compile<A>>) -> io::Result<()> {
        self.compiler = Some(Compiler::new(compile)?);
        Ok(())
    }

    /// Sets the time for which a plan that takes over from now on is on trial.
    pub fn set_trial(&mut self, trial: Nanos) {
        self.trial = trial;
    }

    /// Asks for a plan to take over; returns its number. The answer is [`PlanEvent::Refused`] or [`PlanEvent::Armed`]
    /// at a later break, and then [`PlanEvent::Began`]. A request that is not compiled when the next one comes is
    /// superseded; a plan that is armed and has not begun is replaced.
    pub fn swap(&mut self, text: &str, when: When) -> u32 {
        self.last = self.last.saturating_add(1);
        let number = self.last;
        let order = Order { number, text: text.to_owned(), when };
        match &self.compiler {
            Some(compiler) => {
                let superseded = compiler.order(order);
                self.events.extend(superseded.map(|order| PlanEvent::Superseded(order.number)));
            }
            None => self.events.push(PlanEvent::Refused(number, "this engine has no compiler".to_owned())),
        }
        number
    }

    /// Asks for a plan that is loaded already to take over; returns its number. It is armed at once.
    pub fn replace(&mut self, plan: LoadedPlan<A>, when: When) -> u32 {
        self.last = self.last.saturating_add(1);
        let number = self.last;
        self.arm_plan(number, plan, when);
        number
    }

    /// Cancels the request that waits for the compiler, and the plan that is armed. A text that is being compiled is
    /// not cancelled.
    pub fn cancel(&mut self) {
        let waiting = self.compiler.as_ref().and_then(Compiler::take_back);
        self.events.extend(waiting.map(|order| PlanEvent::Cancelled(order.number)));
        if let Some((plan, _)) = self.armed.take() {
            self.events.push(PlanEvent::Cancelled(plan.number));
            self.spent.push(plan);
        }
    }

    /// Ends the plan on trial for this reason; the plan before it goes on in the next turn at its atom, as if no time
    /// had passed for it.
    ///
    /// # Errors
    /// No plan is on trial.
    pub fn rollback(&mut self, why: &str) -> Result<(), NoTrial> {
        let (old, suspended) = self.suspended.take().ok_or(NoTrial)?;
        self.resumes = Some(suspended);
        let to = old.number;
        let from = std::mem::replace(&mut self.driving, to);
        match &mut self.current {
            Some(flight) => self.spent.push(std::mem::replace(&mut flight.current, old)),
            None => self.leave_behind(old),
        }
        self.events.push(PlanEvent::RolledBack { from, to, why: why.to_owned() });
        Ok(())
    }

    /// Takes the events since the last call, in order.
    pub fn take_events(&mut self) -> impl Iterator<Item = PlanEvent> {
        self.events.drain(..)
    }

    /// Replaces the plan that drives at once and without a trial, as for a supervisor; a plan that is armed is
    /// cancelled.
    pub(crate) fn divert(&mut self, plan: LoadedPlan<A>) {
        self.cancel();
        self.last = self.last.saturating_add(1);
        self.driving = self.last;
        let plan = Running::new(self.last, plan);
        match &mut self.current {
            Some(flight) => self.spent.push(std::mem::replace(&mut flight.current, plan)),
            None => self.leave_behind(plan),
        }
        self.spent.extend(self.suspended.take().map(|(old, _)| old));
        self.resumes = None;
        self.events.push(PlanEvent::Began(self.last));
    }

    /// Goes on with this plan; the thread of the plan that drove panicked or hangs, and keeps it.
    fn leave_behind(&mut self, plan: Running<A>) {
        self.current = Some(Flight::new(plan));
        self.desk = Arc::default();
    }

    /// Returns `true` while the turn of the plan that drives is late, or after it has panicked.
    pub(crate) fn is_late(&self) -> bool {
        self.current.is_none()
    }

    /// Returns the number of the plan that drives.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.driving
    }

    /// Returns the plan that drives, once it has begun.
    #[must_use]
    pub fn machine(&self) -> Option<&Machine<LoadedPlan<A>>> {
        self.current.as_ref().and_then(|flight| flight.current.machine.as_ref())
    }

    /// Returns the engine's time at which the plan that drives began, moved on by the time for which it was suspended.
    #[must_use]
    pub fn zero(&self) -> Nanos {
        self.current.as_ref().map_or(Nanos::ZERO, |flight| flight.current.zero)
    }

    /// Returns the module that makes the turns of these plans.
    pub(crate) fn module(&self) -> PlanModule<A> {
        PlanModule(Arc::clone(&self.desk))
    }

    /// Lays the plan's turn at time `now` on the desk of its module; returns the numbers of modules that the plan
    /// reads. A plan that cannot begin yet makes no turn.
    ///
    /// # Errors
    /// Why the first plan never begins: a sentence.
    pub(crate) fn take_off(&mut self, now: Nanos, board: &Board) -> Result<Option<Published>, String> {
        let next = self.ready_to_follow(now, board);
        let Some(mut flight) = self.current.take() else { return Ok(None) };
        if let Some(suspended) = self.resumes.take() {
            flight.current.resume(suspended, now);
        }
        if let Some((next, when, published)) = next {
            flight.published = published;
            if when == When::Now {
                let old = std::mem::replace(&mut flight.current, next);
                self.begins(old, flight.current.number, now);
            } else {
                flight.next = Some((next, when));
            }
        }
        let published = flight.current.published(board, now);
        if let Ok(Some(_)) = published {
            flight.transitions.clear();
            (flight.turn, flight.at) = (None, now);
            self.desk.lay(flight);
        } else {
            self.current = Some(flight);
        }
        published
    }

    /// Takes the plan that is armed if it can begin in the turn at `now`, with the numbers of modules that it reads.
    fn ready_to_follow(&mut self, now: Nanos, board: &Board) -> Option<(Running<A>, When, Published)> {
        let (mut next, when) = self.armed.take_if(|_| self.current.is_some())?;
        match next.published(board, now) {
            Ok(Some(published)) => return Some((next, when, published)),
            Ok(None) => self.armed = Some((next, when)),
            Err(sentence) => {
                self.events.push(PlanEvent::Refused(next.number, sentence));
                self.spent.push(next);
            }
        }
        None
    }

    /// Returns the attributes of modules that plans read: the plan that drives, the next one, and the suspended one.
    pub(crate) fn reads(&self) -> impl Iterator<Item = &'static ModuleRead> + Clone {
        let next = |flight: &Flight<A>| flight.next.as_ref().map(|(next, _)| next.reads);
        let current = self.current.iter().flat_map(move |flight| [Some(flight.current.reads), next(flight)]).flatten();
        let armed = self.armed.iter().map(|(armed, _)| armed.reads);
        let suspended = self.suspended.iter().map(|(suspended, _)| suspended.reads);
        current.chain(armed).chain(suspended).flatten()
    }

    /// Takes the plan's turn at time `now` from the desk; `transitions` takes those of the plan that drives now.
    pub(crate) fn land(&mut self, now: Nanos, transitions: &mut Transitions) -> PlanTurn<A::Input> {
        let Landed { flight, replaced, panic } = self.desk.take();
        if let Some(message) = panic {
            return PlanTurn::Panicked(message);
        }
        let Some(mut flight) = flight else { return PlanTurn::Late };
        // The input of a turn that was late comes too late.
        let turn = flight.turn.take().filter(|_| flight.at == now);
        if let Some(old) = replaced {
            self.begins(old, flight.current.number, now);
        }
        if self.suspended.is_some() && now >= self.trial_ends {
            self.spent.extend(self.suspended.take().map(|(old, _)| old));
            self.events.push(PlanEvent::Accepted(flight.current.number));
        }
        // A request may have come while the turn was late.
        let armed = flight.next.take();
        self.armed = self.armed.take().or(armed);
        std::mem::swap(transitions, &mut flight.transitions);
        self.current = Some(flight);
        turn.map_or(PlanTurn::Late, PlanTurn::Made)
    }

    /// At a break: arms a plan that is compiled, at most one.
    pub(crate) fn arm(&mut self) {
        let Some(Compiled { number, when, plan }) = self.compiler.as_ref().and_then(Compiler::done) else { return };
        match plan {
            Ok(plan) => self.arm_plan(number, plan, when),
            Err(diagnostics) => self.events.push(PlanEvent::Refused(number, diagnostics)),
        }
    }

    fn arm_plan(&mut self, number: u32, plan: LoadedPlan<A>, when: When) {
        if let Some((old, _)) = self.armed.replace((Running::new(number, plan), when)) {
            self.events.push(PlanEvent::Superseded(old.number));
            self.spent.push(old);
        }
        self.events.push(PlanEvent::Armed(number));
    }

    /// Takes the plans that nothing needs any more: to drop a large plan takes longer than a turn may.
    pub(crate) fn take_spent(&mut self) -> impl Iterator<Item = Running<A>> {
        self.spent.drain(..)
    }

    /// Notes that a plan has replaced `old` in the turn at `now`, and suspends that one.
    fn begins(&mut self, old: Running<A>, number: u32, now: Nanos) {
        self.spent.extend(self.suspended.take().map(|(older, _)| older));
        self.suspended = Some((old, now));
        self.driving = number;
        self.trial_ends = Nanos(now.0.saturating_add(self.trial.0));
        self.events.push(PlanEvent::Began(number));
    }
}

impl fmt::Display for NoTrial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no plan is on trial, so there is none to roll back to")
    }
}

impl std::error::Error for NoTrial {}
