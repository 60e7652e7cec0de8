//! The supervisor of a run: code between a plan and its robot, such as a safety envelope or a session with an operator.
//! See docs/src/reference/interfaces.md, 7.6.

use std::fmt;
use std::os::fd::BorrowedFd;

use mdle_record::Change;
use mdle_runtime::{Nanos, Plan};

use crate::standing::{Course, standing};
use crate::{Pace, Pilot, PlanPosition, RobotSettings, RunTerms};

/// Decides which input a robot is sent, and is called between the turns that the pilot `B` makes.
///
/// It runs on the thread that drives the robot: a real robot waits for it.
pub trait Supervisor<B: Pilot> {
    /// Returns the input that the robot is sent instead of `asked`, the plan's input of the turn with output `y` at
    /// time `t`. Every input passes here, also the null inputs of a turn that is cut and of the end, but for the one
    /// before the first output.
    fn filter(&mut self, asked: PilotInput<B>, _y: &PilotOutput<B>, _t: Nanos) -> PilotInput<B> {
        asked
    }

    /// Returns what the last [`Supervisor::filter`] did; `None` if it passed the plan's input on.
    fn intervention(&self) -> Option<Intervention<'_>> {
        None
    }

    /// Called before the first turn and after each turn, when the input of the turn has not been sent yet. A call that
    /// takes long delays the robot; in stepped time it may wait as long as it likes.
    fn at_break(&mut self, _moment: &mut Break<'_, B>) -> Orders {
        Orders::default()
    }

    /// Notes from now on what [`Supervisor::take_changes`] returns: called before the first turn of a run that is
    /// recorded.
    fn record(&mut self) {}

    /// Takes the changes of the supervisor's rules before the last turn.
    fn take_changes(&mut self) -> Vec<Change> {
        Vec::new()
    }

    /// Repeats a change of the supervisor's rules, when a run is made again.
    fn repeat(&mut self, _change: &Change) {}

    /// Returns the requests that were carried out at breaks since the last call, for the log.
    fn take_requests(&mut self) -> Vec<String> {
        Vec::new()
    }
}

/// Output of the robot that a pilot drives.
pub type PilotOutput<B> = <<B as Pilot>::Plan as Plan>::Output;
/// Input of the robot that a pilot drives.
pub type PilotInput<B> = <<B as Pilot>::Plan as Plan>::Input;

/// A change that a supervisor made to the input of a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intervention<'a> {
    /// Strength of the change.
    pub verdict: Verdict,
    /// Name of the rule that asked for it.
    pub rule: &'a str,
    /// The quantity that the rule limited, for reports of [`Verdict::Limited`].
    pub limited: Option<LimitedQuantity>,
}

/// A quantity of an input that a rule limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedQuantity {
    /// Name of the quantity, such as `speed`.
    pub name: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// Value that the plan asked for.
    pub asked: f64,
    /// Value that the robot is sent.
    pub sent: f64,
}

/// The strengths of an intervention, the weakest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// The robot is sent a weaker input of the same kind.
    Limited,
    /// The robot is kept from what the plan asks for; the plan goes on.
    Held,
    /// The next turn is the first of another plan: the number of one of [`Supervision::diversions`].
    Diverted(usize),
    /// The plan is ended and the robot stopped.
    Ended,
}

impl Verdict {
    /// Returns the verdict as a log has it.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Limited => "limited",
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
            (Verdict::Held, _) => write!(f, "{rule} holds the robot"),
            (Verdict::Diverted(_), _) => write!(f, "{rule} replaces the plan"),
            (Verdict::Ended, _) => write!(f, "{rule} ends the plan"),
        }
    }
}

/// Rounds a value to a thousandth, for people.
fn shown(value: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (value * 1000.0).round() / 1000.0 + 0.0
}

/// The moment between two turns.
pub struct Break<'b, B: Pilot> {
    /// Number of turns that have been made.
    pub turns: u64,
    /// Time of the last turn; zero before the first.
    pub t: Nanos,
    /// Output of the last turn, or that of the first turn before it.
    pub y: &'b PilotOutput<B>,
    /// The input that the robot will be sent next.
    pub input: &'b PilotInput<B>,
    /// `true` if the plan is over: this is the last break.
    pub is_over: bool,
    /// The pilot, for requests.
    pub pilot: &'b mut B,
    /// Settings of the robot, if it has any.
    pub settings: Option<&'b mut dyn RobotSettings>,
    pub(crate) course: &'b Course,
}

impl<B: Pilot> Break<'_, B> {
    /// Returns the place in the plan; `None` before the first turn.
    #[must_use]
    pub fn position(&self) -> Option<PlanPosition<'_>> {
        let machine = self.pilot.machine()?;
        Some(standing(machine, self.t, self.pilot.zero(), self.course))
    }
}

impl<B: Pilot> fmt::Debug for Break<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Break {{ turns: {}, t: {:?}, is_over: {} }}", self.turns, self.t, self.is_over)
    }
}

/// The changes to a run that a supervisor asks for at a break.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Orders {
    /// Pace from now on; ignored where time is the wall clock's.
    pub pace: Option<Pace>,
    /// `true` if the run is to end: the robot is stopped, and the exit status is 0.
    pub end: bool,
}

/// The supervisors of runs, and the plans to which they may divert.
pub struct Supervision<'s, B: Pilot> {
    /// Makes the supervisor of a run.
    pub supervisor: &'s MakeSupervisor<'s, B>,
    /// Makes the plan of this number, to which [`Verdict::Diverted`] leads; `None` if there is no such plan.
    pub diversions: &'s (dyn Fn(usize) -> Option<B::Plan> + Sync),
    /// The stream of the report and of messages for a session, which is one run only: standard output is the session's.
    pub session: Option<BorrowedFd<'s>>,
}

/// Makes the supervisor of a run with these terms.
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
