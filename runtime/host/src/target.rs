//! Interface of a target to the host: its options, its robot and its time. See docs/src/reference/interfaces.md, 7.3.

use std::time::Duration;

use clap::{ArgMatches, Command};
use mdle_runtime::Robot;

use crate::{EarsOf, NamedFile, Observation, Refusal, Replays, SettingsOf, StopRequest, Time};

/// A robot for which executables can be built. Each target crate implements this trait once; a driver needs only a
/// [`Robot`] and [`Target::connect`].
pub trait Target {
    /// Name of the target, as in `mdlec --target`.
    const NAME: &'static str;
    /// Period of a turn if the option `--period` is not given.
    const PERIOD: Duration;
    /// Type of the robot.
    type Robot: Robot + 'static;
    /// Functions that replay and record paths; `None` if the alphabet does not have the capability `paths`. With these
    /// functions, the executable has the options `--paths` and `--record-path`.
    const PATHS: Option<Replays<Self::Robot>> = None;
    /// Functions that observe the robot's runs, such as those of a simulator; `None` if the target has no such
    /// functions.
    const OBSERVATION: Option<Observation<Self::Robot>> = None;

    /// Function that returns the settings that a user can change while the robot drives; `None` if there are no such
    /// settings.
    const SETTINGS: Option<SettingsOf<Self::Robot>> = None;

    /// Function that gives the robot microphones; `None` if the robot cannot have any.
    const EARS: Option<EarsOf<Self::Robot>> = None;

    /// Adds the target's own options to `command`.
    fn arguments(command: Command) -> Command {
        command
    }

    /// Returns the source of time for this robot and these options. The default is the wall clock, which is right for
    /// every real robot.
    ///
    /// # Errors
    /// Returns a message for the operator if an option is invalid.
    fn time(_matches: &ArgMatches) -> Result<Time, String> {
        Ok(Time::Wall)
    }

    /// Checks that the robot has the capabilities that a plan needs, if the options configure the robot. `texts`
    /// contains the laws and the conditions of the plan as written. Called before [`Target::connect`]. A robot that
    /// always has all capabilities of its alphabet needs no check.
    ///
    /// # Errors
    /// If the robot lacks a capability, returns a message with the quark and the setting that the quark needs (exit
    /// status 2).
    fn accepts(_matches: &ArgMatches, _texts: &[&str]) -> Result<(), Refusal> {
        Ok(())
    }

    /// Connects to the robot, which does not move yet.
    ///
    /// From this call on, signals no longer end the program, but make `request`. A robot that opens at once can ignore
    /// `request`: the host stops the robot before its first turn. A robot that takes longer checks `request` between
    /// its steps; when the request is made, the robot stops and returns [`Refusal::Ended`].
    ///
    /// # Errors
    /// Fails if an option is invalid (exit status 2), if a fault has occurred (exit status 3), or if `request` was
    /// made.
    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Self::Robot, Refusal>;

    /// Returns the files that the target's own options name. The host refuses to write a file if another option names
    /// it too.
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
