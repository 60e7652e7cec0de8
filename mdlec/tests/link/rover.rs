//! The robot of the tests of `link`, as a third party would write it. It has no capabilities.
#![forbid(unsafe_code)]

use std::convert::Infallible;
use std::time::Duration;

use mdle_host::clap::ArgMatches;
use mdle_host::{Pace, Refusal, StopRequest, Time};
use mdle_runtime::Robot;

/// Name by which the emitted program refers to the target.
pub use Rover as Target;

/// The robot.
#[derive(Debug)]
pub struct Rover;

/// The robot's output.
#[derive(Debug)]
pub struct Sensed;

impl mdle_runtime::Output for Sensed {}

impl Robot for Rover {
    type Output = Sensed;
    type Input = ();
    type Error = Infallible;

    fn exchange(&mut self, _: &()) -> Result<Sensed, Infallible> {
        Ok(Sensed)
    }

    fn stop(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl mdle_host::Target for Rover {
    const NAME: &'static str = "rover";
    const PERIOD: Duration = Duration::from_millis(100);
    type Robot = Self;

    fn time(_: &ArgMatches) -> Result<Time, String> {
        Ok(Time::Stepped(Pace::Max))
    }

    fn connect(_: &ArgMatches, _: Duration, _: &StopRequest) -> Result<Self, Refusal> {
        Ok(Self)
    }
}
