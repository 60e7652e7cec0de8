//! The driver's reaction to each fault that the emulator can make, and the last command that the robot received.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_emulator::Order;
use mdle_runtime::SonarId;
use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_scout::{Fault, Garbled, LineFault, Output};

mod robot;

type Ran = mdle_emulator::Ran<robot::Robot>;

/// Returns the outcome of these faults while a driver asks for `speed`, in m/s, for fifty turns, and then stops.
fn ran(faults: &[&str], speed: fn(turn: u32) -> f64) -> Ran {
    mdle_emulator::ran(50, faults, speed).unwrap()
}

/// World time at which the faults have begun.
const BEGUN: Duration = Duration::from_secs(3);

/// Returns the last output of a robot that drives ahead and has this fault after three seconds.
fn last_output(fault: &str) -> Result<Output, Fault> {
    ran(&[&format!("{fault}@3")], ahead).output
}

fn fails(fault: &str) -> Fault {
    last_output(fault).expect_err(fault)
}

/// Returns a speed of 0.2 m/s.
fn ahead(_: u32) -> f64 {
    0.2
}

/// Returns a speed of 0.2 m/s until the fault has begun, and 0 after it.
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
    assert!(output.is_ok() && !robot.stands(), "{output:?}");
    assert!(sentence(stop).contains("still moved"));
    assert_eq!(robot.orders().last().unwrap().1, Order::LetGo);
    // Told to stand, it has a second and a bit.
    let Ran { output, stop, robot } = ran(&["runaway@3"], ahead_then_none);
    assert!(sentence(output.map(drop)).contains("does not obey"));
    assert!(sentence(stop).contains("still moved"));
    let first = robot.orders().iter().find(|(age, order)| *age > BEGUN && *order == Order::Stand).unwrap().0;
    let last = robot.orders().last().unwrap().0;
    assert!(last - first < Duration::from_millis(2500), "{first:?} {last:?}");
}

#[test]
fn a_robot_that_receives_nothing_is_a_fault() {
    let Ran { output, stop, robot } = ran(&["deaf@3"], ahead);
    assert_eq!(output.map(drop), Err(Fault::Line(LineFault::Silent)));
    assert_eq!(stop, Err(Fault::Line(LineFault::Silent)));
    assert_eq!(robot.orders().last().unwrap().1, Order::Drive);
}

#[test]
fn positions_that_leap_are_a_fault() {
    let Ran { output, stop, robot } = ran(&["leap@3"], ahead);
    assert!(sentence(output.map(drop)).contains("leap"));
    assert_eq!((stop, robot.stands()), (Ok(()), true));
}

#[test]
fn a_robot_that_falls_silent_is_told_to_stand_again_and_again() {
    let Ran { stop, robot, .. } = ran(&["silence@3"], ahead);
    assert_eq!((stop, robot.stands()), (Err(Fault::Line(LineFault::Silent)), true));
    let orders: Vec<Order> = robot.orders().iter().map(|(_, order)| order).collect();
    assert!(orders.ends_with(&[[Order::Stand; 5].as_slice(), &[Order::LetGo]].concat()), "{orders:?}");
}
