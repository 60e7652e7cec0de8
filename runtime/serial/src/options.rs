//! Command-line options of an executable for a robot on a serial line.

use std::path::{Path, PathBuf};
use std::time::Duration;

use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{NamedFile, Pace, Time};

use crate::clock::Clock;

/// Adds the options of a robot on a serial line to `command`.
#[must_use]
pub fn arguments(command: Command) -> Command {
    command
        .arg(
            Arg::new("device")
                .long("device")
                .value_name("PATH|tcp:ADDRESS:PORT")
                .help("Serial port or TCP address of the robot [default: `device` of the configuration]"),
        )
        .arg(
            Arg::new("config")
                .long("config")
                .value_name("FILE.toml")
                .help("Configuration of the robot [default: that of --print-config]")
                .long_help(
                    "Configuration of the robot: device, limits, timeouts. `--print-config > FILE.toml` writes a file to \
                     start from, with every value and its unit.",
                )
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            Arg::new("print-config")
                .long("print-config")
                .action(ArgAction::SetTrue)
                .help("Print the configuration and the origin of each value, and exit"),
        )
        .arg(
            Arg::new("lockstep")
                .long("lockstep")
                .action(ArgAction::SetTrue)
                .help("Take each turn as soon as the robot answers; for an emulator with --lockstep only"),
        )
}

/// Returns the value of the option `--device`; `None` if the option is not given.
#[must_use]
pub fn device(matches: &ArgMatches) -> Option<&str> {
    matches.get_one::<String>("device").map(String::as_str)
}

/// Returns the file that the option `--config` names; `None` if the option is not given.
#[must_use]
pub fn config(matches: &ArgMatches) -> Option<&Path> {
    matches.get_one::<PathBuf>("config").map(PathBuf::as_path)
}

/// Returns the files that the options name.
#[must_use]
pub fn files(matches: &ArgMatches) -> Vec<NamedFile> {
    let config = config(matches).map(|path| NamedFile { option: "--config", path: path.to_owned(), is_written: false });
    config.into_iter().collect()
}

/// Returns `true` if the option `--print-config` is present.
#[must_use]
pub fn prints_config(matches: &ArgMatches) -> bool {
    matches.get_flag("print-config")
}

/// Returns the clock of the host. This is the computer's clock; with `--lockstep`, it is a clock that advances as fast
/// as possible.
#[must_use]
pub fn time(matches: &ArgMatches) -> Time {
    if matches.get_flag("lockstep") { Time::Stepped(Pace::Max) } else { Time::Wall }
}

/// Returns the clock of the robot's outputs. This is the computer's clock; with `--lockstep`, it advances by `period`
/// in each turn.
#[must_use]
pub fn clock(matches: &ArgMatches, period: Duration) -> Clock {
    if matches.get_flag("lockstep") { Clock::Stepped(period) } else { Clock::Wall }
}
