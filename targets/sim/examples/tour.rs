//! The lab tour on the simulated robot without mdlec, with a robot that can be told to break down.
//!
//! `cargo run -p mdle-sim --example tour -- --watch --speed 10`. The tests of this package run it as a program.

#![allow(clippy::expect_used, reason = "a plan by hand has the atoms it says it has")]

#[path = "../tests/lab_tour/plan.rs"]
mod plan;

use std::process::ExitCode;
use std::time::Duration;

use mdle_host::clap::{Arg, ArgMatches, Command, value_parser};
use mdle_host::{Batch, Ended, Hosted, Judgement, NamedFile, Refusal, Standing, StopRequest, Target, Time, run};
use mdle_runtime::{Nanos, Robot, Twist};
use mdle_sim::{Fault, Observed, Sensed, Sim};

fn main() -> ExitCode {
    run::<Fragile, _>("LabTour", plan::Tour::new)
}

/// The simulated robot as a target, with one more option.
struct Fragile;

/// The robot, and how many exchanges it has left.
struct Breaking {
    robot: Observed,
    left: Option<u64>,
}

impl Target for Fragile {
    const NAME: &'static str = Sim::NAME;
    const PERIOD: Duration = Sim::PERIOD;
    type Robot = Breaking;

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

    fn leave_screen() {
        Sim::leave_screen();
    }

    fn screen(matches: &ArgMatches) -> bool {
        Sim::screen(matches)
    }

    fn batch(matches: &ArgMatches, period: Duration) -> Result<Option<Batch<Breaking>>, Refusal> {
        let Some(Batch { first, runs, jobs, json, robot, alone }) = Sim::batch(matches, period)? else {
            return Ok(None);
        };
        let left = matches.get_one("panic-at").copied();
        let robot = Box::new(move |seed| Ok(Breaking { robot: robot(seed)?, left }));
        Ok(Some(Batch { first, runs, jobs, json, robot, alone }))
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

impl Hosted for Breaking {
    fn began(&mut self, number: u64, law: &str, t: Nanos) {
        self.robot.began(number, law, t);
    }

    fn ended(&mut self, ended: &Ended<'_>) {
        self.robot.ended(ended);
    }

    fn looks(&self) -> bool {
        self.robot.looks()
    }

    fn turned(&mut self, standing: &Standing<'_>) {
        self.robot.turned(standing);
    }

    fn judged(&self) -> Option<Judgement> {
        self.robot.judged()
    }

    fn contacts(&self) -> u64 {
        self.robot.contacts()
    }

    fn finish(&mut self) -> Result<(), String> {
        self.robot.finish()
    }
}
