//! The options of this target: of its world, of how a run is shown and written down, and of several runs.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use mdle_host::clap::parser::ValueSource;
use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{Pace, Time};

use crate::model::{Body, PARTS};
use crate::robot::Make;
use crate::ros_map::Header;
use crate::start::Start;
use crate::start_noise::StartNoise;
use crate::world::World;

/// Adds the options to the executable's.
pub(crate) fn arguments(command: Command) -> Command {
    of_runs(of_outputs(of_the_world(command)))
}

fn of_the_world(command: Command) -> Command {
    command
        .arg(
            option("world", "NAME|FILE")
                .help("The floor: office, maze, hall, room, a TOML file, or a YAML map of ROS [default: office, the paper's]")
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("start", "X,Y,DEG")
                .help("Where the robot starts, in metres and degrees [default: as the world says]")
                .allow_hyphen_values(true),
        )
        .arg(
            option("start-noise", "M,DEG")
                .help(
                    "Start off that pose by chance: by up to so many metres along each axis, and degrees; needs a seed",
                )
                .allow_hyphen_values(true),
        )
        .arg(
            option("body", "ideal|scout|atrv").help(
                "What is simulated: `scout` and `atrv` have sonars and wheels as those robots do [default: ideal]",
            ),
        )
        .arg(
            option("without", "PART,…")
                .help("Leave out lobe, specular, minimum, steps, noise, outliers, order or slip of the body"),
        )
        .arg(
            option("seed", "N")
                .help("What errors are drawn by: those of the sonars, and of wheels that slip [default: no errors]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64)),
        )
        .arg(
            option("speed", "real|max|N")
                .help("How fast time passes: as outside, as fast as possible, or N times as fast [default: real]")
                .allow_negative_numbers(true),
        )
}

fn of_outputs(command: Command) -> Command {
    command
        .arg(
            Arg::new("watch")
                .long("watch")
                .action(ArgAction::SetTrue)
                .help("Show the floor, the robot, the running atom and the timers while it runs, in this terminal"),
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

fn of_runs(command: Command) -> Command {
    command
        .arg(
            option("runs", "N")
                .help(
                    "Run the plan N times, with a seed each from --seed on [default: 1], and say how many arrived; exit \
                     status 0 if all did, 1 if not",
                )
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..))
                .conflicts_with_all(ONE_RUN),
        )
        .arg(
            option("jobs", "N")
                .help("How many runs are made at the same time; what comes out is the same [default: one a processor]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..=1024))
                .requires("runs"),
        )
        .arg(
            Arg::new("json").long("json").action(ArgAction::SetTrue).help("Say it as JSON, each run told").requires("runs"),
        )
}

/// What shows or writes down one run.
const ONE_RUN: [&str; 4] = ["watch", "plot", "record", "trail"];

/// What a run of several is not told when it is made alone.
const OF_SEVERAL: [&str; 5] = ["runs", "jobs", "json", "seed", "speed"];

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

/// The world of `--world`, or the office floor. A file goes before a world of ours with that name.
pub(crate) fn world(matches: &ArgMatches) -> Result<World, String> {
    let Some(path) = matches.get_one::<PathBuf>("world") else {
        return World::office().map_err(|error| error.to_string());
    };
    match path.to_str().filter(|_| !path.exists()).and_then(World::named) {
        Some(world) => world.map_err(|error| error.to_string()),
        None => read(path),
    }
}

fn read(path: &Path) -> Result<World, String> {
    let shown = path.display().to_string();
    let text = String::from_utf8(bytes(path)?).map_err(|_| format!("--world {shown}: the file is not UTF-8 text"))?;
    let is_map = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    if !is_map {
        return World::parse(&shown, &text).map_err(|error| error.to_string());
    }
    let header = Header::parse(&shown, &text).map_err(|error| error.to_string())?;
    let image = path.with_file_name(&header.image);
    header.world(&image.display().to_string(), &bytes(&image)?).map_err(|error| error.to_string())
}

fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| {
        let shown = path.display();
        format!("--world {shown}: the file cannot be read: {error}; without --world it is the office floor")
    })
}

