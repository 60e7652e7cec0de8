//! The options of an executable for a robot on a line.

use std::path::{Path, PathBuf};
use std::time::Duration;

use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{Pace, Time};

use crate::clock::Clock;

/// Adds them.
#[must_use]
pub fn arguments(command: Command) -> Command {
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

/// The device, if it was given.
#[must_use]
pub fn device(matches: &ArgMatches) -> Option<&str> {
    matches.get_one::<String>("device").map(String::as_str)
}

/// The file of the configuration, if there is one.
#[must_use]
pub fn config(matches: &ArgMatches) -> Option<&Path> {
    matches.get_one::<PathBuf>("config").map(PathBuf::as_path)
}

/// Whether the configuration is to be printed.
#[must_use]
pub fn prints_config(matches: &ArgMatches) -> bool {
    matches.get_flag("print-config")
}

/// How time passes for the host.
#[must_use]
pub fn time(matches: &ArgMatches) -> Time {
    if matches.get_flag("lockstep") { Time::Stepped(Pace::Max) } else { Time::Wall }
}

/// How it passes for outputs.
#[must_use]
pub fn clock(matches: &ArgMatches, period: Duration) -> Clock {
    if matches.get_flag("lockstep") { Clock::Stepped(period) } else { Clock::Wall }
}
