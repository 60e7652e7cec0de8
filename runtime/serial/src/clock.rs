//! The time of a robot's outputs, by the clock or in lockstep.

use std::time::{Duration, Instant};

use mdle_host::StopRequest;
use mdle_runtime::Nanos;

/// Where the time of an output comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clock {
    /// The time that has passed since the first output.
    Wall,
    /// So much for each output: a robot in lockstep.
    Stepped(Duration),
}

/// In lockstep a robot takes as long as its machine makes it, and stands meanwhile: it is waited for so much longer.
const LONGER: u32 = 10;

impl Clock {
    /// How long to wait, by the clock, for what may take a robot so long.
    #[must_use]
    pub const fn patience(self, limit: Duration) -> Duration {
        match self {
            Self::Wall => limit,
            Self::Stepped(_) => limit.saturating_mul(LONGER),
        }
    }

    /// Whether for the robot so much time has passed since `begun`, in which it was told so many commands.
    #[must_use]
    pub fn is_past(self, limit: Duration, begun: Instant, commands: u32) -> bool {
        match self {
            Self::Wall => begun.elapsed() >= limit,
            Self::Stepped(period) => period.saturating_mul(commands) >= limit,
        }
    }

    /// Lets time pass, unless it passes with what the robot is told.
    pub fn pass(self, time: Duration) {
        match self {
            Self::Wall => std::thread::sleep(time),
            Self::Stepped(_) => {}
        }
    }

    /// Lets time pass as [`Clock::pass`] does, but not after `request` is made.
    pub fn pass_unless(self, request: &StopRequest, time: Duration) {
        match self {
            Self::Wall => request.wait(time),
            Self::Stepped(_) => {}
        }
    }
}

/// The times of outputs, from the first one on.
#[derive(Debug)]
pub struct Times {
    clock: Clock,
    /// When the first output was taken, and how many there have been.
    first: Option<Instant>,
    outputs: u64,
}

impl Times {
    /// Before the first output.
    #[must_use]
    pub const fn new(clock: Clock) -> Self {
        Self { clock, first: None, outputs: 0 }
    }

    /// The time of the output that has just come.
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
