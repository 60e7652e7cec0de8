//! The target `scout`, as the host runs plans on it.

use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Hosted, Refusal, Target, Time};
use mdle_serial::{Clock, options};

use crate::alphabet;
use crate::config::Configured;
use crate::driver::Scout;

/// The target `scout`.
#[derive(Debug, Clone, Copy)]
pub struct SuperScout;

impl Target for SuperScout {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Scout;

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

    fn connect(matches: &ArgMatches, period: Duration) -> Result<Scout, Refusal> {
        let clock = options::clock(matches, period);
        let mut config = configured(matches)?.config;
        let watchdog = Duration::from_secs(u64::from(config.watchdog));
        match clock {
            // An emulator takes as long as its machine makes it, and its robot stands meanwhile.
            Clock::Stepped(_) => config.answer = 10_000,
            Clock::Wall if period + config.patience() >= watchdog => {
                return Err(Refusal::Usage(format!(
                    "with a period of {} s the robot would stop itself between two commands: its watchdog waits for {} s; \
                     shorten the period, or set `watchdog` in the configuration",
                    period.as_secs_f64(),
                    config.watchdog
                )));
            }
            Clock::Wall => {}
        }
        Scout::connect(config, clock, period).map_err(|fault| Refusal::Fault(fault.to_string()))
    }
}

impl Hosted for Scout {}

/// The configuration that the options ask for.
fn configured(matches: &ArgMatches) -> Result<Configured, Refusal> {
    Configured::read(options::config(matches), options::device(matches)).map_err(Refusal::Usage)
}
