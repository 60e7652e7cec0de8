//! The target `sim`, as the host runs plans on it.

use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{Refusal, Target, Time};
use mdle_runtime::Pose;

use crate::robot::Simulated;
use crate::start::Start;
use crate::whole_file::WholeFile;
use crate::{alphabet, options};

/// The target `sim`.
#[derive(Debug, Clone, Copy)]
pub struct Sim;

impl Target for Sim {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Simulated;

    fn arguments(command: Command) -> Command {
        options::arguments(command)
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        options::time(matches)
    }

    fn connect(matches: &ArgMatches, period: Duration) -> Result<Simulated, Refusal> {
        robot(matches, period).map_err(Refusal::Usage)
    }
}

/// The robot that the options describe; everything that can be refused is refused here, before anything moves.
fn robot(matches: &ArgMatches, period: Duration) -> Result<Simulated, String> {
    let world = options::world(matches)?;
    let given = options::start(matches)?;
    let Start(pose) = given.map_or(Start(world.start), |(_, start)| start);
    let robot = Simulated::with(&options::make(matches)?, &world, pose, period).map_err(|error| match given {
        Some((text, _)) => format!("--start {text}: {error}; {}", hint(&world.start)),
        None => format!("the world's own start pose: {error}; give another, as in `--start 1,2,90`"),
    })?;
    let robot = match options::file(matches, "trail") {
        Some(path) => robot.written_down(WholeFile::at("trail", path)?),
        None => robot,
    };
    match options::file(matches, "plot") {
        Some(path) => Ok(robot.drawn(WholeFile::at("plot", path)?, world)),
        None => Ok(robot),
    }
}

/// What can be typed instead.
fn hint(start: &Pose) -> String {
    // Degrees that were read from a file come back with a last digit of their own.
    let degrees = libm::round(start.theta.degrees() * 1e6) / 1e6;
    format!("the world's own start is `--start {},{},{degrees}`", start.x.0, start.y.0)
}
