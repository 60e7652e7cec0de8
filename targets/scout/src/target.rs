//! The target `scout`, on which the host runs plans.

use std::time::Duration;

use mdle_host::{Refusal, SettingsOf, StopRequest};
use mdle_runtime::{MetersPerSecond, Nanos, PathStore, RadiansPerSecond, Twist};
use mdle_serial::{Clock, SerialRobot};

use crate::alphabet;
use crate::config::Config;
use crate::driver::{Scout, turn_takes};
use crate::fault::Fault;

impl SerialRobot for Scout {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Nanos = alphabet::PERIOD;
    const FASTEST: Twist = Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) };
    const SETTINGS: Option<SettingsOf<Self>> = Some(|scout| scout);
    type Config = Config;

    fn connect(config: Config, clock: Clock, period: Duration, request: &StopRequest) -> Result<Self, Fault> {
        Self::connect(config, clock, period, request)
    }

    fn take_paths(&mut self, paths: PathStore) {
        self.paths = paths;
    }

    fn turn_takes(_: &Config) -> Duration {
        turn_takes()
    }

    fn answer(config: &mut Config) -> &mut u64 {
        &mut config.answer
    }

    fn outlasts(config: &Config, period: Duration) -> Result<(), String> {
        if period + config.patience() < Duration::from_secs(u64::from(config.watchdog)) {
            return Ok(());
        }
        Err(format!(
            "with a period of {} s the robot would stop itself between two commands: its watchdog waits for {} s; \
             shorten the period, or set `watchdog` in the configuration",
            period.as_secs_f64(),
            config.watchdog
        ))
    }
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        if let Fault::Ended(unstopped) = fault {
            Self::Ended(unstopped.map_or(Ok(()), |fault| Err(fault.to_string())))
        } else {
            Self::Fault(fault.to_string())
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use mdle_host::clap::Command;
    use mdle_host::{Refusal, StopRequest, Target as _};

    use crate::Target;

    #[test]
    fn a_period_that_the_line_cannot_carry_is_refused() {
        let matches = |more: &[&str]| {
            let arguments = ["plan", "--device", "/nowhere"].iter().chain(more);
            Target::arguments(Command::new("plan")).get_matches_from(arguments)
        };
        let connected = |micros, more| {
            Target::connect(&matches(more), Duration::from_micros(micros), &StopRequest::default()).map(drop)
        };
        let Err(Refusal::Usage(sentence)) = connected(15_000, &[]) else { panic!("15000 µs are enough") };
        assert_eq!(
            sentence,
            "a --period of 0.015 s is too short for this robot's line, on which each turn takes 15.6ms: choose 0.016 s or longer"
        );
        // The device does not exist.
        for (micros, more) in [(15_000 + 1_000, &[][..]), (15_000, &["--lockstep"])] {
            assert!(matches!(connected(micros, more), Err(Refusal::Fault(_))), "{micros} {more:?}");
        }
    }
}
