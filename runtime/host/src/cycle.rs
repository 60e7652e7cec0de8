//! The control cycle: exchange with the robot, reading of the time, turn, and wait for the next turn
//! (docs/src/reference/semantics.md, 5.1).
//!
//! In an executable, only a plan takes part in a turn; in other programs, an engine also runs modules. For both, the
//! cycle handles exchange, limits, signals and the end of a run.

use std::time::Duration;

use mdle_runtime::Nanos;

use crate::Pace;
use crate::clock::Clock;
use crate::instants::{Instants, nanos};
use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::timing::Timing;

/// Limits that end a run before its plan has ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RunLimits {
    /// Time of the run at which the run ends. The turn at exactly this time is still made, because the plan may end in
    /// it.
    pub(crate) timeout: Option<Duration>,
    /// Number of turns after which the run ends.
    pub(crate) turns: Option<u64>,
}

/// Result of a turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TurnEnd {
    /// The run continues.
    Next,
    /// The run ends: the null input is sent once more, and then the robot is stopped.
    Over,
}

/// A robot, together with the code that makes its turns.
pub(crate) trait Turns {
    /// Sends the input of the last turn, or the null input before the first turn, and reads the next output.
    ///
    /// # Errors
    /// Returns a message for the operator if the robot has a fault.
    fn exchange(&mut self) -> Result<(), String>;
    /// Makes turn `number`, counted from 0, with the output that was read at `t`. `timing` describes the previous
    /// turns; `None` in stepped time, and before the first turn.
    ///
    /// # Errors
    /// Returns the reason if the run must end although the robot has no fault.
    fn turn(&mut self, t: Nanos, number: u64, timing: Option<&Timing>) -> Result<TurnEnd, RunEnd>;
    /// Returns the new pace of stepped time; `None` if the pace does not change.
    fn pace(&mut self) -> Option<Pace> {
        None
    }
    /// Reports the lateness and the duration of turns, because SIGUSR1 requested this report.
    fn tell_timing(&mut self, timing: &Timing);
    /// Handles the end of the cycle. The last turn was at time `t`, and the robot has not been stopped yet.
    fn ended(&mut self, ending: &RunEnd, t: Nanos, timing: Option<&Timing>);
}

/// Makes turns, from the exchange of turn 0, until the run ends.
///
/// The robot still executes its last input: the caller must send the null input and stop the robot, also after a panic.
pub(crate) fn cycle<I: Instants>(
    turns: &mut dyn Turns,
    limits: RunLimits,
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
        match turns.turn(t, number, clock.timing()) {
            Ok(TurnEnd::Next) => {}
            Ok(TurnEnd::Over) => break RunEnd::Over,
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
    turns.ended(&ending, t, clock.timing());
    ending
}

impl RunLimits {
    /// Returns the limit that a run has reached after `turns` turns; the last turn was at time `t`, and the plan has
    /// not ended.
    fn reached(&self, turns: u64, t: Nanos) -> Option<RunEnd> {
        let timeout = self.timeout.filter(|limit| t.0 >= nanos(*limit)).map(RunEnd::Timeout);
        timeout.or(self.turns.filter(|limit| turns >= *limit).map(RunEnd::Turns))
    }
}
