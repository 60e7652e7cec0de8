//! The observer of a run. It informs a robot, such as a simulated one, about the course of the plan that drives the
//! robot. A driver of a real robot needs no observer. See docs/src/reference/interfaces.md, 7.4.

use std::fmt;

use mdle_runtime::Nanos;

/// Follows the course of a plan on a robot, for example to draw pictures, to show a live view, or to check a goal.
pub trait Observer {
    /// Called when an atom begins, in the turn at time `t` in which its law is applied. `number` is the number of the
    /// atom's state in the first pass of all enclosing loops, so it is the same in every pass.
    fn began(&mut self, _number: u64, _law: &str, _t: Nanos) {}

    /// Called at the end of the turns of a run; the robot has not been stopped yet.
    fn ended(&mut self, _ended: &Ended<'_>) {}

    /// Returns `true` if [`Observer::turned`] has to be called.
    fn looks(&self) -> bool {
        false
    }

    /// Called after a turn, with the position in the plan.
    fn turned(&mut self, _standing: &PlanPosition<'_>) {}

    /// Returns the result of a run whose plan has ended; `None` if the run has no goal. Called after the robot was
    /// stopped.
    fn judged(&self) -> Option<Judgement> {
        None
    }

    /// Returns the number of contacts with obstacles so far.
    fn contacts(&self) -> u64 {
        0
    }

    /// Writes the requested files, such as a plot. Called once, after the robot was stopped, at every orderly end of a
    /// run.
    ///
    /// # Errors
    /// Returns a message for the operator if a file could not be written.
    fn finish(&mut self) -> Result<(), String> {
        Ok(())
    }
}

/// A function that returns the observer of a robot; `None` if the robot has no observer.
pub(crate) type Observes<R> = Option<fn(&mut R) -> &mut dyn Observer>;

/// The position in a plan after a turn that did not end the plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanPosition<'a> {
    /// Time of the turn.
    pub t: Nanos,
    /// Number of the current atom's state.
    pub state: u64,
    /// Text of the current atom's law.
    pub law: &'a str,
    /// Position of the atom in the plan's text: its line, the names of its enclosing scopes and the passes of loops,
    /// such as `patrol.mdle:12, Leg, pass 3 of 5`; empty for a plan that was written in Rust.
    pub place: String,
    /// Reason why the atom runs: the operands that fired, with their values; empty for the plan's first atom.
    pub since: &'a str,
    /// Scopes that enclose the atom, from the outermost (the plan) to the atom's own scope.
    pub scopes: Vec<EnclosingScope<'a>>,
}

/// The end of a run's turns, described for people.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ended<'a> {
    /// Name of the plan; empty if the plan has no name.
    pub plan: &'a str,
    /// `true` if the plan has ended, `false` if it was stopped before.
    pub is_over: bool,
    /// Cause of the end, such as `bumper (Patrol)` or `--timeout`.
    pub by: &'a str,
    /// Time of the last turn.
    pub t: Nanos,
}

/// A scope that encloses the current atom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EnclosingScope<'a> {
    /// Name of the scope; empty for an atom.
    pub name: &'a str,
    /// Text of the condition of the scope's interrupt.
    pub condition: &'a str,
    /// Time since the scope was entered.
    pub since: Nanos,
}

/// Result of a run with a goal, after its plan has ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Judgement {
    /// The robot is in its goal, and touches no obstacle.
    Arrived,
    /// The robot touches an obstacle.
    Bumped,
    /// The robot is outside its goal; the text says where the robot is.
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
