//! The options that every executable takes, next to those of its target.

use std::path::PathBuf;
use std::time::Duration;

use clap::{Arg, ArgMatches, Command, value_parser};

use crate::{Target, paths};

/// The shortest period: a turn must leave time for the exchange.
const PERIOD_LEAST: Duration = Duration::from_micros(100);
/// The longest period: a robot that is told something once a minute is not controlled.
const PERIOD_MOST: Duration = Duration::from_secs(60);
/// The longest timeout, some 31 years: far below what nanoseconds in 64 bits can count.
const TIMEOUT_MOST: Duration = Duration::from_secs(1_000_000_000);

const STATUS: &str = "Exit status: 0 the plan is over, 2 a bad option, world or start pose, 3 a fault stopped the robot,\n\
                      4 timeout or turn limit, 129, 130 or 143 stopped by a signal. The robot is stopped in every case.";

/// What the options common to all targets say.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Options {
    /// From the start of a turn to the start of the next.
    pub(crate) period: Duration,
    /// The plan's time at which it is given up.
    pub(crate) timeout: Option<Duration>,
    /// The number of turns after which it is given up; at least 1.
    pub(crate) turns: Option<u64>,
    /// Where to write the run log.
    pub(crate) log: Option<PathBuf>,
    /// Where to record the path that is driven.
    pub(crate) path: Option<PathBuf>,
}

/// The command line of the executable of plan `name` for target `T`. Its usage names the first argument's file, and the
/// plan where there is none.
pub(crate) fn command<T: Target>(name: &str) -> Command {
    let seconds = T::PERIOD.as_secs_f64();
    let command = Command::new(name.to_owned())
        .about(format!("Runs the plan {name} on the robot {}.", T::NAME))
        .after_help(STATUS)
        .arg(
            option("period", "SECONDS")
                .help(format!("Time from one turn to the next [default: {seconds}]"))
                .allow_negative_numbers(true)
                .value_parser(|text: &str| duration(text, PERIOD_LEAST, PERIOD_MOST)),
        )
        .arg(
            option("timeout", "SECONDS")
                .help("Give up when the plan is not over at this time (exit status 4)")
                .allow_negative_numbers(true)
                .value_parser(|text: &str| duration(text, Duration::from_nanos(1), TIMEOUT_MOST)),
        )
        .arg(
            option("turns", "N")
                .help("Give up when the plan is not over after this many turns (exit status 4)")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..)),
        )
        .arg(
            option("log", "FILE")
                .help("Write what happens, one JSON object a turn, as `mdlec trace` does")
                .value_parser(value_parser!(PathBuf)),
        );
    T::arguments(if T::PATHS.is_some() { paths::arguments(command) } else { command })
}

/// Reads the common options.
pub(crate) fn options<T: Target>(matches: &ArgMatches) -> Options {
    Options {
        period: matches.get_one("period").copied().unwrap_or(T::PERIOD),
        timeout: matches.get_one("timeout").copied(),
        turns: matches.get_one("turns").copied(),
        log: matches.get_one("log").cloned(),
        path: paths::recording::<T>(matches),
    }
}

/// A long option with a value.
fn option(name: &'static str, value: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value)
}

/// Reads a number of seconds between two limits.
fn duration(text: &str, least: Duration, most: Duration) -> Result<Duration, String> {
    let read = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    match read {
        Some(duration) if duration >= least && duration <= most => Ok(duration),
        Some(_) | None => {
            Err(format!("expected a number of seconds from {} to {}", least.as_secs_f64(), most.as_secs_f64()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_period_is_a_sane_number_of_seconds() {
        let period = |text| duration(text, PERIOD_LEAST, PERIOD_MOST);
        assert_eq!(period("0.1"), Ok(Duration::from_millis(100)));
        assert_eq!(period("1e-4"), Ok(Duration::from_micros(100)));
        assert_eq!(period("60"), Ok(Duration::from_secs(60)));
        for wrong in ["0", "-0", "-1", "NaN", "inf", "-inf", "1e300", "60.1", "0.00001", "", " 1", "1s", "١"] {
            assert!(period(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn decimal_seconds_become_whole_nanoseconds() {
        assert_eq!(duration("0.3", PERIOD_LEAST, PERIOD_MOST), Ok(Duration::from_nanos(300_000_000)));
        assert_eq!(duration("86400.1", PERIOD_LEAST, TIMEOUT_MOST), Ok(Duration::from_millis(86_400_100)));
    }
}
