//! Command-line options of the simulator: its world, its robot, and batches of runs.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use mdle_host::clap::parser::ValueSource;
use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{NamedFile, Pace, Time, read_file};
use mdle_simulator::{Body, Goal, Make, MapHeader, PARTS, Start, StartNoise, World};

/// Maximum size of a world file or map file, in bytes.
const LARGEST: u64 = 64_000_000;

/// Adds the options of the simulator to `command`.
pub(crate) fn arguments(command: Command) -> Command {
    of_runs(of_the_world(command))
}

fn of_the_world(command: Command) -> Command {
    command
        .arg(
            option("world", "NAME|FILE")
                .help("World: office, maze, hall, room, a TOML file or a ROS map [default: office]")
                .long_help(
                    "World: `office` (the floor of the paper), `maze`, `hall` or `room`, a TOML file (the page \"Worlds\" of \
                     the book has the format), or the YAML file of a ROS map [default: office]",
                )
                .value_parser(value_parser!(PathBuf)),
        )
        .arg(
            option("start", "X,Y,DEG")
                .help("Start pose, in metres and degrees counter-clockwise or as in `50cm,1m,90deg` [default: that of the world]")
                .allow_hyphen_values(true),
        )
        .arg(
            option("start-noise", "M,DEG")
                .help("Maximum random offset of the start pose, in metres and degrees; needs --seed")
                .long_help(
                    "Maximum random offset of the start pose: along each axis, in metres up to 100, and of the heading, in \
                     degrees up to 180; or with units, as in `10cm,5deg`. Needs --seed or --runs [default: 0,0]",
                )
                .allow_hyphen_values(true),
        )
        .arg(
            option("goal", "world|X,Y,RADIUS")
                .help("Place in which the plan must leave the robot: that of the world or a circle, as in `7,3,0.5`")
                .long_help(
                    "Place in which the plan must leave the robot: the goal of the world, or a circle in metres. A heading and \
                     its tolerance in degrees may follow: `X,Y,RADIUS,DEG,TOLERANCE`, as in `7,3,50cm,90,15`. The run is `arrived` if the robot is there when \
                     the plan is over, `bumped` if it then touches something, and `astray` if it is elsewhere; exit status 5 if \
                     it is not `arrived` [default: none]",
                )
                .allow_hyphen_values(true),
        )
        .arg(
            option("body", "ideal|scout|atrv").help("Body to simulate: exact, or with the errors of a real robot [default: ideal]").long_help(
                "Body to simulate. `ideal` has exact odometry and, without --seed, exact sonars. `scout` and `atrv` have \
                 the sonars and wheels of those robots, whose errors --seed draws [default: ideal]",
            ),
        )
        .arg(
            option("without", "PART,…")
                .help("Errors of the body to leave out, such as noise,slip").long_help(
                "Errors of the body to leave out, separated by commas: lobe, specular, minimum, steps, noise, outliers, \
                 order (sonars that fire in turn) and slip",
            ),
        )
        .arg(
            option("seed", "N")
                .help("Random seed for sensor and wheel errors [default: no random errors]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64)),
        )
        .arg(
            option("battery", "PERCENT")
                .help("Charge of the battery at the start, in percent [default: 100]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(..=100)),
        )
        .arg(
            option("speed", "real|max|N")
                .help("Speed of the simulated time: that of the clock, maximum, or N times the clock [default: real]")
                .allow_negative_numbers(true),
        )
}

fn of_runs(command: Command) -> Command {
    command
        .arg(
            option("runs", "N")
                .help("Number of runs, with consecutive seeds; print how they ended")
                .long_help(
                    "Number of runs, with consecutive seeds from --seed on [default: 1]. Prints how many ended by which cause, \
                     or with --goal how many are `arrived`, `bumped` or `astray`; with --require how many `ended otherwise`; \
                     how many are `timed out`, that is, stopped by --timeout, by --turns or else after an hour; the durations; \
                     and for runs that went alike a command that repeats the first. Exit status 0 if all ended as required, \
                     1 if not",
                )
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..))
                .conflicts_with_all(ONE_RUN),
        )
        .arg(
            option("jobs", "N")
                .help("Number of parallel runs; results do not depend on it [default: number of processors]")
                .allow_negative_numbers(true)
                .value_parser(value_parser!(u64).range(1..=1024))
                .requires("runs"),
        )
        .arg(
            Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print the results of --runs as JSON, with each run").requires("runs"),
        )
}

/// Options that show or record a single run.
const ONE_RUN: [&str; 4] = ["watch", "plot", "record", "trail"];

/// Options of a batch that are omitted from the command that repeats a single run of the batch.
const OF_SEVERAL: [&str; 5] = ["runs", "jobs", "json", "seed", "speed"];

/// Returns a long option with a value.
fn option(name: &'static str, value: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value)
}

/// Returns the speed at which time passes.
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

/// Returns the world that the option `--world` names; the office floor by default. A file has priority over a built-in
/// world of the same name.
pub(crate) fn world(matches: &ArgMatches) -> Result<World, String> {
    let Some(path) = matches.get_one::<PathBuf>("world") else {
        return World::office().map_err(|error| error.to_string());
    };
    match path.to_str().filter(|_| !path.exists()).and_then(World::named) {
        Some(world) => world.map_err(|error| error.to_string()),
        None => read(path),
    }
}

/// Returns the goal that the option `--goal` selects: the goal of the world, or the goal that the option describes.
/// Returns `None` if the option is absent.
pub(crate) fn goal(matches: &ArgMatches, world: &World) -> Result<Option<Goal>, String> {
    let Some(text) = matches.get_one::<String>("goal") else { return Ok(None) };
    if text == "world" {
        let name = world_name(matches);
        let none = || format!("--goal world: the world {name} has no goal; give one, as in `--goal 7,3,0.5`");
        return world.goal.map(Some).ok_or_else(none);
    }
    Goal::read(text).map(Some).map_err(|sentence| format!("--goal {text}: {sentence}"))
}

