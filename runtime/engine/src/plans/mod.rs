//! Plans at run time (paper, sections III-D and III-H): the active plan; the armed plan, which is about to take over;
//! the suspended plan, to which the engine can roll back; and the stored plans.
//!
//! A front end makes requests at a turn break, such as [`Plans::swap`], and reads the answers with
//! [`Plans::take_events`] after each turn.

mod changes;
mod compiler;
mod event;
mod flight;
mod order;
mod peers;
pub(crate) mod reads;
mod requests;
mod running;
mod stored;
mod turns;

use std::any::Any;
use std::sync::Arc;

use changes::PlanChanges;
use compiler::Compiler;
pub use event::{NoTrial, PlanEvent, When};
use flight::{Desk, Flight};
use mdle_compiler::load::LoadedPlan;
use mdle_record::RecordedChange;
use mdle_runtime::{Machine, ModuleRead, Nanos, Plan as _};
pub use order::{Compile, CompiledPlans, PlanSource};
pub(crate) use peers::ENDED;
use peers::PeerRequests;
pub use running::EngineAlphabet;
use running::Running;
use stored::Store;
pub use stored::{MOST_STORED, PlanFacts, StoredPlan};
pub(crate) use turns::PlanTurn;

use crate::board::Board;

/// Default duration of a new plan's trial; [`Plans::set_trial`] sets another.
pub const TRIAL: Nanos = Nanos(3_000_000_000);

/// Reason to refuse a plan of another robot: a plan of the operator waits to take over.
const OPERATOR_FIRST: &str = "a plan of the operator waits to take over: send the plan again later";

/// The plans of one robot.
pub struct Plans<A: EngineAlphabet> {
    /// The active plan; `None` while its turn is running or late, and after it has panicked.
    current: Option<Box<Flight<A>>>,
    /// The armed plan, and the moment at which it takes over; `None` if no plan is armed.
    armed: Option<(Running<A>, When)>,
    /// The plan that was replaced by the plan on trial, with the time of the turn in which it was suspended; `None` if
    /// no plan is on trial.
    suspended: Option<(Running<A>, Nanos)>,
    /// If a suspended plan continues in the next turn, the time at which it was suspended; `None` otherwise.
    resumes: Option<Nanos>,
    trial: Nanos,
    trial_ends: Nanos,
    compiler: Option<Compiler<A>>,
    desk: Arc<Desk<A>>,
    stored: Store<A>,
    /// Names of the paths that the robot can replay: the paths of the first plan.
    paths: Vec<&'static str>,
    /// Number of the last request.
    last: u32,
    /// Number of the last plan that began.
    begun: u32,
    /// Number of the last request that was made before a safety rule replaced the plan; 0 if no rule has replaced a
    /// plan.
    overruled: u32,
    /// Number of the request for the plan that may take over in the running turn; `None` if there is no such plan.
    aloft: Option<u32>,
    peers: PeerRequests,
    driving: Driving,
    /// Reason why the active plan replaced the previous plan.
    reason: String,
    events: Vec<PlanEvent>,
    /// Values that another thread has to drop, because dropping a large plan takes longer than a turn allows.
    spent: Vec<Spent>,
    /// Changes of plans for the record; `None` if the run is not recorded.
    changes: Option<PlanChanges>,
}

/// Name and numbers of the active plan.
#[derive(Debug, Clone)]
struct Driving {
    number: u32,
    ticket: u32,
    name: Arc<str>,
}

/// A value that is no longer needed, of any type.
type Spent = Box<dyn Any + Send>;

impl<A: EngineAlphabet> Plans<A> {
    /// Creates the plans of a robot whose first plan is `first`.
    #[must_use]
    pub fn new(first: LoadedPlan<A>) -> Self {
        let paths = first.paths().to_vec();
        let mut first = Running::new(1, first);
        first.number = 1;
        Self {
            driving: Driving { number: 1, ticket: 1, name: Arc::clone(&first.name) },
            current: Some(Flight::new(first)),
            armed: None,
            suspended: None,
            resumes: None,
            trial: TRIAL,
            trial_ends: Nanos::ZERO,
            compiler: None,
            desk: Arc::default(),
            stored: Store::default(),
            paths,
            last: 1,
            begun: 1,
            overruled: 0,
            aloft: None,
            peers: PeerRequests::default(),
            reason: String::new(),
            events: Vec::new(),
            spent: Vec::new(),
            changes: None,
        }
    }

    /// Starts to collect changes of plans for a record.
    pub(crate) fn record(&mut self) {
        self.changes = Some(PlanChanges::default());
    }

