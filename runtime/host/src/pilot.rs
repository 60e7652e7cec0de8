//! Interface of the code that makes a run's turns: one plan in an executable, an engine with modules in `mdle`.
//! Exchange, limits, signals, reports and the safe stop are the host's in every case.

use std::time::Duration;

use mdle_record::Change;
use mdle_runtime::{Machine, Nanos, Plan, Turn};

use crate::transitions::Transitions;
use crate::{Microphones, Refusal, StopRequest, Time};

/// Computes the input of each turn.
pub trait Pilot {
    /// The plan, for reports.
    type Plan: Plan;

    /// Completes the output of a turn at time `t` before the turn, for the supervisor: with what modules published.
    fn complete(&mut self, _y: &mut <Self::Plan as Plan>::Output, _t: Nanos) {}

    /// Makes a turn; the first one begins the plan, or waits with null inputs until the plan can begin. `transitions`
    /// is empty, and takes those of the plan.
    ///
    /// # Errors
    /// Why the run has to end, though the robot is well.
    fn turn(
        &mut self,
        moment: Moment<'_, <Self::Plan as Plan>::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<<Self::Plan as Plan>::Input>, PilotFault>;

    /// Replaces the plan by another one, which begins in this turn: a supervisor has asked for it.
    fn divert(&mut self, plan: Self::Plan, moment: Moment<'_, <Self::Plan as Plan>::Output>);

    /// Returns the number of the plan that runs, from 1; each plan that replaces one has the next.
    fn plan_number(&self) -> u64;

    /// Returns why the plan that runs has replaced another one; empty if [`Pilot::divert`] did it.
    fn reason(&self) -> &str {
        ""
    }

    /// Called when a rule of the supervisor has ended the plan that runs; returns `true` if another plan goes on with
    /// the next turn, so that the run does not end.
    fn ended_by(&mut self, _rule: &str) -> bool {
        false
    }

    /// Returns the plan, once it has begun.
    fn machine(&self) -> Option<&Machine<Self::Plan>>;

    /// Returns the time of the run at which the plan began, by which it counts its own time.
    fn zero(&self) -> Nanos {
        Nanos::ZERO
    }

    /// Calls `say` with each message for the operator since the last call.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}

    /// Notes from now on what [`Pilot::take_changes`] returns: called before the first turn of a run that is recorded.
    fn record(&mut self) {}

    /// Takes the causes of the last turn besides the robot's output, in order: with these and the outputs, the run can
    /// be made again.
    fn take_changes(&mut self) -> Vec<Change> {
        Vec::new()
    }
}

/// A turn of a run.
#[derive(Debug)]
pub struct Moment<'y, Y> {
    /// The robot's output.
    pub y: &'y Y,
    /// Time of the run at which the output was taken; the first output is at zero.
    pub t: Nanos,
    /// Number of the turn, from 0.
    pub number: u64,
}

/// Reason why the run has to end, though the robot is well (exit status 3).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PilotFault {
    /// The turns cannot go on: a sentence.
    Stopped(String),
    /// The plan panicked: the message.
    Panicked(String),
}

/// Conditions of a run, for its pilot and its supervisor.
#[derive(Debug, Clone)]
pub struct RunTerms {
    /// Time of the robot.
    pub time: Time,
    /// Period of a turn.
    pub period: Duration,
    /// The request to end the run, which a signal makes.
    pub request: StopRequest,
    /// Microphones of the robot, for a module that listens.
    pub microphones: Microphones,
}

/// Makes the pilot of a run.
pub(crate) type MakePilot<'p, B> = dyn Fn(&RunTerms) -> Result<B, Refusal> + Sync + 'p;

/// The pilot of an executable: its plan alone.
pub(crate) struct PlanAlone<'p, P: Plan> {
    /// Makes the plan.
    plan: &'p (dyn Fn() -> P + Sync),
    machine: Option<Machine<P>>,
    /// Number of the plan that runs, from 1.
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
        Moment { y, t, .. }: Moment<'_, P::Output>,
        transitions: &mut Transitions,
    ) -> Result<Turn<P::Input>, PilotFault> {
        let machine = self.machine.get_or_insert_with(|| Machine::begin((self.plan)(), y, t));
        Ok(machine.turn(y, t, transitions))
    }

    fn divert(&mut self, plan: P, Moment { y, t, .. }: Moment<'_, P::Output>) {
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
