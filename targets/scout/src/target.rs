//! The target `scout`, as the host runs plans on it.

use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Hosted, NamedFile, Refusal, Replays, StopRequest, Target, Time};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Twist};
use mdle_serial::{Clock, carries, options};

use crate::alphabet;
use crate::config::Configured;
use crate::driver::{Scout, turn_takes};
use crate::fault::Fault;

/// The target `scout`.
#[derive(Debug, Clone, Copy)]
pub struct SuperScout;

impl Target for SuperScout {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Scout;
    const PATHS: Option<Replays<Scout>> = Some(Replays {
        // As `go` in the alphabet.
        fastest: Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) },
        take: Scout::take_paths,
        speed: |sensed| sensed.velocity.v,
    });

    fn arguments(command: Command) -> Command {
        options::arguments(command)
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        Ok(options::time(matches))
    }

    fn files(matches: &ArgMatches) -> Vec<NamedFile> {
        options::files(matches)
    }

    fn answer(matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        options::prints_config(matches)
            .then(|| configured(matches).map(|configured| configured.to_string()))
            .transpose()
    }

    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Scout, Refusal> {
        let clock = options::clock(matches, period);
        let mut config = configured(matches)?.config;
        let watchdog = Duration::from_secs(u64::from(config.watchdog));
        match clock {
            Clock::Stepped(_) => config.answer = clock.patience(config.patience()).as_millis() as u64,
            Clock::Wall if period + config.patience() >= watchdog => {
                return Err(Refusal::Usage(format!(
                    "with a period of {} s the robot would stop itself between two commands: its watchdog waits for {} s; \
                     shorten the period, or set `watchdog` in the configuration",
                    period.as_secs_f64(),
                    config.watchdog
                )));
            }
            Clock::Wall => carries(period, turn_takes()).map_err(Refusal::Usage)?,
        }
        Scout::connect(config, clock, period, request).map_err(|fault| {
            if let Fault::Ended(unstopped) = fault {
                Refusal::Ended(unstopped.map_or(Ok(()), |fault| Err(fault.to_string())))
            } else {
                Refusal::Fault(fault.to_string())
            }
        })
    }
}

impl Hosted for Scout {
    fn longest_gap(&self) -> Option<Duration> {
        Some(self.watchdog())
    }
}

/// The configuration that the options ask for.
fn configured(matches: &ArgMatches) -> Result<Configured, Refusal> {
    Configured::read(options::config(matches), options::device(matches)).map_err(Refusal::Usage)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use mdle_host::clap::Command;
    use mdle_host::{Refusal, StopRequest, Target as _};

    use super::SuperScout;

    #[test]
    fn a_period_that_the_line_cannot_carry_is_refused() {
        let matches = |more: &[&str]| {
            let arguments = ["plan", "--device", "/nowhere"].iter().chain(more);
            SuperScout::arguments(Command::new("plan")).get_matches_from(arguments)
        };
        let connected = |micros, more| {
            SuperScout::connect(&matches(more), Duration::from_micros(micros), &StopRequest::default()).map(drop)
        };
        let Err(Refusal::Usage(sentence)) = connected(15_000, &[]) else { panic!("15000 µs are enough") };
        assert_eq!(
            sentence,
            "a --period of 0.015 s is too short for this robot's line, on which each turn takes 15.6ms: choose 0.016 s or longer"
        );
        // There is no such device.
        for (micros, more) in [(15_000 + 1_000, &[][..]), (15_000, &["--lockstep"])] {
            assert!(matches!(connected(micros, more), Err(Refusal::Fault(_))), "{micros} {more:?}");
        }
    }
}
