//! The target `scout`, as the host runs plans on it.

use std::path::PathBuf;
use std::time::Duration;

use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{Hosted, Pace, Refusal, Target, Time};

use crate::alphabet;
use crate::config::Configured;
use crate::driver::{Clock, Scout};

/// The target `scout`.
#[derive(Debug, Clone, Copy)]
pub struct SuperScout;

impl Target for SuperScout {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Scout;

    fn arguments(command: Command) -> Command {
        command
            .arg(
                Arg::new("device")
                    .long("device")
                    .value_name("PATH|tcp:ADDRESS:PORT")
                    .help("The robot's serial port, or where it listens [default: as the configuration says]"),
            )
            .arg(
                Arg::new("config")
                    .long("config")
                    .value_name("FILE.toml")
                    .help("What is known of this robot; --print-config shows all that can be said")
                    .value_parser(value_parser!(PathBuf)),
            )
            .arg(
                Arg::new("print-config")
                    .long("print-config")
                    .action(ArgAction::SetTrue)
                    .help("Print the configuration, where each value came from, and end"),
            )
            .arg(
                Arg::new("lockstep")
                    .long("lockstep")
                    .action(ArgAction::SetTrue)
                    .help("Make turns as fast as the robot answers: for an emulator in lockstep, never for a robot"),
            )
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        Ok(if matches.get_flag("lockstep") { Time::Stepped(Pace::Max) } else { Time::Wall })
    }

    fn answer(matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        let asked = matches.get_flag("print-config");
        asked.then(|| configured(matches).map(|configured| configured.to_string())).transpose()
    }

    fn connect(matches: &ArgMatches, period: Duration) -> Result<Scout, Refusal> {
        let clock = if matches.get_flag("lockstep") { Clock::Stepped(period) } else { Clock::Wall };
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
    let file = matches.get_one::<PathBuf>("config");
    let device = matches.get_one::<String>("device");
    Configured::read(file.map(PathBuf::as_path), device.map(String::as_str)).map_err(Refusal::Usage)
}
