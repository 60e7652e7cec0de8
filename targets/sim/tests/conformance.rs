//! Tests that the simulated robot conforms, with the ideal body and with the bodies of both real robots without errors.
//! Also tests that a robot with a fault in its driver does not conform, and that the report names the fault.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_conformance::{Room, Stage, Suite, Supplied, Verdict};
use mdle_host::Target as _;
use mdle_runtime::{Meters, MetersPerSecond, Nanos, PathStore, Ping, Pings, Pose, Radians, Robot};
use mdle_sim::{Body, Charger, Input, Make, Observed, Output, Simulated, Target, World, alphabet};

/// A body in a world that the suite creates.
struct InWorld(Make);

impl Stage for InWorld {
    type Robot = Observed;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<Observed, String> {
        let world = World::parse("the room", &room.to_string()).map_err(|error| error.to_string())?;
        let robot = Simulated::with(&self.0, &world, at, Duration::from_nanos(Self::PERIOD.0));
        robot.map(Observed::from).map_err(|error| error.to_string())
    }

    fn take_paths(&mut self, robot: &mut Observed, paths: PathStore) {
        if let Some(replays) = Target::PATHS {
            (replays.take)(robot, paths);
        }
    }

    fn supply(&mut self, robot: &mut Observed, supplied: Supplied) {
        let here = Charger { pose: robot.pose(), reach: 10.0 };
        match supplied {
            Supplied::Well => {}
            Supplied::Low => robot.supply(0.05, None),
            Supplied::Plugged => robot.supply(1.0, Some(here)),
        }
    }

    fn truth(&self, robot: &Observed) -> Pose {
        robot.pose()
    }

    fn left_alone(&mut self, robot: &mut Observed, periods: u32) {
        // The robot's time advances only with exchanges.
        for _ in 0..periods {
            let _ = robot.exchange(&Input::default()).unwrap();
        }
    }
}

fn conforms(body: Body, seed: Option<u64>) {
    let mut stage = InWorld(Make { body, without: Vec::new(), seed });
    let report = Suite::on(&mut stage).diff_drive().odometry().bumper().sonar().paths().power().report();
    assert!(report.holds(), "{report}");
}

#[test]
fn the_ideal_body_conforms() {
    conforms(Body::Ideal, None);
}

#[test]
fn the_body_of_a_scout_conforms() {
    conforms(Body::Scout, None);
}

#[test]
fn the_body_of_an_atrv_conforms() {
    conforms(Body::Atrv, None);
}

/// A robot whose driver has a fault.
struct Faulty {
    robot: Observed,
    fault: Fault,
    last: Input,
    is_stopped: bool,
}

/// Changes that a faulty driver makes to an input, to an output, and to a stop.
#[derive(Clone, Copy)]
struct Fault {
    input: fn(Input) -> Input,
    output: fn(&mut Output),
    stop: fn(&mut Faulty) -> Result<(), &'static str>,
}

const NONE: Fault = Fault { input: |input| input, output: |_| {}, stop: |faulty| faulty.robot.stop().map_err(|_| "") };

impl Robot for Faulty {
    type Output = Output;
    type Input = Input;
    type Error = &'static str;

    fn exchange(&mut self, input: &Input) -> Result<Output, &'static str> {
        self.last = *input;
        let mut y = self.robot.exchange(&(self.fault.input)(*input)).map_err(|_| "no number")?;
        (self.fault.output)(&mut y);
        Ok(y)
    }

    fn stop(&mut self) -> Result<(), &'static str> {
        self.last = Input::default();
        (self.fault.stop)(self)
    }
}

impl Stage for Fault {
    type Robot = Faulty;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    fn robot(&mut self, room: &Room, at: Pose) -> Result<Faulty, String> {
        let robot = InWorld(Make::default()).robot(room, at)?;
        Ok(Faulty { robot, fault: *self, last: Input::default(), is_stopped: false })
    }

    fn take_paths(&mut self, robot: &mut Faulty, paths: PathStore) {
        InWorld(Make::default()).take_paths(&mut robot.robot, paths);
    }

