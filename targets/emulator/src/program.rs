//! The program of an emulated robot: its options, its world, and its end.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use mdle_host::{Quantity, read_text};
use mdle_simulator::{Body, Make, Simulated, Start, StartError, World};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::fault::At;
use crate::faulty::Faulty;
use crate::port::Port;
use crate::serve::{Embodied, Emulated, Pace};
use crate::several::{Seat, Several};

/// Maximum size of the file of a world, in bytes.
const LARGEST: u64 = 64_000_000;

/// The options of all robot emulators.
#[derive(Debug, Args)]
pub struct Options {
    /// World: office, maze, hall, room, or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "office")]
    world: String,
    /// Start pose, in metres and degrees counter-clockwise [default: the world's]
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<Start>,
    /// Name and start pose of a robot; once per robot, for several robots in one world
    ///
    /// The robots hear and touch each other. Each has a device of its own; with --link PATH its link is PATH-NAME.
    #[arg(long, value_name = "NAME=X,Y,DEG", allow_hyphen_values = true, conflicts_with = "start")]
    robot: Vec<NamedStart>,
    /// Random seed for sensor and wheel errors [default: no random errors]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Path for a symbolic link to the device
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// Simulated time per command, in milliseconds or as in `0.1s` [default: the time of the clock]
    ///
    /// From 1 ms to 10 s. A run in lockstep is the same each time. Once every robot has a driver, several robots wait
    /// for each other's commands.
    #[arg(long, value_name = "TIME", value_parser = step_of_lockstep)]
    lockstep: Option<Duration>,
    /// Fault to inject, and the time after which it begins, in seconds or with a unit; repeatable
    ///
    /// On the line: noise (noise=40: 40 bytes before each frame), dribble (byte by byte), check (one wrong bit per
    /// frame), lose (two frames of three), double, late (late=100 or late=100ms: each frame 100 ms late; not in
    /// lockstep), silence (the line from the robot is cut), deaf (the line to the robot is cut), close. In the robot:
    /// runaway (it keeps its speed), stuck-wheel (the right one), dead-sonar (the front ones), bumper, emergency,
    /// low-battery, plugged-in, no-pings, leap (positions leap by metres), hang (it repeats the same state). On the
    /// ATRV-mini: filler, and no-bumpers, no-translation, no-rotation, no-status (these reports stop). The time is that
    /// of the simulated world since the robot was switched on. A fault affects all robots.
    #[arg(long, value_name = "KIND[=N]@TIME")]
    fault: Vec<At>,
}

/// The time that a command lets pass with `--lockstep`.
fn step_of_lockstep(text: &str) -> Result<Duration, String> {
    Quantity::duration(text, "ms", Duration::from_millis(1), Duration::from_secs(10))
}

/// A robot's name and its start pose.
#[derive(Debug, Clone)]
struct NamedStart(String, Start);

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

/// Runs the robots that `made` makes of their bodies, until a signal comes. `name` is the robot's, as in `the Scout`;
/// `step` returns the time step of its body for a pace.
pub fn program<R: Emulated + Embodied>(
    name: &str,
    body: Body,
    options: &Options,
    step: fn(Pace) -> Duration,
    made: impl Fn(Simulated, Duration) -> Result<R, String>,
) -> ExitCode {
    match run(name, body, options, step, made) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // The status says it as well.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run<R: Emulated + Embodied>(
    name: &str,
    body: Body,
    options: &Options,
    step: fn(Pace) -> Duration,
    made: impl Fn(Simulated, Duration) -> Result<R, String>,
) -> Result<(), String> {
    let world = world(&options.world)?;
    let pace = options.lockstep.map_or(Pace::Real, Pace::Lockstep);
    let mut bodies = bodies(options, &world, body, step(pace))?;
    let over = over().map_err(|error| format!("signals cannot be caught: {error}"))?;
    let (mut seats, mut lines) = (Vec::new(), Vec::new());
    for (called, body) in bodies.drain(..) {
        let robot = Faulty::new(made(body, step(pace))?, &options.fault)?;
        let mut port = Port::open().map_err(|error| format!("no pseudo-terminal: {error}"))?;
        if let Some(link) = &options.link {
            let mut link = link.clone().into_os_string();
            called.iter().for_each(|called| link.push(format!("-{called}")));
            let link = PathBuf::from(link);
            port.link(&link).map_err(|error| format!("--link {}: {error}", link.display()))?;
        }
        let called = called.map_or(String::new(), |called| format!(" {called}"));
        lines.push(format!("{name}{called} is at {}", port.path().display()));
        seats.push(Seat { robot, port });
    }
    let mut robots = Several::of(seats).map_err(|error| format!("the lines cannot be watched: {error}"))?;
    // Without a reader there is still the link.
    let _ = writeln!(std::io::stdout(), "{}", lines.join("\n"));
    let line = robots.serve(pace, &|| !over.load(Ordering::Relaxed));
    if robots.seats().iter().any(|seat| seat.robot.is_closed()) {
        return Ok(());
    }
    line.map_err(|error| format!("the line failed: {error}"))
}

