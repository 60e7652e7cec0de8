//! Makes exchanges and turns in the same order as `mdle run`, but without a clock.

use mdle_compiler::load::{LoadedPlan, PlanMoment};
use mdle_runtime::capability::Bumpers as _;
use mdle_runtime::{Machine, Measured, Nanos, Plan as _, Robot as _, Sensed, Transition, Turn, Twist, Watch};
use mdle_simulator::alphabet::Alphabet;
use mdle_simulator::{Goal, Simulated};

use crate::plan::Plan;
use crate::setup::{PERIOD, ReadyRun};

/// A run in progress.
pub(crate) struct Course {
    pub(crate) robot: Simulated,
    pub(crate) machine: Option<Machine<LoadedPlan<Alphabet>>>,
    /// The plan before its first turn; `None` afterwards.
    waiting: Option<LoadedPlan<Alphabet>>,
    input: Twist,
    /// Number of turns made so far.
    pub(crate) turns: u64,
    limit: Nanos,
    /// `true` if the robot touched something in the last exchange.
    pub(crate) touches: bool,
    /// Number of contacts that have begun so far.
    pub(crate) contacts: u64,
    /// The transitions of the last turn.
    pub(crate) seen: Seen,
    /// `true` if the law of the current atom has not been applied since the atom was entered.
    fresh: bool,
    /// Cause of the end; `None` if the run has not ended.
    pub(crate) end: Option<CourseEnd>,
}

/// The reason why a run has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum CourseEnd {
    /// The plan has ended.
    Over,
    /// The time limit was reached.
    Limit,
    /// The robot has a fault; contains its description.
    Fault(String),
}

/// An exchange with the robot.
#[derive(Clone, Copy)]
pub(crate) struct CourseExchange {
    /// Time of the exchange.
    pub(crate) t: Nanos,
    /// Output of the robot.
    pub(crate) y: Sensed,
    /// `true` if a contact begins with this exchange.
    pub(crate) hits: bool,
}

/// A turn that has been made, and its result.
pub(crate) struct CourseTurn {
    /// Number of the turn, counted from 0.
    pub(crate) number: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// Result of the turn, with the next input.
    pub(crate) turn: Turn<Twist>,
    /// Number of the current atom if this turn was the first to apply its law since the atom was entered; otherwise
    /// `None`.
    pub(crate) began: Option<u32>,
    /// The state of the plan before each transition, and at the end of the turn.
    pub(crate) moments: Vec<PlanMoment>,
}

/// The transitions of a turn. Each has the operands that fired.
#[derive(Default)]
pub(crate) struct Seen {
    pub(crate) transitions: Vec<(Transition, Vec<(u32, Measured)>)>,
    operands: Vec<(u32, Measured)>,
}

impl Watch for Seen {
    fn operand(&mut self, number: u32, measured: Measured) {
        self.operands.push((number, measured));
    }

    fn transition(&mut self, transition: Transition) {
        self.transitions.push((transition, std::mem::take(&mut self.operands)));
    }
}

impl Course {
    /// Creates a run whose robot is at its start. If `looks` is `true`, the run records the moments of its turns: the
    /// states of the plan before each transition and at the end.
    pub(crate) fn new(plan: &Plan, ready: &ReadyRun, looks: bool) -> Result<Self, String> {
        let waiting = if looks { plan.looked_at() } else { plan.looked_at().unobserved() };
        Ok(Self {
            robot: ready.robot()?,
            machine: None,
            waiting: Some(waiting),
            input: Twist::default(),
            turns: 0,
            limit: ready.limit,
            touches: false,
            contacts: 0,
            seen: Seen::default(),
            fresh: true,
            end: None,
        })
    }

    /// Sends the input of the last turn to the robot, and returns the robot's output. A fault of the robot ends the run
    /// and returns `None`.
    pub(crate) fn exchange(&mut self) -> Option<CourseExchange> {
        let t = self.robot.now();
        match self.robot.exchange(&self.input) {
            Ok(y) => {
                let hits = y.pressed() && !self.touches;
                self.contacts += u64::from(hits);
                self.touches = y.pressed();
                Some(CourseExchange { t, y, hits })
            }
            Err(fault) => {
                self.end = Some(CourseEnd::Fault(fault.to_string()));
                None
            }
        }
    }

    /// Runs a turn of the plan after an exchange; `y` is the robot's output.
    pub(crate) fn turn(&mut self, y: &Sensed) -> Option<CourseTurn> {
        let number = self.turns;
        let t = Nanos(number.saturating_mul(PERIOD.0));
        if let Some(plan) = self.waiting.take() {
            self.machine = Some(Machine::begin(plan, y, t));
        }
        let machine = self.machine.as_mut()?;
        self.seen.transitions.clear();
        let turn = machine.turn(y, t, &mut self.seen);
        let moments = machine.plan().looked_at().map_or(&[][..], |(_, moments)| moments).to_vec();
        self.turns += 1;
        self.input = turn.input();
        self.fresh |= !self.seen.transitions.is_empty();
        let has_begun = matches!(turn, Turn::Law(_)) && std::mem::take(&mut self.fresh);
        let began = machine.atom().filter(|_| has_begun);
        if turn == Turn::Over {
            self.end = Some(CourseEnd::Over);
        } else if t >= self.limit {
            self.end = Some(CourseEnd::Limit);
        }
        Some(CourseTurn { number, t, turn, began, moments })
    }

    /// Sends the null input, unless the robot has a fault.
    pub(crate) fn release(&mut self) -> Option<CourseExchange> {
        self.input = Twist::default();
        if matches!(self.end, Some(CourseEnd::Fault(_))) { None } else { self.exchange() }
    }

    /// Stops the robot.
    pub(crate) fn stop(&mut self) {
        // The run has ended, so an error is ignored.
        let _ = self.robot.stop();
    }

    /// Returns the result of the run with respect to the goal, as `mdle run --goal` reports it: `arrived`, `bumped` or
    /// `astray`. Returns `None` if there is no goal.
    pub(crate) fn judged(&self, goal: Option<&Goal>) -> Option<&'static str> {
        let arrives = goal?.holds(&self.robot.pose());
        Some(match (self.touches, arrives) {
            (true, _) => "bumped",
            (false, true) => "arrived",
            (false, false) => "astray",
        })
    }

    /// Returns the name of the plan.
    pub(crate) fn plan_name(&self) -> &str {
        self.machine.as_ref().map_or("", |machine| machine.plan().name(0))
    }
}
