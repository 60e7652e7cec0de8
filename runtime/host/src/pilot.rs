//! Interface of the code that makes a run's turns. In an executable, this code is a plan; in `mdle`, it is an engine
//! with modules. For both, the host handles exchange, limits, signals, reports and the safe stop.

use std::time::Duration;

use mdle_record::RecordedChange;
use mdle_runtime::{Machine, Nanos, Plan, Turn};

use crate::transitions::Transitions;
use crate::{Microphones, Refusal, StopRequest, Time};

/// Computes the input of each turn.
pub trait Pilot {
    /// Type of the plans, for use in reports.
    type Plan: Plan;

    /// Adds the values that modules have published to the output of the turn at time `t`, before the supervisor reads
    /// the output.
    fn complete(&mut self, _y: &mut <Self::Plan as Plan>::Output, _t: Nanos) {}

    /// Makes a turn. The first turn begins the plan; if the plan cannot begin yet, null inputs are sent until it can.
    /// `transitions` is empty at first, and receives the transitions of the plan.
    ///
    /// # Errors
    /// Returns the reason if the run must end although the robot has no fault.
    fn turn(
        &mut self,
        moment: PilotTurn<'_, <Self::Plan as Plan>::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<<Self::Plan as Plan>::Input>, PilotFault>;

    /// Replaces the current plan with `plan`, which begins in this turn, because a supervisor requests it.
    fn divert(&mut self, plan: Self::Plan, moment: PilotTurn<'_, <Self::Plan as Plan>::Output>);

    /// Returns the number of the current plan. The first plan has number 1, and each plan that replaces another one has
    /// the next number.
    fn plan_number(&self) -> u64;

    /// Returns the reason why the current plan has replaced another plan; empty if [`Pilot::divert`] replaced that
    /// plan.
    fn reason(&self) -> &str {
        ""
    }

    /// Handles the end of the current plan by the rule `_rule` of the supervisor. Returns `true` if another plan
    /// continues in the next turn, so that the run does not end.
    fn ended_by(&mut self, _rule: &str) -> bool {
        false
    }

    /// Returns the continuation of the run after a turn in which the current plan has ended.
    fn after_plan(&mut self) -> AfterPlan {
        AfterPlan::Ends
    }

    /// Returns the current plan with its state; `None` before the plan has begun.
    fn machine(&self) -> Option<&Machine<Self::Plan>>;

    /// Returns the time of the run at which the plan began, which is time 0 of the plan.
    fn zero(&self) -> Nanos {
        Nanos::ZERO
    }

    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}

    /// Starts recording the changes that [`Pilot::take_changes`] returns; called before the first turn of a recorded
    /// run.
    fn record(&mut self) {}

    /// Removes and returns the changes, other than the robot's output, that influenced the last turn, in order. With
    /// these changes and the outputs, the run can be repeated.
    fn take_changes(&mut self) -> Vec<RecordedChange> {
        Vec::new()
    }
}

/// Output, time and number of a turn.
#[derive(Debug)]
pub struct PilotTurn<'y, Y> {
    /// Output of the robot.
    pub y: &'y Y,
    /// Time of the run at which the output was read; the first output is at time 0.
    pub t: Nanos,
    /// Number of the turn, counted from 0.
    pub number: u64,
}

/// Reason why a run must end although the robot has no fault (exit status 3).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PilotFault {
    /// The turns cannot continue; contains the reason as a sentence.
    Stopped(String),
    /// The plan panicked; contains the panic message.
    Panicked(String),
}

/// Continuation of a run after the end of its current plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AfterPlan {
    /// The run ends.
    Ends,
    /// Another plan begins in the next turn.
    Continues,
    /// The run ends before its goal (exit status 3); contains the reason as a sentence.
    Fails(String),
}

/// Terms of a run, on which its pilot and its supervisor depend.
#[derive(Debug, Clone)]
pub struct RunTerms {
    /// Source of the robot's time.
    pub time: Time,
    /// Period of a turn.
    pub period: Duration,
    /// Request to end the run; a signal makes this request.
    pub request: StopRequest,
    /// Microphones of the robot, for a module that listens.
    pub microphones: Microphones,
}

/// A function that creates the pilot of a run.
pub(crate) type MakePilot<'p, B> = dyn Fn(&RunTerms) -> Result<B, Refusal> + Sync + 'p;

/// The pilot of an executable, which runs a plan without modules.
pub(crate) struct PlanAlone<'p, P: Plan> {
    /// Function that creates the plan.
    plan: &'p (dyn Fn() -> P + Sync),
    machine: Option<Machine<P>>,
    /// Number of the current plan, counted from 1.
    number: u64,
}

impl<'p, P: Plan> PlanAlone<'p, P> {
    pub(crate) fn new(plan: &'p (dyn Fn() -> P + Sync)) -> Self {
        Self { plan, machine: None, number: 1 }
    }
}

impl<P: Plan> Pilot for PlanAlone<'_, P> {
    type Plan = P;

    fn turn(
        &mut self,
        PilotTurn { y, t, .. }: PilotTurn<'_, P::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<P::Input>, PilotFault> {
        let machine = self.machine.get_or_insert_with(|| Machine::begin((self.plan)(), y, t));
        Ok(machine.turn(y, t, transitions))
    }

    fn divert(&mut self, plan: P, PilotTurn { y, t, .. }: PilotTurn<'_, P::Output>) {
        self.machine = Some(Machine::begin(plan, y, t));
        self.number = self.number.saturating_add(1);
    }

    fn plan_number(&self) -> u64 {
        self.number
    }

    fn machine(&self) -> Option<&Machine<P>> {
        self.machine.as_ref()
    }
}