    fn truth(&self, robot: &Faulty) -> Pose {
        robot.robot.pose()
    }

    fn left_alone(&mut self, robot: &mut Faulty, periods: u32) {
        for _ in 0..periods {
            let _ = robot.robot.exchange(&robot.last).unwrap();
        }
    }
}

/// Replaces every ping by the result of `change`, as a faulty driver might.
fn repinged(y: &mut Output, change: impl Fn(usize, &Ping) -> Ping) {
    for pings in &mut y.pings {
        let kept: Vec<Ping> = pings.newest_first().enumerate().map(|(place, ping)| change(place, ping)).collect();
        *pings = Pings::default();
        kept.into_iter().rev().for_each(|ping| pings.push(ping));
    }
}

/// Returns the name of the first check that detects the fault, and its message.
fn found(mut fault: Fault) -> String {
    let parts: [fn(Suite<'_, Fault>) -> Suite<'_, Fault>; 5] = [
        |suite| suite.diff_drive(),
        |suite| suite.odometry(),
        |suite| suite.bumper(),
        |suite| suite.sonar(),
        |suite| suite.paths(),
    ];
    for part in parts {
        let report = part(Suite::on(&mut fault)).report();
        let broken = report.checked().iter().find_map(|checked| match &checked.verdict {
            Verdict::Broken(why) => Some(format!("{}: {}\n  {why}", checked.capability, checked.name)),
            Verdict::Holds | Verdict::NotOffered => None,
        });
        if let Some(broken) = broken {
            return broken;
        }
    }
    "nothing".to_owned()
}

#[test]
fn each_fault_of_a_driver_is_one_sentence() {
    let stuck = |faulty: &mut Faulty| {
        faulty.last = Input { v: MetersPerSecond(0.2), ..Input::default() };
        Ok(())
    };
    let once = |faulty: &mut Faulty| {
        let was = std::mem::replace(&mut faulty.is_stopped, true);
        if was { Err("it is stopped") } else { (NONE.stop)(faulty) }
    };
    let input = |input| found(Fault { input, ..NONE });
    let output = |output| found(Fault { output, ..NONE });
    let all = [
        found(NONE),
        input(|input| Input { v: MetersPerSecond(input.v.0 + 0.02), ..input }),
        input(|input| Input { v: MetersPerSecond(if input.v.0.is_nan() { 0.2 } else { input.v.0 }), ..input }),
        input(|input| Input { v: MetersPerSecond(if input.v.0 == 1.0 { 0.5 } else { input.v.0 }), ..input }),
        found(Fault { stop: stuck, ..NONE }),
        found(Fault { stop: once, ..NONE }),
        output(|y| y.shape.body_radius = Meters(205.0)),
        output(|y| y.shape.wheel_base = Meters(0.5)),
        output(|y| y.shape.confirmation = 0),
        output(|y| y.odometry.theta = Radians(y.odometry.theta.0.clamp(-1.5, 1.5))),
        output(|y| y.odometry.x = Meters(1.2 * y.odometry.x.0)),
        output(|y| y.velocity.v = MetersPerSecond(100.0 * y.velocity.v.0)),
        output(|y| y.switches = 0),
        output(|y| y.switches |= 4),
        output(|y| y.paths = PathStore::EMPTY),
        output(|y| y.at = Nanos::ZERO),
        output(|y| y.pings.swap(3, 5)),
        output(|y| repinged(y, |_, ping| Ping { range: ping.range.or(Some(Meters(9.0))), ..*ping })),
        output(|y| repinged(y, |_, ping| Ping { at: Nanos(ping.at.0 + 1_000_000_000), ..*ping })),
        output(|y| repinged(y, |_, ping| Ping { pose: Pose::ORIGIN, ..*ping })),
        output(|y| repinged(y, |place, ping| Ping { at: Nanos(place as u64), ..*ping })),
        output(|y| y.pings.iter_mut().for_each(|pings| *pings = Pings::default())),
    ];
    insta::assert_snapshot!(all.join("\n"));
}
