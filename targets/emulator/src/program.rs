//! The program of an emulated robot: its options, its world, and its end.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;
use mdle_sim::{Body, Make, Simulated, Start, World};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::fault::{At, Faulty};
use crate::port::Port;
use crate::serve::{Emulated, Pace, serve};

/// The options that all emulated robots have.
#[derive(Debug, Args)]
pub struct Options {
    /// The floor: office, maze, hall, room, or a TOML file.
    #[arg(long, value_name = "NAME|FILE", default_value = "office")]
    world: String,
    /// Where it stands, in metres and degrees [default: as the world says].
    #[arg(long, value_name = "X,Y,DEG", allow_hyphen_values = true)]
    start: Option<Start>,
    /// What its errors are drawn by [default: no errors].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Put a symbolic link to the device here.
    #[arg(long, value_name = "PATH")]
    link: Option<PathBuf>,
    /// Let the world pass on by so many milliseconds with each command, whatever the clock says.
    #[arg(long, value_name = "MS", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    lockstep: Option<u64>,
    /// What goes wrong, so many seconds after the robot was switched on by the time of its world; may be given more than
    /// once. On its line: noise, dribble (byte by byte), check (a bit of each frame is wrong), lose (two frames of three),
    /// double, silence, close. With itself: stuck-wheel (the right one), dead-sonar (the one in front), bumper, emergency,
    /// low-battery, and filler, for robots that know it.
    #[arg(long, value_name = "KIND@SECONDS")]
    fault: Vec<At>,
}

/// Runs the robot that `made` makes of a body, until a signal comes. `name` is the robot's, as in `the Scout`; the time of
/// its body passes in such steps as `step` says for a pace.
pub fn program<R: Emulated>(
    name: &str,
    body: Body,
    options: &Options,
    step: fn(Pace) -> Duration,
    made: impl FnOnce(Simulated, Duration) -> Result<R, String>,
) -> ExitCode {
    match run(name, body, options, step, made) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Whoever does not read it sees the status.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run<R: Emulated>(
    name: &str,
    body: Body,
    options: &Options,
    step: fn(Pace) -> Duration,
    made: impl FnOnce(Simulated, Duration) -> Result<R, String>,
) -> Result<(), String> {
    let world = world(&options.world)?;
    let pace = options.lockstep.map_or(Pace::Real, |period| Pace::Lockstep(Duration::from_millis(period)));
    let make = Make { body, without: Vec::new(), seed: options.seed };
    let start = options.start.map_or(world.start, |start| start.0);
    let step = step(pace);
    let body = Simulated::with(&make, &world, start, step).map_err(|error| error.to_string())?;
    let mut robot = Faulty::new(made(body, step)?, &options.fault)?;
    let over = over().map_err(|error| format!("signals cannot be caught: {error}"))?;
    let mut port = Port::open().map_err(|error| format!("no pseudo-terminal: {error}"))?;
    if let Some(link) = &options.link {
        port.link(link).map_err(|error| format!("--link {}: {error}", link.display()))?;
    }
    // Whoever does not read it knows the link.
    let _ = writeln!(std::io::stdout(), "{name} is at {}", port.path().display());
    let line = serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed));
    if robot.is_closed() {
        return Ok(());
    }
    line.map_err(|error| format!("the line failed: {error}"))
}

/// What turns true when this program is asked to end.
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
    let text = std::fs::read_to_string(name).map_err(|error| format!("--world {name}: {error}"))?;
    World::parse(name, &text).map_err(|error| error.to_string())
}
