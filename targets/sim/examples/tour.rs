//! Runs the lab tour on the simulated robot without mdlec. With the option `--panic-at`, the robot's driver panics.
//!
//! `cargo run -p mdle-sim --example tour -- --watch --speed 10`. The tests of this package run it as a program.

#![allow(clippy::expect_used, reason = "a plan by hand has the atoms it says it has")]

#[path = "../tests/lab_tour/plan.rs"]
mod plan;

use std::process::ExitCode;
use std::time::Duration;

use mdle_host::clap::{Arg, ArgMatches, Command, value_parser};
use mdle_host::{Batch, NamedFile, Observation, Refusal, SeveralRuns, StopRequest, Target, Time, run};
use mdle_runtime::{Robot, Twist};
use mdle_sim::{Fault, Observed, Sensed, Sim};

fn main() -> ExitCode {
    run::<Fragile, _>("LabTour", plan::Tour::new)
}

/// The simulated robot as a target with an additional option.
struct Fragile;

/// A robot, and the number of exchanges until its driver panics; `None` if its driver does not panic.
struct Breaking {
    robot: Observed,
    left: Option<u64>,
}

/// The simulator's functions for the observer of a run and for batches.
const SIM: Option<Observation<Observed>> = Sim::OBSERVATION;

/// Returns the simulator's batch of runs, with robots whose drivers can panic.
fn batch(matches: &ArgMatches, period: Duration) -> SeveralRuns<Breaking> {
    let batch = SIM.map_or(Ok(None), |sim| (sim.batch)(matches, period))?;
    let left = matches.get_one("panic-at").copied();
    Ok(batch.map(|Batch { first, runs, jobs, json, robot, alone }| {
        let robot = Box::new(move |seed| Ok(Breaking { robot: robot(seed)?, left }));
        Batch { first, runs, jobs, json, robot, alone }
    }))
}

impl Target for Fragile {
    const NAME: &'static str = Sim::NAME;
    const PERIOD: Duration = Sim::PERIOD;
    type Robot = Breaking;
    const OBSERVATION: Option<Observation<Breaking>> =
        Some(Observation { observer: |breaking| &mut breaking.robot, draws: true, batch });

    fn arguments(command: Command) -> Command {
        let option = Arg::new("panic-at").long("panic-at").value_name("N").value_parser(value_parser!(u64));
        Sim::arguments(command).arg(option.help("Panic at this exchange"))
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        Sim::time(matches)
    }

    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Breaking, Refusal> {
        Ok(Breaking { robot: Sim::connect(matches, period, request)?, left: matches.get_one("panic-at").copied() })
    }

    fn files(matches: &ArgMatches) -> Vec<NamedFile> {
        Sim::files(matches)
    }
}

impl Robot for Breaking {
    type Output = Sensed;
    type Input = Twist;
    type Error = Fault;

    #[expect(clippy::panic, reason = "shows what is left of a terminal after a bug")]
    fn exchange(&mut self, input: &Twist) -> Result<Sensed, Fault> {
        match &mut self.left {
            Some(0) => panic!("the robot fell apart"),
            Some(left) => *left -= 1,
            None => {}
        }
        self.robot.exchange(input)
    }

    fn stop(&mut self) -> Result<(), Fault> {
        self.robot.stop()
    }
}