/// Returns the bodies that the options ask for, with their names if they have names. Each body has the places of the
/// others.
fn bodies(
    options: &Options,
    world: &World,
    body: Body,
    step: Duration,
) -> Result<Vec<(Option<String>, Simulated)>, String> {
    let alone = [(None, options.start.map_or(world.start, |start| start.0))];
    let named = options.robot.iter().map(|NamedStart(name, start)| (Some(name.clone()), start.0));
    let starts: Vec<_> = if options.robot.is_empty() { alone.to_vec() } else { named.collect() };
    if starts.len() > 1 && !world.things.is_empty() {
        return Err("several robots need a world in which nothing else moves".to_owned());
    }
    let mut bodies: Vec<(Option<String>, Simulated)> = Vec::new();
    for (number, (name, start)) in (0..).zip(starts) {
        // Each errs in its own way.
        let make = Make { body, without: Vec::new(), seed: options.seed.map(|seed: u64| seed.wrapping_add(number)) };
        let body = Simulated::with(&make, world, start, step).map_err(|error| error.to_string())?;
        if let Some(name) = &name {
            refuse(name, &body, &bodies)?;
        }
        bodies.push((name, body));
    }
    let footprints: Vec<_> = bodies.iter().map(|(_, body)| body.footprint()).collect();
    for (number, (_, body)) in bodies.iter_mut().enumerate() {
        let others =
            footprints.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, footprint)| *footprint);
        body.see(&others.collect::<Vec<_>>());
    }
    Ok(bodies)
}

/// Refuses a robot with the name of another one, or in its place.
fn refuse(name: &str, body: &Simulated, others: &[(Option<String>, Simulated)]) -> Result<(), String> {
    for (other, known) in others {
        if other.as_deref() == Some(name) {
            return Err(format!("--robot {name}: there are two of that name"));
        }
        if known.footprint().overlaps(&body.footprint()) {
            let other = other.as_deref().unwrap_or_default();
            return Err(format!("--robot {name}: it would stand in {other}"));
        }
    }
    Ok(())
}

/// Returns the flag that a signal to end this program sets.
fn over() -> std::io::Result<Arc<AtomicBool>> {
    let over = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        signal_hook::flag::register(signal, Arc::clone(&over))?;
    }
    Ok(over)
}

fn world(name: &str) -> Result<World, String> {
    if let Some(world) = World::named(name) {
        return world.map_err(|error| error.to_string());
    }
    if !Path::new(name).exists() {
        let worlds = World::names().collect::<Vec<_>>().join(", ");
        return Err(format!("--world {name}: there is no such world or file; the worlds are {worlds}"));
    }
    let text = read_text(Path::new(name), LARGEST).map_err(|error| format!("--world {name}: {error}"))?;
    World::parse(name, &text).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_is_a_regular_file() {
        let refusal = world("/dev/zero").map(drop).expect_err("a device");
        assert_eq!(refusal, "--world /dev/zero: it is a device; expected a regular file");
    }

    #[test]
    fn an_unknown_world_lists_the_worlds() {
        let refusal = world("hal").map(drop).expect_err("no such world");
        let worlds = "there is no such world or file; the worlds are office, maze, hall, room";
        assert_eq!(refusal, format!("--world hal: {worlds}"));
    }

    #[test]
    fn each_option_is_described_in_a_line() {
        let command = Options::augment_args(clap::Command::new("emulator"));
        let helps: Vec<_> = command.get_arguments().map(|option| option.get_help().unwrap_or_default()).collect();
        assert_eq!(helps.len(), 7);
        for help in helps.iter().map(ToString::to_string) {
            let is_phrase = help.starts_with(char::is_uppercase) && !help.ends_with('.');
            assert!(is_phrase && (10..=100).contains(&help.len()), "{help}");
        }
    }
}
