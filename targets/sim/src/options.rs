//! The options of this target: `--world`, `--start`, `--seed`, `--speed`, `--plot` and `--trail`.

use std::path::{Path, PathBuf};

use mdle_host::clap::{Arg, ArgMatches, Command, value_parser};
use mdle_host::{Pace, Time};

use crate::start::Start;
use crate::world::World;

/// Adds the options to the executable's.
pub(crate) fn arguments(command: Command) -> Command {
    command
        .arg(
            option("world", "FILE")
                .help("The floor, a TOML file of walls and boxes [default: the office floor of the paper's tour]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("start", "X,Y,DEG")
                .help("Where the robot starts, in metres and degrees [default: as the world says]")
                .allow_hyphen_values(true),
        )
        .arg(
            option("seed", "N")
                .help("Make the sonars noisy, by this seed: 1.5 cm of error, 1 % of missed echoes [default: exact]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64)),
        )
        .arg(
            option("speed", "real|max|N")
                .help("How fast time passes: as outside, as fast as possible, or N times as fast [default: real]")
                .allow_negative_numbers(true),
        )
        .arg(
            option("plot", "FILE.svg")
                .help("Draw the floor, the way driven, where each atom began, and what was heard and touched")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("record", "FILE.svg")
                .help("Make a moving picture of the run, for a browser")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("trail", "FILE.csv")
                .help("Write down where the robot was in each turn: seconds, metres, degrees")
                .value_parser(value_parser!(PathBuf)),
        )
}

/// A long option with a value.
fn option(name: &'static str, value: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value)
}

/// How fast time passes.
pub(crate) fn time(matches: &ArgMatches) -> Result<Time, String> {
    let text = matches.get_one::<String>("speed").map_or("real", String::as_str);
    pace(text)
        .map(Time::Stepped)
        .ok_or_else(|| format!("--speed {text}: expected `real`, `max` or how many times as fast, as in `--speed 10`"))
}

fn pace(text: &str) -> Option<Pace> {
    match text {
        "real" => Some(Pace::Times(1.0)),
        "max" => Some(Pace::Max),
        number => number.parse().ok().filter(|times: &f64| times.is_finite() && *times > 0.0).map(Pace::Times),
    }
}

/// The world of `--world`, or the office floor.
pub(crate) fn world(matches: &ArgMatches) -> Result<World, String> {
    match matches.get_one::<PathBuf>("world") {
        Some(path) => read(path),
        None => World::office().map_err(|error| error.to_string()),
    }
}

fn read(path: &Path) -> Result<World, String> {
    let shown = path.display();
    let bytes = std::fs::read(path).map_err(|error| {
        format!("--world {shown}: the file cannot be read: {error}; without --world it is the office floor")
    })?;
    let text = String::from_utf8(bytes).map_err(|_| format!("--world {shown}: the file is not UTF-8 text"))?;
    World::parse(&shown.to_string(), &text).map_err(|error| error.to_string())
}

/// The pose of `--start`, as text and read.
pub(crate) fn start(matches: &ArgMatches) -> Result<Option<(&str, Start)>, String> {
    let Some(text) = matches.get_one::<String>("start") else { return Ok(None) };
    let start = text.parse().map_err(|error| format!("--start {text}: {error}"))?;
    Ok(Some((text, start)))
}

/// The seed of `--seed`.
pub(crate) fn seed(matches: &ArgMatches) -> Option<u64> {
    matches.get_one("seed").copied()
}

/// The path of `--plot`, `--record` or `--trail`.
pub(crate) fn file<'m>(matches: &'m ArgMatches, option: &str) -> Option<&'m Path> {
    matches.get_one::<PathBuf>(option).map(PathBuf::as_path)
}
