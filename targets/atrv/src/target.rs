//! The target `atrv`, as the host runs plans on it.

use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Hosted, Refusal, Target, Time};
use mdle_serial::{Clock, options};

use crate::alphabet;
use crate::config::Configured;
use crate::driver::Atrv;

/// How much later than it should a turn may be before the watchdog stops the robot.
const SLACK: Duration = Duration::from_millis(50);

/// The target `atrv`.
#[derive(Debug, Clone, Copy)]
pub struct AtrvMini;

impl Target for AtrvMini {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Atrv;

    fn arguments(command: Command) -> Command {
        options::arguments(command)
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        Ok(options::time(matches))
    }

    fn answer(matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        options::prints_config(matches)
            .then(|| configured(matches).map(|configured| configured.to_string()))
            .transpose()
    }

    fn connect(matches: &ArgMatches, period: Duration) -> Result<Atrv, Refusal> {
        let clock = options::clock(matches, period);
        let mut config = configured(matches)?.config;
        match clock {
            // An emulator takes as long as its machine makes it, and its robot stands meanwhile.
            Clock::Stepped(_) => config.answer = 10_000,
            Clock::Wall if period + SLACK >= Duration::from_millis(config.watchdog) => {
                return Err(Refusal::Usage(format!(
                    "with a period of {} s the robot would be stopped between two commands: its watchdog waits for {} ms; \
                     shorten the period, or set `watchdog` in the configuration",
                    period.as_secs_f64(),
                    config.watchdog
                )));
            }
            Clock::Wall => {}
        }
        Atrv::connect(config, clock, period).map_err(|fault| Refusal::Fault(fault.to_string()))
    }
}

impl Hosted for Atrv {}

/// The configuration that the options ask for.
fn configured(matches: &ArgMatches) -> Result<Configured, Refusal> {
    Configured::read(options::config(matches), options::device(matches)).map_err(Refusal::Usage)
}
