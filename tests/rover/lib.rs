//! A robot in the form in which a third party would write it. Its battery loses a volt in each turn.
#![forbid(unsafe_code)]

pub mod alphabet;
pub mod quarks;

use std::convert::Infallible;
use std::time::Duration;

use mdle_host::clap::ArgMatches;
use mdle_host::{Pace, Refusal, StopRequest, Time};
use mdle_runtime::{Robot, Volts};

pub use Rover as Target;
pub use Sensed as Output;

/// Input of the rover: a number.
pub type Input = i64;

/// The robot, with the voltage of its battery.
#[derive(Debug)]
pub struct Rover(Volts);

/// Output of the rover.
#[derive(Debug)]
pub struct Sensed(pub Volts);

impl mdle_runtime::Output for Sensed {}

impl Robot for Rover {
    type Output = Sensed;
    type Input = i64;
    type Error = Infallible;

    fn exchange(&mut self, _: &i64) -> Result<Sensed, Infallible> {
        self.0.0 -= 1.0;
        Ok(Sensed(self.0))
    }

    fn stop(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl mdle_host::Target for Rover {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Self;

    fn time(_: &ArgMatches) -> Result<Time, String> {
        Ok(Time::Stepped(Pace::Max))
    }

    fn connect(_: &ArgMatches, _: Duration, _: &StopRequest) -> Result<Self, Refusal> {
        Ok(Self(Volts(14.0)))
    }
}
