//! The robot template as a target of mdlec. `alphabet.mdle` lists its quarks, and `hardware.rs` drives it.
#![forbid(unsafe_code)]

pub mod alphabet;
mod hardware;
pub mod quarks;

use std::time::Duration;

pub use hardware::{Fault, Hardware};
use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Refusal, StopRequest, Time};
use mdle_runtime::Robot;
/// The robot's output: what its sensors say.
pub use mdle_runtime::Sensed as Output;
/// The robot's input: a forward speed and a turn rate. Zero is the null input.
pub use mdle_runtime::Twist as Input;

/// Target of this robot: the host runs plans on it.
#[derive(Debug, Clone, Copy)]
pub struct Target;

impl mdle_host::Target for Target {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Hardware;

    fn arguments(command: Command) -> Command {
        hardware::options(command)
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        Ok(hardware::time(matches))
    }

    fn connect(matches: &ArgMatches, period: Duration, _: &StopRequest) -> Result<Hardware, Refusal> {
        Hardware::open(matches, period).map_err(|fault| Refusal::Fault(fault.to_string()))
    }
}

impl Robot for Hardware {
    type Output = Output;
    type Input = Input;
    type Error = Fault;

    fn exchange(&mut self, input: &Input) -> Result<Output, Fault> {
        self.command(hardware::within_limits(input)?)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.halt()
    }
}
