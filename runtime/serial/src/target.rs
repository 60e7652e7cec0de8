//! A robot on a serial line as a target: its options, configuration and connection.

use std::marker::PhantomData;
use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{NamedFile, Refusal, Replays, SettingsOf, StopRequest, Target, Time};
use mdle_runtime::{Nanos, PathStore, Robot, Sensed, Twist};

use crate::capacity::carries;
use crate::clock::Clock;
use crate::configuration::{Configuration, Configured};
use crate::options;

/// A driver of a robot on a serial line.
pub trait SerialRobot: Robot<Output = Sensed, Input = Twist, Error: Into<Refusal>> + Sized + 'static {
    /// Name of the target, as in `mdlec --target`.
    const NAME: &'static str;
    /// Period of a turn if the option `--period` is not given.
    const PERIOD: Nanos;
    /// Maximum speed and turn rate of a path; they equal the limits of `go` in the alphabet.
    const FASTEST: Twist;
    /// Function that returns the settings that a user can change while the robot drives; `None` if there are no such
    /// settings.
    const SETTINGS: Option<SettingsOf<Self>> = None;
    /// Type of the configuration, which contains the values that differ between robots of this kind.
    type Config: Configuration;

    /// Opens the line, and prepares the robot while it stays at rest.
    ///
    /// # Errors
    /// Fails if there is no line or no robot, if the robot is not ready to drive, or if `request` was made.
    fn connect(
        config: Self::Config,
        clock: Clock,
        period: Duration,
        request: &StopRequest,
    ) -> Result<Self, Self::Error>;

    /// Stores the paths that the plan can replay.
    fn take_paths(&mut self, paths: PathStore);

    /// Returns the time that the line needs to transmit the data of a turn.
    fn turn_takes(config: &Self::Config) -> Duration;

    /// Returns the timeout for an answer, in milliseconds, so that it can be changed.
    fn answer(config: &mut Self::Config) -> &mut u64;

    /// Checks that the watchdog's timeout is longer than the time between two commands. Called if turns follow the
    /// computer's clock.
    ///
    /// # Errors
    /// Returns a message with the watchdog's timeout if turns are too long for it.
    fn outlasts(config: &Self::Config, period: Duration) -> Result<(), String>;
}

/// The target of a robot on a serial line.
#[derive(Debug, Clone, Copy)]
pub struct SerialTarget<R>(PhantomData<R>);

impl<R: SerialRobot> Target for SerialTarget<R> {
    const NAME: &'static str = R::NAME;
    const PERIOD: Duration = Duration::from_nanos(R::PERIOD.0);
    type Robot = R;
    const PATHS: Option<Replays<R>> =
        Some(Replays { fastest: R::FASTEST, take: R::take_paths, speed: |sensed| sensed.velocity.v });
    const SETTINGS: Option<SettingsOf<R>> = R::SETTINGS;

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
            .then(|| configured::<R>(matches).map(|configured| configured.to_string()))
            .transpose()
    }

    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<R, Refusal> {
        let clock = options::clock(matches, period);
        let mut config = configured::<R>(matches)?.config;
        match clock {
            Clock::Stepped(_) => {
                let answer = R::answer(&mut config);
                *answer = clock.patience(Duration::from_millis(*answer)).as_millis() as u64;
            }
            Clock::Wall => R::outlasts(&config, period)
                .and_then(|()| carries(period, R::turn_takes(&config)))
                .map_err(Refusal::Usage)?,
        }
        R::connect(config, clock, period, request).map_err(Into::into)
    }
}

/// Reads the configuration that the options select.
fn configured<R: SerialRobot>(matches: &ArgMatches) -> Result<Configured<R::Config>, Refusal> {
    Configured::read(options::config(matches), options::device(matches)).map_err(Refusal::Usage)
}
