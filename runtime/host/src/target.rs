//! Interface of a target to the host: its options, its robot and its time. See docs/src/reference/interfaces.md, 7.3.

use std::fmt;
use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::{Nanos, Robot};

use crate::{Batch, NamedFile, Replays, StopRequest};

/// A robot that executables are built for; implemented once in each target crate.
pub trait Target {
    /// The name of the target, as `mdlec --target` takes it.
    const NAME: &'static str;
    /// The period of a turn unless `--period` says otherwise.
    const PERIOD: Duration;
    /// The robot.
    type Robot: Hosted + 'static;
    /// Functions to replay and to record paths, if the alphabet has the capability `paths`: the executable then takes
    /// `--paths` and `--record-path`.
    const PATHS: Option<Replays<Self::Robot>> = None;

    /// Adds the target's own options to the executable's.
    fn arguments(command: Command) -> Command;

    /// Returns the time of this robot with these options: real or stepped.
    ///
    /// # Errors
    /// A sentence for the operator about an option that makes no sense.
    fn time(matches: &ArgMatches) -> Result<Time, String>;

    /// Opens the robot; no motion yet.
    ///
    /// From the call on, signals no longer end the program: they make `request`. A robot that opens at once ignores it,
    /// and the host stops the robot before its first turn. A robot that takes longer checks `request` between its
    /// steps, and when it is made, stops and returns [`Refusal::Ended`].
    ///
    /// # Errors
    /// A bad option (exit status 2), a fault (exit status 3), or `request`.
    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Self::Robot, Refusal>;

    /// Returns the files that the target's own options name: the host refuses to write a file that another option names
    /// too.
    fn files(_matches: &ArgMatches) -> Vec<NamedFile> {
        Vec::new()
    }

    /// Returns the text to print instead of a run, if these options ask for something that needs no run.
    ///
    /// # Errors
    /// Why there is no answer: a bad option (exit status 2).
    fn answer(_matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        Ok(None)
    }

    /// Returns `true` if the robot shows its run on standard output itself, as with a live view: the report then waits
    /// until the robot is stopped, and the robot leaves the screen when it is stopped.
    fn screen(_matches: &ArgMatches) -> bool {
        false
    }

    /// Gives the terminal back, if [`Target::screen`] took it. Called on another thread when the program ends while the
    /// robot's code hangs: it must neither wait nor panic.
    fn leave_screen() {}

    /// The runs to be made instead of one, if these options ask for several: only robots that can be started over have
    /// such options. No run has begun yet.
    ///
    /// # Errors
    /// Why there are no such runs: a bad option (exit status 2) or a fault (exit status 3).
    fn batch(_matches: &ArgMatches, _period: Duration) -> Result<Option<Batch<Self::Robot>>, Refusal> {
        Ok(None)
    }
}

/// Time of a robot: real or stepped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// Time of the wall clock, read after each exchange.
    Wall,
    /// Turn `k` is at `k` periods exactly, independent of the wall clock: a simulated world.
    Stepped(Pace),
}

/// Pace of stepped time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// This many times as fast as the wall clock; positive and finite.
    Times(f64),
    /// The fastest pace possible.
    Max,
}

/// Why a robot could not be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// An option, a world or a start pose is no good.
    Usage(String),
    /// The robot does not answer, or answers that it cannot run.
    Fault(String),
    /// The run was asked to end while the robot was opened. The robot was stopped; if not, a sentence with the reason
    /// (exit status 3).
    Ended(Result<(), String>),
}

/// State of a plan after a turn in which it was not over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Standing<'a> {
    /// The time of the turn.
    pub t: Nanos,
    /// The number of the current atom's state.
    pub state: u64,
    /// The quark text of its law.
    pub law: &'a str,
    /// Line of the atom, names of its enclosing scopes and passes of loops: `patrol.mdle:12, Leg, pass 3 of 5`; empty
    /// for a plan that was written in Rust.
    pub place: String,
    /// The reason for which it runs: the operands that fired, with their values; empty for the plan's first.
    pub since: &'a str,
    /// The scopes that enclose the atom, the plan first and the atom's own last.
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

/// A scope that encloses the current atom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Around<'a> {
    /// Name of the scope; empty for an atom.
    pub name: &'a str,
    /// The condition text of its interrupt.
    pub condition: &'a str,
    /// Time since the scope was entered.
    pub since: Nanos,
}

/// Result of a run whose plan is over, for a robot that was to come to a goal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Judgement {
    /// The robot is in its goal, and touches nothing.
    Arrived,
    /// The robot touches something.
    Bumped,
    /// The robot is outside its goal; a few words on its place.
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

/// A robot that an executable drives: besides the exchange it may follow what the plan does.
pub trait Hosted: Robot {
    /// Reports that an atom began in the turn at time `t`, and that its law is now applied. `number` is its state in
    /// the first pass of its enclosing loops, so that every pass of an atom as written has one number.
    fn began(&mut self, _number: u64, _law: &str, _t: Nanos) {}

    /// Reports that the turns of the run have ended; the robot has not been stopped yet.
    fn ended(&mut self, _ended: &Ended<'_>) {}

    /// Returns `true` if [`Hosted::turned`] is to be called.
    fn looks(&self) -> bool {
        false
    }

    /// Reports the state of the plan after a turn.
    fn turned(&mut self, _standing: &Standing<'_>) {}

    /// Returns the longest time without a command after which the robot is still driven on, by the wall clock: the time
    /// of its own watchdog, or the time for which its data stay fresh. After a longer gap, as when the program was
    /// suspended, the run ends with a fault before a command is sent. `None` for two seconds more than the period.
    /// Simulated time has no gaps.
    fn longest_gap(&self) -> Option<Duration> {
        None
    }

    /// Returns the result of a run whose plan is over; `None` if the robot has no goal. Called after the robot was
    /// stopped.
    fn judged(&self) -> Option<Judgement> {
        None
    }

    /// Returns the number of times that the robot has come into contact with something so far.
    fn contacts(&self) -> u64 {
        0
    }

    /// Called once after the robot was stopped, on every orderly way out: write what was asked for, such as a plot.
    ///
    /// # Errors
    /// A sentence for the operator about what could not be written.
    fn finish(&mut self) -> Result<(), String> {
        Ok(())
    }
}
