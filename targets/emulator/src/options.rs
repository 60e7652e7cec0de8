//! Command-line options of all robot emulators.

use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use mdle_host::Quantity;
use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_simulator::{Start, StartError};

use crate::fault::ScheduledFault;

/// Values of the command-line options of all robot emulators.
#[derive(Debug)]
pub struct EmulatorOptions {
    pub(crate) world: String,
    pub(crate) start: Option<Start>,
    pub(crate) robots: Vec<NamedStart>,
    pub(crate) seed: Option<u64>,
    pub(crate) link: Option<PathBuf>,
    pub(crate) lockstep: Option<Duration>,
    pub(crate) faults: Vec<ScheduledFault>,
}

impl EmulatorOptions {
    /// Adds the options of all robot emulators, and their version, to `command`.
    #[must_use]
    pub fn arguments(command: Command) -> Command {
        of_behavior(of_robots(command.version(env!("CARGO_PKG_VERSION"))))
    }

    /// Reads the options from `matches`, which a command with [`EmulatorOptions::arguments`] has parsed.
    #[must_use]
    pub fn of(matches: &ArgMatches) -> Self {
        Self {
            world: matches.get_one("world").cloned().unwrap_or_default(),
            start: matches.get_one("start").copied(),
            robots: matches.get_many("robot").unwrap_or_default().cloned().collect(),
            seed: matches.get_one("seed").copied(),
            link: matches.get_one("link").cloned(),
            lockstep: matches.get_one("lockstep").copied(),
            faults: matches.get_many("fault").unwrap_or_default().copied().collect(),
        }
    }
}

fn option(name: &'static str, value: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value)
}

/// Adds the options about the world and its robots to `command`.
fn of_robots(command: Command) -> Command {
    command
        .arg(
            option("world", "NAME|FILE")
                .help("World: office, maze, hall, room, or a TOML file")
                .default_value("office"),
        )
        .arg(
            option("start", "X,Y,DEG")
                .help("Start pose, in metres and degrees counter-clockwise [default: the world's]")
                .allow_hyphen_values(true)
                .value_parser(value_parser!(Start)),
        )
        .arg(
            option("robot", "NAME=X,Y,DEG")
                .help("Name and start pose of a robot; once per robot, for several robots in one world")
                .long_help(
                    "Name and start pose of a robot; once per robot, for several robots in one world\n\n\
                     The robots hear and touch each other. Each has a device of its own; with --link PATH its link is \
                     PATH-NAME.",
                )
                .allow_hyphen_values(true)
                .conflicts_with("start")
                .action(ArgAction::Append)
                .value_parser(value_parser!(NamedStart)),
        )
        .arg(
            option("seed", "N")
                .help("Random seed for sensor and wheel errors [default: no random errors]")
                .value_parser(value_parser!(u64)),
        )
}

/// Adds the options about lines, time and faults to `command`.
fn of_behavior(command: Command) -> Command {
    command
        .arg(option("link", "PATH").help("Path for a symbolic link to the device").value_parser(value_parser!(PathBuf)))
        .arg(
            option("lockstep", "TIME")
                .help(
                    "Simulated time per command, in milliseconds or as in `0.1s` [default: the time of the clock]",
                )
                .long_help(
                    "Simulated time per command, in milliseconds or as in `0.1s` [default: the time of the clock]\n\n\
                     From 1 ms to 10 s. A run in lockstep is the same each time. Once every robot has a driver, several \
                     robots wait for each other's commands.",
                )
                .value_parser(step_of_lockstep),
        )
        .arg(
            option("fault", "KIND[=N]@TIME")
                .help(
                    "Fault to inject, and the time after which it begins, in seconds or with a unit; repeatable",
                )
                .long_help(
                    "Fault to inject, and the time after which it begins, in seconds or with a unit; repeatable\n\n\
                     On the line: noise (noise=40: 40 bytes before each frame), dribble (byte by byte), check (one \
                     wrong bit per frame), lose (two frames of three), double, late (late=100 or late=100ms: each \
                     frame 100 ms late; not in lockstep), silence (the line from the robot is cut), deaf (the line to \
                     the robot is cut), close. In the robot: runaway (it keeps its speed), stuck-wheel (the right \
                     one), dead-sonar (the front ones), bumper, emergency, low-battery, plugged-in, no-pings, leap \
                     (positions leap by metres), hang (it repeats the same state). On the ATRV-mini: filler, and \
                     no-bumpers, no-translation, no-rotation, no-status (these reports stop). The time is that of the \
                     simulated world since the robot was switched on. A fault affects all robots.",
                )
                .action(ArgAction::Append)
                .value_parser(value_parser!(ScheduledFault)),
        )
}

/// Parses the period of `--lockstep`. The world advances by this period with each command.
fn step_of_lockstep(text: &str) -> Result<Duration, String> {
    Quantity::duration(text, "ms", Duration::from_millis(1), Duration::from_secs(10))
}

/// Name of a robot, and its start pose.
#[derive(Debug, Clone)]
pub(crate) struct NamedStart(pub(crate) String, pub(crate) Start);

impl FromStr for NamedStart {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, start) = text.split_once('=').ok_or("a name and a place are meant, as in `one=1,0.5,90`")?;
        let is_name = !name.is_empty() && name.chars().all(|letter| letter.is_alphanumeric() || "_-".contains(letter));
        if !is_name {
            return Err("a name has letters, digits, _ and -".to_owned());
        }
        let start = start.parse().map_err(|error: StartError| error.to_string())?;
        Ok(Self(name.to_owned(), start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_option_is_described_in_a_line() {
        let command = EmulatorOptions::arguments(Command::new("emulator"));
        let helps: Vec<_> = command.get_arguments().map(|option| option.get_help().unwrap_or_default()).collect();
        assert_eq!(helps.len(), 7);
        for help in helps.iter().map(ToString::to_string) {
            let is_phrase = help.starts_with(char::is_uppercase) && !help.ends_with('.');
            assert!(is_phrase && (10..=100).contains(&help.len()), "{help}");
        }
    }

    #[test]
    fn options_are_read_from_their_arguments() {
        let arguments = ["emulator", "--robot", "one=1,0,0", "--robot", "two=2,0,90", "--seed", "7", "--link", "line"];
        let more = ["--lockstep", "100ms", "--fault", "close@2", "--fault", "noise=40@3"];
        let matches =
            EmulatorOptions::arguments(Command::new("emulator")).get_matches_from(arguments.iter().chain(&more));
        let options = EmulatorOptions::of(&matches);
        let names: Vec<_> = options.robots.iter().map(|NamedStart(name, _)| name.as_str()).collect();
        assert_eq!((&*options.world, names, options.seed), ("office", vec!["one", "two"], Some(7)));
        assert_eq!((options.link, options.lockstep), (Some("line".into()), Some(Duration::from_millis(100))));
        assert_eq!((options.faults.len(), options.start.is_none()), (2, true));
    }
}
