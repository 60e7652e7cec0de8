//! Interface of a target to the host: its options, its robot and its time. See docs/src/reference/interfaces.md, 7.3.

use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::Robot;

use crate::{EarsOf, NamedFile, Observation, Refusal, Replays, SettingsOf, StopRequest, Time};

/// A robot for which executables are built. Each target crate implements it once; a driver needs only a [`Robot`] and
/// [`Target::connect`].
pub trait Target {
    /// Name of the target, as in `mdlec --target`.
    const NAME: &'static str;
    /// Period of a turn without the option `--period`.
    const PERIOD: Duration;
    /// Type of the robot.
    type Robot: Robot + 'static;
    /// Functions to replay and to record paths, if the alphabet has the capability `paths`: the executable then takes
    /// `--paths` and `--record-path`.
    const PATHS: Option<Replays<Self::Robot>> = None;
    /// Functions that observe the robot's runs, if there are any, as for a simulator.
    const OBSERVATION: Option<Observation<Self::Robot>> = None;

    /// Function that returns the settings that a user can change while the robot drives, if there are any.
    const SETTINGS: Option<SettingsOf<Self::Robot>> = None;

    /// Function that gives the robot microphones, if it can have any.
    const EARS: Option<EarsOf<Self::Robot>> = None;

    /// Returns `command` with the target's own options.
    fn arguments(command: Command) -> Command {
        command
    }

    /// Returns the source of time of this robot with these options; the default, for every real robot, is the wall
    /// clock.
    ///
    /// # Errors
    /// Returns a message for the operator if an option is invalid.
    fn time(_matches: &ArgMatches) -> Result<Time, String> {
        Ok(Time::Wall)
    }

    /// Checks that the robot, as the options configure it, has the capabilities that a plan needs. `texts` are the laws
    /// and the conditions in the text of the plan. Called before [`Target::connect`]. A robot that always has all
    /// capabilities of its alphabet needs no check.
    ///
    /// # Errors
    /// Returns a message with the quark and the setting that it needs, if the robot lacks a capability (exit status 2).
    fn accepts(_matches: &ArgMatches, _texts: &[&str]) -> Result<(), Refusal> {
        Ok(())
    }

    /// Opens the robot, which does not move yet.
    ///
    /// From this call on, signals no longer end the program, but make `request`. A robot that opens at once can ignore
    /// `request`: the host stops the robot before its first turn. A robot that takes longer checks `request` between
    /// its steps; when the request is made, the robot stops and returns [`Refusal::Ended`].
    ///
    /// # Errors
    /// Fails if an option is invalid (exit status 2), if a fault has occurred (exit status 3), or if `request` was
    /// made.
    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Self::Robot, Refusal>;

    /// Returns the files that the target's own options name; the host refuses to write a file that another option also
    /// names.
    fn files(_matches: &ArgMatches) -> Vec<NamedFile> {
        Vec::new()
    }

    /// Returns the text to print instead of a run, if the options request information that needs no run.
    ///
    /// # Errors
    /// Fails if an option is invalid (exit status 2).
    fn answer(_matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        Ok(None)
    }
}
