//! Observer of a run: a simulated robot's view of its own run, which a driver of a real robot does not need. See
//! docs/src/reference/interfaces.md, 7.4.

use std::fmt;

use mdle_runtime::Nanos;

/// Follows the course of a plan on a robot: for pictures, a live view, or a goal.
pub trait Observer {
    /// An atom began in the turn at time `t`, and its law is now applied. `number` is its state in the first pass of
    /// the loops around it, so that every pass of an atom as written has one number.
    fn began(&mut self, _number: u64, _law: &str, _t: Nanos) {}

    /// The turns of the run have ended; the robot has not been stopped yet.
    fn ended(&mut self, _ended: &Ended<'_>) {}

    /// Returns `true` if [`Observer::turned`] is to be called.
    fn looks(&self) -> bool {
        false
    }

    /// A turn was made, and this is where the plan stands.
    fn turned(&mut self, _standing: &PlanPosition<'_>) {}

    /// Returns the result of a run whose plan is over; `None` if the run has no goal. Called after the robot was
    /// stopped.
    fn judged(&self) -> Option<Judgement> {
        None
    }

    /// Returns the number of contacts with obstacles so far.
    fn contacts(&self) -> u64 {
        0
    }

    /// Writes the requested files, such as a plot. Called once after the robot was stopped, at every orderly end of a
    /// run.
    ///
    /// # Errors
    /// A sentence for the operator about what could not be written.
    fn finish(&mut self) -> Result<(), String> {
        Ok(())
    }
}

/// Returns the observer of a robot.
pub(crate) type Observes<R> = Option<fn(&mut R) -> &mut dyn Observer>;

/// The place in a plan after a turn that did not end it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanPosition<'a> {
    /// The time of the turn.
    pub t: Nanos,
    /// The number of the current atom's state.
    pub state: u64,
    /// The quark text of its law.
    pub law: &'a str,
    /// The atom's line, the names of its enclosing scopes and the passes of loops: `patrol.mdle:12, Leg, pass 3 of 5`;
    /// empty for a plan that was written in Rust.
    pub place: String,
    /// The reason for which it runs: the operands that fired, with their values; empty for the plan's first.
    pub since: &'a str,
    /// The scopes around it, the plan first and the atom last.
    pub scopes: Vec<Around<'a>>,
}

/// The end of a run's turns, for a person.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ended<'a> {
    /// Name of the plan; empty if it has none.
    pub plan: &'a str,
    /// `true` if the plan is over, `false` if it was stopped before.
    pub is_over: bool,
    /// Cause of the end, such as `bumper (Patrol)` or `--timeout`.
    pub by: &'a str,
    /// Time of the last turn.
    pub t: Nanos,
}

/// A scope around the current atom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Around<'a> {
    /// The scope's name; empty for an atom.
    pub name: &'a str,
    /// The condition text of its interrupt.
    pub condition: &'a str,
    /// Time since the scope was entered.
    pub since: Nanos,
}

/// Result of a run with a goal whose plan is over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Judgement {
    /// The robot is in its goal, and touches nothing.
    Arrived,
    /// The robot touches an obstacle.
    Bumped,
    /// The robot is outside its goal; a few words that say where.
    Astray(String),
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Arrived => write!(f, "arrived"),
            Self::Bumped => write!(f, "bumped"),
            Self::Astray(place) => write!(f, "astray at {place}"),
        }
    }
}
