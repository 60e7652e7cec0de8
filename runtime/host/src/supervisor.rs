//! The supervisor of a run: code between a plan and its robot, such as a safety envelope or a session with an operator.
//! See docs/src/reference/interfaces.md, 7.6.

use std::fmt;
use std::os::fd::BorrowedFd;

use mdle_record::RecordedChange;
use mdle_runtime::{Nanos, Plan};

use crate::standing::{RunCourse, standing};
use crate::timing::Timing;
use crate::{Lateness, Pace, Pilot, PlanPosition, RobotSettings, RunTerms};

/// Decides which input is sent to a robot, and acts between the turns that the pilot `B` makes.
///
/// The supervisor runs on the thread that drives the robot, so a real robot waits for it.
pub trait Supervisor<B: Pilot> {
    /// Returns the input that is sent to the robot instead of `asked`, which the plan has requested in the turn with
    /// output `y` at time `t`. All inputs are passed to this function, including the null inputs at the end of a run
    /// and in a turn that reaches the limit of transitions; the only exception is the input before the first output.
    fn filter(&mut self, asked: PilotInput<B>, _y: &PilotOutput<B>, _t: Nanos) -> PilotInput<B> {
        asked
    }

    /// Returns the intervention of the last [`Supervisor::filter`]; `None` if it did not change the plan's input.
    fn intervention(&self) -> Option<Intervention<'_>> {
        None
    }

    /// Calls `say` with each message for the operator since the last call; called after each turn.
    fn messages(&mut self, _say: &mut dyn FnMut(&str)) {}

    /// Acts before the first turn and after each turn, before the input of the turn has been sent. A long call delays a
    /// real robot; in stepped time, a call may take any time.
    fn at_break(&mut self, _moment: &mut Break<'_, B>) -> BreakOrders {
        BreakOrders::default()
    }

    /// Called with the last state of a run that ends before its plan, before the robot is stopped. Not called after a
    /// panic.
    fn at_end(&mut self, _moment: &Break<'_, B>) {}

    /// Called with the reason for the end of a run, as a sentence, and the exit status, after the robot has been
    /// stopped. The sentence is empty if the plan is over, or if the supervisor has requested the end.
    fn ended(&mut self, _why: &str, _status: u8) {}

    /// Starts recording the changes that [`Supervisor::take_changes`] returns; called before the first turn of a
    /// recorded run.
    fn record(&mut self) {}

    /// Removes and returns the changes of the supervisor's rules that were made before the last turn.
    fn take_changes(&mut self) -> Vec<RecordedChange> {
        Vec::new()
    }

    /// Repeats a change of the supervisor's rules when a run is replayed.
    fn repeat(&mut self, _change: &RecordedChange) {}

    /// Returns, for the log, the requests that were fulfilled at breaks since the last call.
    fn take_requests(&mut self) -> Vec<String> {
        Vec::new()
    }
}

/// Output type of the robot that a pilot drives.
pub type PilotOutput<B> = <<B as Pilot>::Plan as Plan>::Output;
/// Input type of the robot that a pilot drives.
pub type PilotInput<B> = <<B as Pilot>::Plan as Plan>::Input;

/// A supervisor's change of the input of a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intervention<'a> {
    /// Strength of the change.
    pub verdict: Verdict,
    /// Name of the rule that caused the change.
    pub rule: &'a str,
    /// Quantity that the rule limited, for reports of [`Verdict::Limited`].
    pub limited: Option<LimitedQuantity>,
}

/// A quantity of an input that a rule limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedQuantity {
    /// Name of the quantity, such as `speed`.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// Value in the input that the plan requested.
    pub asked: f64,
    /// Value in the input that is sent to the robot.
    pub sent: f64,
}

/// Strength of an intervention; the weakest comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The robot is sent a weaker input of the same kind.
    Limited,
    /// The robot is prevented from driving forwards; the plan continues.
    HeldForward,
    /// The robot is prevented from doing what the plan requests; the plan continues.
    Held,
    /// Another plan begins in the next turn: the plan that [`Supervision::diversions`] creates for this number.
    Diverted(usize),
    /// The plan is ended, and the robot is stopped.
    Ended,
}