/// Returns the name of the world that the option `--world` names; for a file, its path without folders.
pub(crate) fn world_name(matches: &ArgMatches) -> String {
    let name = file(matches, "world").map(|path| path.file_name().unwrap_or(path.as_os_str()));
    name.map_or_else(|| "office".to_owned(), |name| name.display().to_string())
}

fn read(path: &Path) -> Result<World, String> {
    let shown = path.display().to_string();
    if !path.exists() {
        let worlds = World::names().collect::<Vec<_>>().join(", ");
        return Err(format!("--world {shown}: there is no such world or file; the worlds are {worlds}"));
    }
    let text = String::from_utf8(bytes(path)?).map_err(|_| format!("--world {shown}: the file is not UTF-8 text"))?;
    let is_map = path.extension().is_some_and(|extension| extension == "yaml" || extension == "yml");
    if !is_map {
        return World::parse(&shown, &text).map_err(|error| error.to_string());
    }
    let header = MapHeader::parse(&shown, &text).map_err(|error| error.to_string())?;
    let image = path.with_file_name(&header.image);
    header.world(&image.display().to_string(), &bytes(&image)?).map_err(|error| error.to_string())
}

fn bytes(path: &Path) -> Result<Vec<u8>, String> {
    read_file(path, LARGEST).map_err(|error| format!("--world {}: the file cannot be read: {error}", path.display()))
}

/// Returns the pose that the option `--start` gives, as text and parsed; `None` if the option is absent.
pub(crate) fn start(matches: &ArgMatches) -> Result<Option<(&str, Start)>, String> {
    let Some(text) = matches.get_one::<String>("start") else { return Ok(None) };
    let start = text.parse().map_err(|error| format!("--start {text}: {error}"))?;
    Ok(Some((text, start)))
}

/// Returns the settings of the simulated robot that the options `--body`, `--without` and `--seed` give.
pub(crate) fn make(matches: &ArgMatches) -> Result<Make, String> {
    let name = matches.get_one::<String>("body").map_or("ideal", String::as_str);
    let body = [Body::Ideal, Body::Scout, Body::Atrv].into_iter().find(|body| body.to_string() == name);
    let body = body.ok_or_else(|| format!("--body {name}: expected `ideal`, `scout` or `atrv`"))?;
    let text = matches.get_one::<String>("without").map_or("", String::as_str);
    // An empty text leaves nothing out.
    let parts = text.split(',').map(str::trim).filter(|_| !text.trim().is_empty());
    let without = parts.map(|name| {
        let found = PARTS.iter().find(|(known, _)| *known == name).map(|(_, part)| *part);
        found.ok_or_else(|| {
            let names = PARTS.map(|(name, _)| name).join(", ");
            format!("--without {text}: {name:?} is no part of a body; expected some of {names}")
        })
    });
    Ok(Make { body, without: without.collect::<Result<_, _>>()?, seed: matches.get_one("seed").copied() })
}

/// Returns the charge that the option `--battery` gives, from 0 to 1.
pub(crate) fn battery(matches: &ArgMatches) -> f64 {
    matches.get_one("battery").map_or(1.0, |percent: &u64| *percent as f64 / 100.0)
}

/// Returns the deviation of the start pose that the option `--start-noise` gives; `None` if the option is absent.
pub(crate) fn start_noise(matches: &ArgMatches) -> Result<Option<StartNoise>, String> {
    let Some(text) = matches.get_one::<String>("start-noise") else { return Ok(None) };
    StartNoise::read(text).map(Some).map_err(|sentence| format!("--start-noise {text}: {sentence}"))
}

/// Returns the number that the option `--runs` gives; `None` if the option is absent.
pub(crate) fn runs(matches: &ArgMatches) -> Option<NonZeroU64> {
    matches.get_one("runs").copied().and_then(NonZeroU64::new)
}

/// Returns the number that the option `--jobs` gives; `None` if the option is absent.
pub(crate) fn jobs(matches: &ArgMatches) -> Option<NonZeroUsize> {
    let jobs: u64 = matches.get_one("jobs").copied()?;
    usize::try_from(jobs).ok().and_then(NonZeroUsize::new)
}

/// Checks that the option `--speed` is not given for a batch in order to slow it down: the runs of a batch are always
/// made as fast as possible.
pub(crate) fn agree(matches: &ArgMatches) -> Result<(), String> {
    match time(matches)? {
        Time::Stepped(Pace::Times(times)) if matches.contains_id("speed") => Err(format!(
            "--speed {times}: several runs are made as fast as possible; leave --speed out, or run one seed alone"
        )),
        Time::Stepped(Pace::Times(_) | Pace::Max) | Time::Wall => Ok(()),
    }
}

/// Returns the options that were given and apply to every run of a batch, as words of a command.
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

/// Returns the path that the option `--plot`, `--record` or `--trail` gives; `None` if the option is absent.
pub(crate) fn file<'m>(matches: &'m ArgMatches, option: &str) -> Option<&'m Path> {
    matches.get_one::<PathBuf>(option).map(PathBuf::as_path)
}

/// Returns the files that the options of the simulator name.
pub(crate) fn files(matches: &ArgMatches) -> Vec<NamedFile> {
    let world = file(matches, "world");
    world.map(|path| NamedFile { option: "--world", path: path.to_owned(), is_written: false }).into_iter().collect()
}