    /// Removes and returns the changes since the last call.
    pub(crate) fn take_changes(&mut self) -> Vec<RecordedChange> {
        self.changes.as_mut().map(PlanChanges::take).unwrap_or_default()
    }

    /// Collects a change for the record if the run is recorded.
    pub(crate) fn note(&mut self, change: RecordedChange) {
        if let Some(changes) = &mut self.changes {
            changes.note(change);
        }
    }

    /// Sets the trial duration of plans that take over from now on.
    pub fn set_trial(&mut self, trial: Nanos) {
        self.trial = trial;
        self.note(RecordedChange::Trial(trial));
    }

    /// Returns the trial duration of plans that take over.
    #[must_use]
    pub fn trial(&self) -> Nanos {
        self.trial
    }

    /// Removes and returns the events since the last call, in order.
    pub fn take_events(&mut self) -> impl Iterator<Item = PlanEvent> {
        self.events.drain(..)
    }

    /// Returns the number of the active plan: the first plan has number 1, and each new plan has the next number.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.driving.number
    }

    /// Returns the name of the active plan.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.driving.name
    }

    /// Returns the names of the paths that plans of this run can replay.
    #[must_use]
    pub fn paths(&self) -> &[&'static str] {
        &self.paths
    }

    /// Returns the name of the plan that belongs to this request; `None` if the plan is neither active nor armed.
    pub(crate) fn name_of(&self, ticket: u32) -> Option<&str> {
        let armed = self.armed.iter().map(|(plan, _)| (plan.ticket, &*plan.name));
        let plans = armed.chain([(self.driving.ticket, &*self.driving.name)]);
        plans.into_iter().find_map(|(number, name)| (number == ticket).then_some(name))
    }

    /// Returns the name of the armed plan, and the moment at which it takes over; `None` if no plan is armed.
    #[must_use]
    pub fn armed(&self) -> Option<(&str, When)> {
        self.armed.as_ref().map(|(plan, when)| (&*plan.name, *when))
    }

    /// Returns the end of a sentence about the armed plan: the module attributes that it needs before it can begin.
    /// Empty if it does not wait.
    pub(crate) fn awaited(&self, board: &Board, now: Nanos) -> String {
        self.armed.as_ref().map_or_else(String::new, |(plan, _)| reads::awaited(plan.reads, board, now))
    }

    /// Returns the reason why the plan of this request must not take over now; `None` if it may take over. Only plans
    /// of other robots are refused.
    fn refuses(&self, ticket: u32) -> Option<&'static str> {
        let mut waiting = self.armed.iter().map(|(plan, _)| plan.ticket).chain(self.aloft);
        let waits = |waiting: u32| !self.peers.has(waiting);
        let is_sent = self.peers.has(ticket);
        self.peers.barred(ticket).or_else(|| (is_sent && waiting.any(waits)).then_some(OPERATOR_FIRST))
    }

    /// Returns the time at which the active plan's trial ends; `None` if it is not on trial.
    #[must_use]
    pub fn trial_ends(&self) -> Option<Nanos> {
        self.suspended.as_ref().map(|_| self.trial_ends)
    }

    /// Returns the reason why the active plan replaced the previous plan; empty for the first plan, and for a plan that
    /// a safety rule started.
    pub(crate) fn reason(&self) -> &str {
        &self.reason
    }

    /// Returns the state machine of the active plan; `None` before the plan has begun.
    #[must_use]
    pub fn machine(&self) -> Option<&Machine<LoadedPlan<A>>> {
        self.current.as_ref().and_then(|flight| flight.current.machine.as_ref())
    }

    /// Returns the start time of the active plan on the engine's clock, plus the time for which the plan was suspended.
    #[must_use]
    pub fn zero(&self) -> Nanos {
        self.current.as_ref().map_or(Nanos::ZERO, |flight| flight.current.zero)
    }

    /// Takes the values that have to be dropped on another thread.
    pub(crate) fn take_spent(&mut self) -> impl Iterator<Item = Spent> {
        self.spent.drain(..)
    }

    /// Returns the module attributes that the active plan reads; empty before the plan has begun.
    pub(crate) fn driving_reads(&self) -> &'static [ModuleRead] {
        let driving = self.current.as_ref().filter(|flight| flight.current.machine.is_some());
        driving.map_or(&[], |flight| flight.current.reads)
    }

    /// Reports an event of a request.
    fn tell(&mut self, event: PlanEvent) {
        self.peers.note(&event);
        self.events.push(event);
    }

    fn discard(&mut self, plan: Running<A>) {
        self.spent.push(Box::new(plan));
    }
}
