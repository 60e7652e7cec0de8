//! The target `atrv`, on which the host runs plans.

use std::time::Duration;

use mdle_host::{Refusal, StopRequest};
use mdle_runtime::{MetersPerSecond, Nanos, PathStore, RadiansPerSecond, Twist};
use mdle_serial::{Clock, SerialRobot};

use crate::alphabet;
use crate::config::Config;
use crate::driver::{Atrv, turn_takes};
use crate::fault::Fault;

/// Minimum difference between the watchdog's limit and the period. It is needed because turns may be late.
const SLACK: Duration = Duration::from_millis(50);

impl SerialRobot for Atrv {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Nanos = alphabet::PERIOD;
    const FASTEST: Twist = Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) };
    type Config = Config;

    fn connect(config: Config, clock: Clock, period: Duration, request: &StopRequest) -> Result<Self, Fault> {
        Self::connect(config, clock, period, request)
    }

    fn take_paths(&mut self, paths: PathStore) {
        self.paths = paths;
    }

    fn turn_takes(config: &Config) -> Duration {
        turn_takes(config)
    }

    fn answer(config: &mut Config) -> &mut u64 {
        &mut config.answer
    }

    fn outlasts(config: &Config, period: Duration) -> Result<(), String> {
        if period + SLACK < Duration::from_millis(config.watchdog) {
            return Ok(());
        }
        Err(format!(
            "with a period of {} s the robot would be stopped between two commands: its watchdog waits for {} ms; \
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
        let Err(Refusal::Usage(sentence)) = connected(7_000, &[]) else { panic!("7000 µs are enough") };
        assert_eq!(
            sentence,
            "a --period of 0.007 s is too short for this robot's line, on which each turn takes 7.8ms: choose 0.008 s or longer"
        );
        // The device does not exist.
        for (micros, more) in [(7_000 + 1_000, &[][..]), (7_000, &["--lockstep"])] {
            assert!(matches!(connected(micros, more), Err(Refusal::Fault(_))), "{micros} {more:?}");
        }
    }
}
