//! The driver's reaction to each fault that the emulator can make, and the last command that the robot received.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_atrv::{Fault, Garbled, LineFault, Output};
use mdle_emulator::Order;
use mdle_runtime::SonarId;
use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};

mod robot;

type Ran = mdle_emulator::Ran<robot::Robot>;

/// Returns the outcome of these faults while a driver asks for `speed`, in m/s, for fifty turns, and then stops.
fn ran(faults: &[&str], speed: fn(turn: u32) -> f64) -> Ran {
    ran_for(50, faults, speed)
}

/// Returns the outcome of these faults in a run of `turns` turns.
fn ran_for(turns: u32, faults: &[&str], speed: fn(turn: u32) -> f64) -> Ran {
    mdle_emulator::ran(turns, faults, speed).unwrap()
}

/// World time at which the faults have begun.
const BEGUN: Duration = Duration::from_secs(3);

/// Returns the reason for which a driver refuses a robot that has this fault from the beginning.
fn refused(fault: &str) -> String {
    sentence(mdle_emulator::started::<robot::Robot>(fault).unwrap())
}

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

/// Returns a speed of 0.2 m/s until the fault has begun, and 0 after it.
fn ahead_then_none(turn: u32) -> f64 {
    if turn < 30 { 0.2 } else { 0.0 }
}

#[test]
fn what_can_be_borne_is() {
    for fault in ["noise", "dribble", "double", "filler"] {
        let y = last_output(fault).expect(fault);
        let way = y.pose().x.0;
        assert!((way - 1.0).abs() < 0.03, "{fault}: {way} m");
    }
}

#[test]
fn what_cannot_be_borne_is_told() {
    assert!(matches!(fails("check"), Fault::Garbled(Garbled::Check(..))));
    // To tell where it is takes two frames.
    assert!(matches!(fails("lose"), Fault::Line(LineFault::Silent) | Fault::Untold(_)));
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
    assert_eq!(fails("emergency"), Fault::Braked);
}

/// Returns the sentence of a fault.
fn sentence(fault: Result<(), Fault>) -> String {
    fault.expect_err("a fault").to_string()
}

#[test]
fn a_robot_that_keeps_moving_is_a_fault() {
    // It does what it is told as long as that is what it does anyway.
    let Ran { output, stop, robot } = ran(&["runaway@3"], ahead);
    assert!(output.is_ok() && robot.velocity().v.0 > 0.19, "{output:?}");
    assert!(sentence(stop).contains("still moved"));
    assert_eq!(robot.orders().last().unwrap().1, Order::Brake);
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
    // The controller stops it after a second in which nothing came.
    let Ran { output, stop, robot } = ran(&["deaf@3"], ahead);
    assert!(sentence(output.map(drop)).contains("does not receive"));
    assert_eq!((stop, robot.velocity().v.0), (Err(Fault::Unheard), 0.0));
    // One that does not stop by itself.
    let Ran { output, stop, robot } = ran(&["deaf@3", "runaway@3"], ahead);
    assert!(sentence(output.map(drop)).contains("does not receive"));
    assert!(sentence(stop).contains("still moved"));
    assert_eq!(robot.orders().last().unwrap().1, Order::Drive);
}

#[test]
fn a_robot_without_its_brake_was_not_stopped() {
    // The run ends before an unanswered question is a fault, and after the robot has stopped itself.
    let Ran { output, stop, robot } = ran_for(42, &["deaf@3"], ahead);
    assert!(output.is_ok(), "{output:?}");
    assert_eq!((stop, robot.velocity().v.0, robot.is_braked()), (Err(Fault::Unheard), 0.0, false));
    // It answers, but its brake is not set.
    let Ran { output, stop, robot } = ran_for(42, &["runaway@3"], |_| 0.0);
    assert!(output.is_ok(), "{output:?}");
    assert!(sentence(stop).contains("brake is not set"));
    assert_eq!(robot.orders().last().unwrap().1, Order::Brake);
}

#[test]
fn each_kind_of_report_that_stops_is_a_fault() {
    for (fault, words) in [
        ("no-bumpers", "bumper"),
        ("no-translation", "how far it has moved"),
        ("no-rotation", "how far it has turned"),
        ("no-status", "does not receive"),
        ("leap", "leap"),
    ] {
        let Ran { output, stop, robot } = ran(&[&format!("{fault}@3")], ahead);
        let sentence = sentence(output.map(drop));
        assert!(sentence.contains(words), "{fault}: {sentence}");
        // Without an axis it does not report that it stands, without answers not that it is braked.
        let reports = ["no-bumpers", "leap"].contains(&fault);
        assert_eq!(stop.is_ok(), reports, "{fault}: {stop:?}");
        assert_eq!((robot.is_braked(), robot.velocity().v.0), (true, 0.0), "{fault}");
    }
}

#[test]
fn each_kind_of_report_is_waited_for_at_the_start() {
    for (fault, words) in [
        ("no-bumpers", "bumper"),
        ("no-translation", "how far it has moved"),
        ("no-rotation", "how far it has turned"),
        ("no-status", "does not receive"),
    ] {
        let refused = refused(fault);
        assert!(refused.contains(words), "{fault}: {refused}");
    }
}

#[test]
fn a_robot_that_falls_silent_stands_before_it_is_braked() {
    let Ran { stop, robot, .. } = ran(&["silence@3"], ahead);
    assert_eq!(stop, Err(Fault::Line(LineFault::Silent)));
    assert_eq!((robot.is_braked(), robot.velocity().v.0), (true, 0.0));
    let orders: Vec<Order> = robot.orders().iter().map(|(_, order)| order).collect();
    assert!(orders.ends_with(&[[Order::Stand; 8].as_slice(), &[Order::Brake]].concat()), "{orders:?}");
}
