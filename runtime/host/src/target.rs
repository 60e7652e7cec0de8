//! Interface of a target to the host: its options, its robot and its time. See docs/src/reference/interfaces.md, 7.3.

use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::Robot;

use crate::{EarsOf, NamedFile, Observation, Refusal, Replays, SettingsOf, StopRequest, Time};

/// A robot that executables are built for; implemented once in each target crate. A driver needs no more than a
/// [`Robot`] and [`Target::connect`].
pub trait Target {
    /// The name of the target, as `mdlec --target` takes it.
    const NAME: &'static str;
    /// The period of a turn unless `--period` says otherwise.
    const PERIOD: Duration;
    /// The robot.
    type Robot: Robot + 'static;
    /// Functions to replay and to record paths, if the alphabet has the capability `paths`: the executable then takes
    /// `--paths` and `--record-path`.
    const PATHS: Option<Replays<Self::Robot>> = None;
    /// The observer of its runs, if it has one, as a simulator does.
    const OBSERVATION: Option<Observation<Self::Robot>> = None;

    /// The settings that people change while it drives, if there are any.
    const SETTINGS: Option<SettingsOf<Self::Robot>> = None;

    /// Gives its robot microphones, if it can have some.
    const EARS: Option<EarsOf<Self::Robot>> = None;

    /// Adds the target's own options to the executable's.
    fn arguments(command: Command) -> Command {
        command
    }

    /// Returns how time passes for this robot with these options: by the wall clock, as for every real one.
    ///
    /// # Errors
    /// A sentence for the operator about an option that makes no sense.
    fn time(_matches: &ArgMatches) -> Result<Time, String> {
        Ok(Time::Wall)
    }

    /// Checks that the robot, as these options configure it, has what a plan needs. `texts` are the laws and the
    /// conditions of the plan, as its text has them. Called before [`Target::connect`]; a robot that always has all
    /// capabilities of its alphabet needs no check.
    ///
    /// # Errors
    /// A sentence with the quark and the setting that it needs (exit status 2).
    fn accepts(_matches: &ArgMatches, _texts: &[&str]) -> Result<(), Refusal> {
        Ok(())
    }

    /// Opens the robot; no motion yet.
    ///
    /// From the call on, signals no longer end the program: they make `request`. A robot that opens at once ignores it,
    /// and the host stops the robot before its first turn. A robot that takes longer checks `request` between its
    /// steps, and when it is made, stops and returns [`Refusal::Ended`].
    ///
    /// # Errors
    /// A bad option (exit status 2), a fault (exit status 3), or `request`.
    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Self::Robot, Refusal>;

    /// Returns the files that the target's own options name: the host refuses to write a file that another option names
    /// too.
    fn files(_matches: &ArgMatches) -> Vec<NamedFile> {
        Vec::new()
    }

    /// Returns the text to print instead of a run, if these options ask for something that needs no run.
    ///
    /// # Errors
    /// Why there is no answer: a bad option (exit status 2).
    fn answer(_matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        Ok(None)
    }
}
