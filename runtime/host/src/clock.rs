//! Clock of a run, which determines the start and the time of each turn (docs/src/reference/semantics.md, 3.1).
//!
//! Turns begin at absolute deadlines, so delays do not add up. With a real robot, missed turns are skipped, so the
//! robot never receives a burst of inputs. In stepped time, no turn is skipped: late turns follow each other without a
//! pause.

#[cfg(test)]
mod tests;

use std::time::Duration;

use mdle_runtime::Nanos;

use crate::instants::{Instants, nanos};
use crate::run_end::RunEnd;
use crate::signals::Signals;
use crate::timing::Timing;
use crate::{Pace, Time};

/// Maximum sleep between two checks for signals.
const SLICE: Duration = Duration::from_millis(20);
/// Maximum delay, in nanoseconds, that stepped time makes up for. After a longer delay, for example because the process
/// was suspended, turns continue from the current time.
const CATCH_UP: u64 = 250_000_000;

/// Maximum delay of a turn if the robot does not limit the time without a command.
const GAP: Duration = Duration::from_secs(2);

/// Clock of a run.
#[derive(Debug)]
pub(crate) struct Clock<I> {
    instants: I,
    time: Time,
    /// Period of a turn in nanoseconds; at least 1.
    period: u64,
    /// Start of turn 0, or of the turn in which the pace was changed last, in real nanoseconds. In stepped time, delays
    /// that later turns do not make up for are added.
    origin: u64,
    /// Real time of the first output, in nanoseconds: time 0 of the plan.
    zero: u64,
    /// Number of periods from the start of turn 0 to the start of the current turn.
    place: u64,
    /// Number of periods from the start of turn 0 to the last change of the pace.
    paced_from: u64,
    /// Start of the current turn, in real nanoseconds.
    begun: u64,
    /// Maximum time between two commands to a robot in real time, in nanoseconds.
    longest_gap: u64,
    timing: Timing,
}

impl<I: Instants> Clock<I> {
    /// Returns the clock of a run whose turn 0 begins now. The robot can be without a command for `longest_gap`; the
    /// default is two seconds more than a period.
    pub(crate) fn begin(mut instants: I, time: Time, period: Duration, longest_gap: Option<Duration>) -> Self {
        let origin = nanos(instants.now());
        let longest_gap = nanos(longest_gap.unwrap_or(period.saturating_add(GAP)));
        let period = nanos(period).max(1);
        let timing = Timing::new(period);
        Self {
            instants,
            time,
            period,
            origin,
            zero: origin,
            place: 0,
            paced_from: 0,
            begun: origin,
            longest_gap,
            timing,
        }
    }

    /// Records that the first output has been read, at the plan's time 0.
    pub(crate) fn zero(&mut self) -> Nanos {
        self.zero = nanos(self.instants.now());
        Nanos::ZERO
    }

    /// Returns the time, on the plan's clock, of the output that has just been read.
    pub(crate) fn taken(&mut self) -> Nanos {
        match self.time {
            Time::Wall => Nanos(nanos(self.instants.now()).saturating_sub(self.zero)),
            Time::Stepped(_) => Nanos(self.place.saturating_mul(self.period)),
        }
    }

    /// Changes the pace of stepped time; the next turn begins one period from now, at the new pace. Has no effect on
    /// the wall clock, which has only one pace.
    pub(crate) fn set_pace(&mut self, pace: Pace) {
        let Time::Stepped(before) = &mut self.time else { return };
        *before = pace;
        self.origin = nanos(self.instants.now());
        self.paced_from = self.place;
    }

    /// Returns the lateness and the durations of the turns; `None` in stepped time, and before the first turn.
    pub(crate) fn timing(&self) -> Option<&Timing> {
        Some(&self.timing).filter(|timing| self.time == Time::Wall && timing.has_turns())
    }

    /// Waits for the beginning of the next turn.
    ///
    /// # Errors
    /// Fails if a signal has arrived, which ends the wait early, if too many consecutive turns were longer than the
    /// period, or if the robot was without a command for too long.
    pub(crate) fn next_turn(&mut self, signals: &Signals) -> Result<(), RunEnd> {
        if self.time == Time::Wall {
            let took = nanos(self.instants.now()).saturating_sub(self.begun);
            self.timing.took(took).map_err(RunEnd::Overrun)?;
        }
        let deadline = self.deadline();
        loop {
            if let Some(signal) = signals.caught() {
                return Err(RunEnd::Signal(signal));
            }
            let Some(deadline) = deadline else { return Ok(()) };
            let now = nanos(self.instants.now());
            let left = deadline.saturating_sub(now);
            if left == 0 {
                let gap = now.saturating_sub(self.begun);
                if self.time == Time::Wall && gap > self.longest_gap {
                    return Err(RunEnd::Suspended { gap, longest: self.longest_gap });
                }
                self.begun = now;
                self.timing.begins(now.saturating_sub(deadline));
                return Ok(());
            }
            self.instants.sleep(Duration::from_nanos(left).min(SLICE));
        }
    }

    /// Advances to the next turn. Returns the start of this turn in real nanoseconds; `None` if it starts without a
    /// wait.
    fn deadline(&mut self) -> Option<u64> {
        self.place = self.place.saturating_add(1);
        match self.time {
            Time::Wall => {
                let passed = nanos(self.instants.now()).saturating_sub(self.origin);
                let place = self.place.max(passed.div_ceil(self.period));
                self.timing.misses(place.saturating_sub(self.place));
                self.place = place;
                Some(self.origin.saturating_add(self.place.saturating_mul(self.period)))
            }
            Time::Stepped(Pace::Times(times)) => {
                // The conversion saturates, and is exact up to 2^53 nanoseconds, which are three months.
                let places = self.place.saturating_sub(self.paced_from);
                let after = (places as f64 * self.period as f64 / times) as u64;
                let late = nanos(self.instants.now()).saturating_sub(self.origin.saturating_add(after));
                if late > CATCH_UP {
                    self.origin = self.origin.saturating_add(late);
                }
                Some(self.origin.saturating_add(after))
            }
            Time::Stepped(Pace::Max) => None,
        }
    }
}
