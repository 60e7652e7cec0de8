//! The supervisor of a run: code between a plan and its robot, such as a safety envelope or a session with an operator.
//! See docs/src/reference/interfaces.md, 7.6.

use std::fmt;

use mdle_runtime::{Nanos, Plan};

use crate::{Pace, PlanPosition, RunTerms};

/// Decides which input a robot is sent, and is called between the turns of a run.
///
/// It runs on the thread that drives the robot: a real robot waits for it.
pub trait Supervisor<Y, U> {
    /// Returns the input that the robot is sent instead of `asked`, the plan's input of the turn with output `y` at
    /// time `t`. Every input passes here, also the null inputs of a turn that is cut and of the end, but for the one
    /// before the first output.
    fn filter(&mut self, asked: U, _y: &Y, _t: Nanos) -> U {
        asked
    }

    /// Returns what the last [`Supervisor::filter`] did; `None` if it passed the plan's input on.
    fn intervention(&self) -> Option<Intervention<'_>> {
        None
    }

    /// Called before the first turn and after each turn, when the input of the turn has not been sent yet. A call that
    /// takes long delays the robot; in stepped time it may wait as long as it likes.
    fn at_break(&mut self, _moment: &Break<'_, Y, U>) -> Orders {
        Orders::default()
    }
}

/// A change that a supervisor made to the input of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Intervention<'a> {
    /// Strength of the change.
    pub verdict: Verdict,
    /// Name of the rule that asked for it.
    pub rule: &'a str,
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
        let what = match self.verdict {
            Verdict::Limited => "limits the input",
            Verdict::Held => "holds the robot",
            Verdict::Diverted(_) => "replaces the plan",
            Verdict::Ended => "ends the plan",
        };
        write!(f, "{} {what}", self.rule)
    }
}

/// The moment between two turns.
#[derive(Clone, Copy)]
pub struct Break<'b, Y, U> {
    /// Number of turns that have been made.
    pub turns: u64,
    /// Time of the last turn; zero before the first.
    pub t: Nanos,
    /// Output of the last turn, or that of the first turn before it.
    pub y: &'b Y,
    /// The input that the robot will be sent next.
    pub input: &'b U,
    /// `true` if the plan is over: this is the last break.
    pub is_over: bool,
    /// Returns the place in the plan; `None` before the first turn.
    pub position: &'b dyn Fn() -> Option<PlanPosition<'b>>,
}

impl<Y, U> fmt::Debug for Break<'_, Y, U> {
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
pub struct Supervision<'s, P: Plan> {
    /// Makes the supervisor of a run.
    pub supervisor: &'s MakeSupervisor<'s, P::Output, P::Input>,
    /// Makes the plan of this number, to which [`Verdict::Diverted`] leads; `None` if there is no such plan.
    pub diversions: &'s (dyn Fn(usize) -> Option<P> + Sync),
    /// `true` for a session: one run only, whose report goes to standard error, as standard output is the session's.
    pub session: bool,
}

/// Makes the supervisor of a run with these terms.
pub type MakeSupervisor<'s, Y, U> = dyn Fn(&RunTerms) -> Box<dyn Supervisor<Y, U> + 's> + Sync + 's;

impl<P: Plan> Clone for Supervision<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P: Plan> Copy for Supervision<'_, P> {}

impl<P: Plan> fmt::Debug for Supervision<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Supervision").field("session", &self.session).finish_non_exhaustive()
    }
}
