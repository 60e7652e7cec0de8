//! Time source of a run: the host's clock, lockstep with the robot, or the clock of a simulation.

use std::time::Duration;

use mdle_host::{Pace, Time};
use mdle_serial::Clock;

/// Time source of turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pacing {
    /// The clock of the host.
    Wall,
    /// Lockstep. Each turn lasts for this period, and begins when all topics have answered the last command.
    Lockstep(Duration),
    /// The clock of a simulation. Each turn lasts for this period, and begins when `/clock` has advanced by the period.
    Simulated(Duration),
}

impl Pacing {
    /// Returns the clock that determines the times of outputs.
    #[must_use]
    pub fn clock(self) -> Clock {
        match self {
            Self::Wall => Clock::Wall,
            Self::Lockstep(period) | Self::Simulated(period) => Clock::Stepped(period),
        }
    }

    /// Returns the time source that the host uses to pace the turns.
    #[must_use]
    pub fn time(self) -> Time {
        match self {
            Self::Wall => Time::Wall,
            Self::Lockstep(_) | Self::Simulated(_) => Time::Stepped(Pace::Max),
        }
    }
}
