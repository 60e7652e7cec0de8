//! Main program of a robot emulator. It creates the world and the lines, and serves the lines until a signal arrives.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use mdle_host::read_text;
use mdle_simulator::{Body, Make, Simulated, World};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::faulty::Faulty;
use crate::options::{EmulatorOptions, NamedStart};
use crate::port::Port;
use crate::serve::{Embodied, Emulated, Pace};
use crate::several::{Seat, Several};

/// Maximum size of a world file, in bytes.
const LARGEST: u64 = 64_000_000;

/// Runs robots until a signal arrives; `made` creates each robot from its body. `name` is the robot type in messages,
/// such as `the Scout`. `step` returns the time step of a body at a pace.
pub fn program<R: Emulated + Embodied>(
    name: &str,
    body: Body,
    options: &EmulatorOptions,
    step: fn(Pace) -> Duration,
    made: impl Fn(Simulated, Duration) -> Result<R, String>,
) -> ExitCode {
    match run(name, body, options, step, made) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // If standard error is closed, the exit status still reports the error.
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run<R: Emulated + Embodied>(
    name: &str,
    body: Body,
    options: &EmulatorOptions,
    step: fn(Pace) -> Duration,
    made: impl Fn(Simulated, Duration) -> Result<R, String>,
) -> Result<(), String> {
    let world = world(&options.world)?;
    let pace = options.lockstep.map_or(Pace::Real, Pace::Lockstep);
    let mut bodies = bodies(options, &world, body, step(pace))?;
    let over = over().map_err(|error| format!("signals cannot be caught: {error}"))?;
    let (mut seats, mut lines) = (Vec::new(), Vec::new());
    for (called, body) in bodies.drain(..) {
        let robot = Faulty::new(made(body, step(pace))?, &options.faults)?;
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
    // If standard output is closed, a driver can still use the link.
    let _ = writeln!(std::io::stdout(), "{}", lines.join("\n"));
    let line = robots.serve(pace, &|| !over.load(Ordering::Relaxed));
    if robots.seats().iter().any(|seat| seat.robot.is_closed()) {
        return Ok(());
    }
    line.map_err(|error| format!("the line failed: {error}"))
}

/// Returns the bodies that the options define, with their names (`None` for a robot without a name). Each body detects
/// the other bodies by their footprints.
fn bodies(
    options: &EmulatorOptions,
    world: &World,
    body: Body,
    step: Duration,
) -> Result<Vec<(Option<String>, Simulated)>, String> {
    let alone = [(None, options.start.map_or(world.start, |start| start.0))];
    let named = options.robots.iter().map(|NamedStart(name, start)| (Some(name.clone()), start.0));
    let starts: Vec<_> = if options.robots.is_empty() { alone.to_vec() } else { named.collect() };
    if starts.len() > 1 && !world.things.is_empty() {
        return Err("several robots need a world in which nothing else moves".to_owned());
    }
    let mut bodies: Vec<(Option<String>, Simulated)> = Vec::new();
    for (number, (name, start)) in (0..).zip(starts) {
        // Each robot has its own random errors.
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

/// Returns an error if another robot has the same name, or if another robot's body overlaps this body.
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

/// Returns a flag that is set when a signal requests the end of this program.
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
}
