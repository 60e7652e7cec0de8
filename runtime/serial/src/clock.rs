//! Determines the time of a robot's outputs, either by the computer's clock or in lockstep.

use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::Nanos;

/// Source of the time of an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// The computer's clock. The time of an output is the time since the first output.
    Wall,
    /// Lockstep: time advances by this duration with each output.
    Stepped(Duration),
}

/// Factor by which timeouts are longer in lockstep. There, an answer may take as long as the robot's computer needs,
/// because the robot stands still meanwhile.
const LONGER: u32 = 10;

impl Clock {
    /// Returns the timeout, by the computer's clock, for an action that the robot has to complete within `limit`.
    #[must_use]
    pub const fn patience(self, limit: Duration) -> Duration {
        match self {
            Self::Wall => limit,
            Self::Stepped(_) => limit.saturating_mul(LONGER),
        }
    }

    /// Returns `true` if the time `limit` has passed for the robot since `begun`. In lockstep, this time depends on
    /// `commands`, the number of commands that the robot has received since then.
    #[must_use]
    pub fn is_past(self, limit: Duration, begun: Instant, commands: u32) -> bool {
        match self {
            Self::Wall => begun.elapsed() >= limit,
            Self::Stepped(period) => period.saturating_mul(commands) >= limit,
        }
    }

    /// Waits for `time`. Returns immediately in lockstep, where time advances with the commands to the robot.
    pub fn pass(self, time: Duration) {
        match self {
            Self::Wall => std::thread::sleep(time),
            Self::Stepped(_) => {}
        }
    }

    /// Waits as [`Clock::pass`] does, but only until `request` is made.
    pub fn pass_unless(self, request: &StopRequest, time: Duration) {
        match self {
            Self::Wall => request.wait(time),
            Self::Stepped(_) => {}
        }
    }
}

/// Clock for the outputs of a run.
#[derive(Debug)]
pub struct Times {
    clock: Clock,
    /// Time of the first output, by the computer's clock; `None` before the first output.
    first: Option<Instant>,
    /// Number of outputs that have arrived so far.
    outputs: u64,
}

impl Times {
    /// Creates the clock of a run before its first output.
    #[must_use]
    pub const fn new(clock: Clock) -> Self {
        Self { clock, first: None, outputs: 0 }
    }

    /// Returns the time of the output that has just arrived.
    pub fn now(&mut self) -> Nanos {
        let outputs = self.outputs;
        self.outputs = outputs.saturating_add(1);
        let passed = match self.clock {
            Clock::Wall => self.first.get_or_insert_with(Instant::now).elapsed(),
            Clock::Stepped(period) => period.saturating_mul(u32::try_from(outputs).unwrap_or(u32::MAX)),
        };
        Nanos(u64::try_from(passed.as_nanos()).unwrap_or(u64::MAX))
    }
}