impl Verdict {
    /// Returns the word that a log uses for the verdict.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Limited => "limited",
            Self::HeldForward => "held forward",
            Self::Held => "held",
            Self::Diverted(_) => "diverted",
            Self::Ended => "ended",
        }
    }
}

impl fmt::Display for Intervention<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rule = self.rule;
        match (self.verdict, self.limited) {
            (Verdict::Limited, Some(LimitedQuantity { name, unit, asked, sent })) => {
                let [asked, sent] = [asked, sent].map(shown);
                if rule == name {
                    write!(f, "{name} {asked} {unit} limited to {sent} {unit}")
                } else {
                    write!(f, "{rule} limits {name} {asked} {unit} to {sent} {unit}")
                }
            }
            (Verdict::Limited, None) => write!(f, "{rule} limits the input"),
            (Verdict::HeldForward, _) => write!(f, "{rule} holds the robot from driving forwards"),
            (Verdict::Held, _) => write!(f, "{rule} holds the robot"),
            (Verdict::Diverted(_), _) => write!(f, "{rule} replaces the plan"),
            (Verdict::Ended, _) => write!(f, "{rule} ends the plan"),
        }
    }
}

/// Rounds a value to three decimals, for users.
fn shown(value: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (value * 1000.0).round() / 1000.0 + 0.0
}

/// The break between two turns.
pub struct Break<'b, B: Pilot> {
    /// Number of turns that have been made.
    pub turns: u64,
    /// Time of the last turn; zero before the first turn.
    pub t: Nanos,
    /// Output of the last turn; at the break before the first turn, the output for the first turn.
    pub y: &'b PilotOutput<B>,
    /// Input that will be sent to the robot next.
    pub input: &'b PilotInput<B>,
    /// `true` if the plan has ended, so that this is the last break.
    pub is_over: bool,
    /// The pilot, which accepts requests.
    pub pilot: &'b mut B,
    /// Settings of the robot; `None` if the robot has no settings.
    pub settings: Option<&'b mut dyn RobotSettings>,
    pub(crate) course: &'b RunCourse,
    /// Lateness and duration of the turns; `None` in stepped time, and before the second turn.
    pub(crate) timing: Option<&'b Timing>,
}

impl<B: Pilot> Break<'_, B> {
    /// Returns the position in the plan; `None` before the first turn.
    #[must_use]
    pub fn position(&self) -> Option<PlanPosition<'_>> {
        let machine = self.pilot.machine()?;
        Some(standing(machine, self.t, self.pilot.zero(), self.course))
    }

    /// Returns the lateness of the turns up to the last one; `None` in stepped time, and before the second turn.
    #[must_use]
    pub fn lateness(&self) -> Option<Lateness> {
        self.timing.map(Timing::lateness)
    }
}

impl<B: Pilot> fmt::Debug for Break<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Break {{ turns: {}, t: {:?}, is_over: {} }}", self.turns, self.t, self.is_over)
    }
}

/// Changes to a run that a supervisor requests at a break.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BreakOrders {
    /// New pace of a run in stepped time, which is independent of the wall clock; `None` if the pace does not change.
    /// The pace has no effect on a run that follows the wall clock.
    pub pace: Option<Pace>,
    /// `true` if the run has to end: the robot is stopped, and the exit status is 0.
    pub end: bool,
}

/// Supervisor of a run, and the plans that it may start in place of the running plan.
pub struct Supervision<'s, B: Pilot> {
    /// Function that creates the supervisor of a run.
    pub supervisor: &'s MakeSupervisor<'s, B>,
    /// Function that creates the plan with this number for [`Verdict::Diverted`]; it returns `None` if there is no such
    /// plan.
    pub diversions: &'s (dyn Fn(usize) -> Option<B::Plan> + Sync),
    /// Stream for the report and messages of a session, because the session uses standard output itself. A session is a
    /// single run.
    pub session: Option<BorrowedFd<'s>>,
}

/// A function that creates the supervisor of a run, given the terms of the run.
pub type MakeSupervisor<'s, B> = dyn Fn(&RunTerms) -> Box<dyn Supervisor<B> + 's> + Sync + 's;

impl<B: Pilot> Clone for Supervision<'_, B> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B: Pilot> Copy for Supervision<'_, B> {}

impl<B: Pilot> fmt::Debug for Supervision<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Supervision").field("session", &self.session).finish_non_exhaustive()
    }
}
