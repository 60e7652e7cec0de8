//! The control cycle: exchange, time, a turn, and the wait for the next (docs/src/reference/semantics.md, 5.1).
//!
//! A turn is that of one plan in an executable; others may make it from more than a plan. Exchange, limits, signals and
//! the end of a run are the cycle's in every case.

use std::time::Duration;

use mdle_runtime::Nanos;

use crate::Pace;
use crate::clock::{Clock, Instants, nanos};
use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::timing::Timing;

/// Limits at which a run ends that is not over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Time of the run at which the run ends. The turn at that time is still made, since the plan may be over in it.
    pub(crate) timeout: Option<Duration>,
    /// Number of turns after which the run ends.
    pub(crate) turns: Option<u64>,
}

/// Result of a turn for the cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Step {
    /// The run goes on.
    Next,
    /// The run is over: the null input once more, then the robot's stop.
    Over,
}

/// A robot, and the code that makes its turns.
pub(crate) trait Turns {
    /// Sends the input of the last turn, the null input before the first, and takes the output that follows.
    ///
    /// # Errors
    /// A sentence for the operator about the fault of the robot.
    fn exchange(&mut self) -> Result<(), String>;
    /// Makes turn `number`, from 0, with the output that was taken at `t`.
    ///
    /// # Errors
    /// The reason why the run has to end, though the robot is well.
    fn turn(&mut self, t: Nanos, number: u64) -> Result<Step, RunEnd>;
    /// Returns the pace of stepped time from now on, if it is to change.
    fn pace(&mut self) -> Option<Pace> {
        None
    }
    /// Reports how late turns begin and how long they take, after a request by SIGUSR1.
    fn tell_timing(&mut self, timing: &Timing);
    /// Called when the cycle ends, the last turn having been at `t`; the robot has not been stopped yet.
    fn ended(&mut self, ending: &RunEnd, t: Nanos);
}

/// Makes turns, from the exchange of turn 0 until something ends them.
///
/// The robot still executes its last input: the caller has to send the null input and the stop, also after a panic.
pub(crate) fn cycle<I: Instants>(
    turns: &mut dyn Turns,
    limits: Limits,
    clock: &mut Clock<I>,
    signals: &Signals,
) -> RunEnd {
    if let Some(signal) = signals.caught() {
        return RunEnd::Signal(signal);
    }
    if let Err(fault) = turns.exchange() {
        return RunEnd::Unstarted(fault);
    }
    let mut t = clock.zero();
    let mut number: u64 = 0;
    let ending = loop {
        match turns.turn(t, number) {
            Ok(Step::Next) => {}
            Ok(Step::Over) => break RunEnd::Over,
            Err(ending) => break ending,
        }
        number = number.saturating_add(1);
        if let Some(ending) = limits.reached(number, t) {
            break ending;
        }
        if let Some(pace) = turns.pace() {
            clock.set_pace(pace);
        }
        if signals.timing_is_asked_for()
            && let Some(timing) = clock.timing()
        {
            turns.tell_timing(timing);
        }
        if let Err(ending) = clock.next_turn(signals) {
            break ending;
        }
        if let Err(fault) = turns.exchange() {
            break RunEnd::Robot(fault);
        }
        t = clock.taken();
    };
    turns.ended(&ending, t);
    ending
}

impl Limits {
    /// Returns the limit that a run has reached, if it is not over after `turns` turns, the last one at time `t`.
    fn reached(&self, turns: u64, t: Nanos) -> Option<RunEnd> {
        let timeout = self.timeout.filter(|limit| t.0 >= nanos(*limit)).map(RunEnd::Timeout);
        timeout.or(self.turns.filter(|limit| turns >= *limit).map(RunEnd::Turns))
    }
}