/// The pose of `--start`, as text and read.
pub(crate) fn start(matches: &ArgMatches) -> Result<Option<(&str, Start)>, String> {
    let Some(text) = matches.get_one::<String>("start") else { return Ok(None) };
    let start = text.parse().map_err(|error| format!("--start {text}: {error}"))?;
    Ok(Some((text, start)))
}

/// What `--body`, `--without` and `--seed` say is to be simulated.
pub(crate) fn make(matches: &ArgMatches) -> Result<Make, String> {
    let body = match matches.get_one::<String>("body").map_or("ideal", String::as_str) {
        "ideal" => Body::Ideal,
        "scout" => Body::Scout,
        "atrv" => Body::Atrv,
        other => return Err(format!("--body {other}: expected `ideal`, `scout` or `atrv`")),
    };
    let text = matches.get_one::<String>("without").map_or("", String::as_str);
    let parts = text.split(',').map(str::trim).filter(|name| !name.is_empty());
    let without = parts.map(|name| {
        let found = PARTS.iter().find(|(known, _)| *known == name).map(|(_, part)| *part);
        found.ok_or_else(|| {
            let names = PARTS.map(|(name, _)| name).join(", ");
            format!("--without {text}: {name:?} is no part of a body; expected some of {names}")
        })
    });
    Ok(Make { body, without: without.collect::<Result<_, _>>()?, seed: matches.get_one("seed").copied() })
}

/// Whether the run is to be shown as it goes.
pub(crate) fn watch(matches: &ArgMatches) -> bool {
    matches.get_flag("watch")
}

/// The start noise of `--start-noise`.
pub(crate) fn start_noise(matches: &ArgMatches) -> Result<Option<StartNoise>, String> {
    let Some(text) = matches.get_one::<String>("start-noise") else { return Ok(None) };
    let sentence = "expected metres,degrees: up to 100 and 180, as in `0.1,5`";
    StartNoise::read(text).map(Some).ok_or_else(|| format!("--start-noise {text}: {sentence}"))
}

/// The number of `--runs`.
pub(crate) fn runs(matches: &ArgMatches) -> Option<NonZeroU64> {
    matches.get_one("runs").copied().and_then(NonZeroU64::new)
}

/// The number of `--jobs`.
pub(crate) fn jobs(matches: &ArgMatches) -> Option<NonZeroUsize> {
    let jobs: u64 = matches.get_one("jobs").copied()?;
    usize::try_from(jobs).ok().and_then(NonZeroUsize::new)
}

/// Whether the other options make sense where there are several runs.
pub(crate) fn agree(matches: &ArgMatches) -> Result<(), String> {
    match time(matches)? {
        Time::Stepped(Pace::Times(times)) if matches.contains_id("speed") => Err(format!(
            "--speed {times}: several runs are made as fast as possible; leave --speed out, or run one seed alone"
        )),
        Time::Stepped(Pace::Times(_) | Pace::Max) | Time::Wall => Ok(()),
    }
}

/// The options given that any one of several runs is made with, as words.
pub(crate) fn given(matches: &ArgMatches) -> Vec<String> {
    let names = matches.ids().map(|id| id.as_str()).filter(|name| !OF_SEVERAL.contains(name));
    let given = names.filter(|name| matches.value_source(name) == Some(ValueSource::CommandLine));
    let words = given.flat_map(|name| {
        let values = matches.get_raw(name).into_iter().flatten();
        values.map(move |value| (name, value.to_string_lossy())).flat_map(|(name, value)| {
            if value.starts_with('-') {
                vec![format!("--{name}={value}")]
            } else {
                vec![format!("--{name}"), value.into_owned()]
            }
        })
    });
    words.collect()
}

/// The path of `--plot`, `--record` or `--trail`.
pub(crate) fn file<'m>(matches: &'m ArgMatches, option: &str) -> Option<&'m Path> {
    matches.get_one::<PathBuf>(option).map(PathBuf::as_path)
}
