//! The driver's reaction to each fault that the emulator can make, and the last command that the robot received.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::time::Duration;

use mdle_emulator::{At, Driven, Faulty, Order, Pace, driven};
use mdle_host::StopRequest;
use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, Robot as _, SonarId, Twist};
use mdle_scout::{Clock, Config, Configured, Fault, Garbled, LineFault, Output, Scout};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_sim::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_millis(100);
const PACE: Pace = Pace::Lockstep(PERIOD);
/// A wall 4 m before the robot, and others far away.
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[4, -3], [4, 3], [-3, 3], [-3, -3], [4, -3]]";

/// The result of a run.
struct Ran {
    /// The last output, or the fault that ended the run.
    output: Result<Output, Fault>,
    /// The result of the stop.
    stop: Result<(), Fault>,
    robot: Faulty<Emulated>,
}

/// Returns an emulated robot with these faults.
fn emulated(faults: &[&str]) -> Faulty<Emulated> {
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let body = |step| Simulated::with(&make, &world, world.start, step).unwrap();
    let faults: Vec<At> = faults.iter().map(|fault| fault.parse().unwrap()).collect();
    Faulty::new(Emulated::new(body(PERIOD)).unwrap(), &faults).unwrap()
}

/// Opens the robot at this device.
fn connected(device: &Path) -> Result<Scout, Fault> {
    // No machine is so slow that an answer takes longer.
    let config = Config { answer: 3000, ..Configured::read(None, device.to_str()).unwrap().config };
    Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default())
}

/// Returns the outcome of these faults while a driver asks for `speed`, in m/s, for fifty turns, and then stops.
fn ran(faults: &[&str], speed: fn(turn: u32) -> f64) -> Ran {
    let Driven { result: (output, stop), served, robot } = driven(emulated(faults), PACE, |device| {
        let mut driver = connected(device).unwrap();
        let input = |turn| Twist { v: MetersPerSecond(speed(turn)), ..Twist::default() };
        let output = (0..50).try_fold(None, |_, turn| driver.exchange(&input(turn)).map(Some)).map(Option::unwrap);
        // As the host does, whatever has come.
        (output, driver.stop())
    })
    .unwrap();
    assert_eq!(served.is_err(), faults.iter().any(|fault| fault.starts_with("close")), "{served:?}");
    Ran { output, stop, robot }
}

/// When faults have begun, by the time of the robot's world.
const BEGUN: Duration = Duration::from_secs(3);

/// Returns the last output of a robot that drives ahead and has this fault after three seconds.
fn last_output(fault: &str) -> Result<Output, Fault> {
    ran(&[&format!("{fault}@3")], ahead).output
}

fn fails(fault: &str) -> Fault {
    last_output(fault).expect_err(fault)
}

/// Twenty centimetres a second.
fn ahead(_: u32) -> f64 {
    0.2
}

/// Twenty centimetres a second until the fault has begun, and none after it.
fn ahead_then_none(turn: u32) -> f64 {
    if turn < 30 { 0.2 } else { 0.0 }
}

#[test]
fn what_can_be_borne_is() {
    for fault in ["dribble", "double", "noise", "noise=1", "noise=400"] {
        let y = last_output(fault).expect(fault);
        let way = y.pose().x.0;
        assert!((way - 1.0).abs() < 0.03, "{fault}: {way} m");
    }
}

#[test]
fn what_cannot_be_borne_is_told() {
    assert!(matches!(fails("check"), Fault::Garbled(Garbled::Sum(..))));
    assert_eq!(fails("lose"), Fault::Line(LineFault::Silent));
    assert_eq!(fails("silence"), Fault::Line(LineFault::Silent));
    assert_eq!(fails("close"), Fault::Line(LineFault::Closed));
}

#[test]
fn what_its_body_suffers_is_felt() {
    let heading = |y: Output| y.pose().theta.degrees();
    let ahead = |y: &Output| y.pings(SonarId::new(0)).newest_first().next().unwrap().range;
    let well = last_output("low-battery").unwrap();
    assert!(!well.pressed() && ahead(&well).is_some() && heading(well).abs() < 1.0);
    assert!(last_output("bumper").unwrap().pressed());
    assert_eq!(ahead(&last_output("dead-sonar").unwrap()), None);
    // The right side stands, so that it turns to the right.
    let turned = heading(last_output("stuck-wheel").unwrap());
    assert!((-170.0..-20.0).contains(&turned), "{turned}");
    // Whoever drives on would do so without knowing.
    assert_eq!(fails("emergency"), Fault::EmergencyStop);
}

/// Returns the sentence of a fault.
fn sentence(fault: Result<(), Fault>) -> String {
    fault.expect_err("a fault").to_string()
}

#[test]
fn a_robot_that_keeps_moving_is_a_fault() {
    // It does what it is told as long as that is what it does anyway.
    let Ran { output, stop, robot } = ran(&["runaway@3"], ahead);
    assert!(output.is_ok() && !robot.robot().stands(), "{output:?}");
    assert!(sentence(stop).contains("still moved"));
    assert_eq!(robot.robot().orders().last().unwrap().1, Order::LetGo);
    // Told to stand, it has a second and a bit.
    let Ran { output, stop, robot } = ran(&["runaway@3"], ahead_then_none);
    assert!(sentence(output.map(drop)).contains("does not obey"));
    assert!(sentence(stop).contains("still moved"));
    let first = robot.robot().orders().iter().find(|(age, order)| *age > BEGUN && *order == Order::Stand).unwrap().0;
    let last = robot.robot().orders().last().unwrap().0;
    assert!(last - first < Duration::from_millis(2500), "{first:?} {last:?}");
}

#[test]
fn a_robot_that_receives_nothing_is_a_fault() {
    let Ran { output, stop, robot } = ran(&["deaf@3"], ahead);
    assert_eq!(output.map(drop), Err(Fault::Line(LineFault::Silent)));
    assert_eq!(stop, Err(Fault::Line(LineFault::Silent)));
    assert_eq!(robot.robot().orders().last().unwrap().1, Order::Drive);
}

#[test]
fn positions_that_leap_are_a_fault() {
    let Ran { output, stop, robot } = ran(&["leap@3"], ahead);
    assert!(sentence(output.map(drop)).contains("leap"));
    assert_eq!((stop, robot.robot().stands()), (Ok(()), true));
}

#[test]
fn a_robot_that_falls_silent_is_told_to_stand_again_and_again() {
    let Ran { stop, robot, .. } = ran(&["silence@3"], ahead);
    assert_eq!((stop, robot.robot().stands()), (Err(Fault::Line(LineFault::Silent)), true));
    let orders: Vec<Order> = robot.robot().orders().iter().map(|(_, order)| order).collect();
    assert!(orders.ends_with(&[[Order::Stand; 5].as_slice(), &[Order::LetGo]].concat()), "{orders:?}");
}
