//! Tests `rotate` and `turn` on the simulated bodies, at the limits of their wheels and with turns of several
//! durations: the laws end at their heading, and the body does not overshoot.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_runtime::capability::Odometry;
use mdle_runtime::{Begin, Completes, Control, Frame, Law, Nanos, Output, Pose, Radians, Robot, Twist};
use mdle_sim::alphabet::{Rotate, Turn};
use mdle_sim::{Body, Make, Sensed, Simulated, World};

/// Result of a turn on the spot: angles in degrees by odometry, and the duration in seconds.
#[derive(Debug)]
struct Turned {
    /// Total turn, counter-clockwise positive.
    by: f64,
    /// Maximum angle from the start heading, in the direction of the turn.
    furthest: f64,
    seconds: f64,
}

/// Runs a turning law on a body on an empty floor, in turns of `period` milliseconds.
fn turned<C>(quark: &C, way: f64, make: &Make, period: u64) -> Turned
where
    C: Control<Sensed, Law: Completes<Sensed> + Law<Sensed, Input = Twist>>,
{
    let world = World::parse("an empty floor", "").expect("a good world");
    let mut robot = Simulated::with(make, &world, Pose::ORIGIN, Duration::from_millis(period)).expect("a start");
    let (mut input, mut law) = (Twist::default(), None);
    let (mut by, mut furthest, mut last) = (0.0, 0.0_f64, 0.0);
    for turn in 0..120_000 / period {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * period * 1_000_000);
        let heading = y.pose().theta.degrees();
        by += Radians::from_degrees(heading - last).wrapped().degrees();
        last = heading;
        furthest = furthest.max(by * way.signum());
        let law = law.get_or_insert_with(|| quark.begin(&y, Begin { now: t, frame: Frame(y.here().theta) }));
        if law.completed(&y, t) {
            return Turned { by, furthest, seconds: t.seconds() };
        }
        input = law.input(&y, t);
    }
    Turned { by, furthest, seconds: f64::INFINITY }
}

/// Returns all bodies, with and without their errors.
fn bodies() -> Vec<Make> {
    let of = |body| [None, Some(7)].map(|seed| Make { body, seed, ..Make::default() });
    [Body::Ideal, Body::Scout, Body::Atrv].into_iter().flat_map(of).collect()
}

/// Checks that this turn by `angle` degrees ends within 2 degrees of the angle, and never overshoots by more than that.
fn ends_well(turned: &Turned, angle: f64, what: &str) {
    assert!((turned.by - angle).abs() <= 2.0, "{what}: {turned:?}");
    assert!(turned.furthest <= angle.abs() + 2.0, "{what}: {turned:?}");
}

#[test]
fn turn_ends_at_its_angle_and_goes_no_further() {
    for make in bodies() {
        for angle in [3.0, 10.0, -45.0, 90.0, -180.0, 270.0, 400.0] {
            for period in [20, 50, 100, 200] {
                let quark = Turn::new(Radians::from_degrees(angle));
                let what = format!("{make:?}, {angle} degrees in turns of {period} ms");
                let turned = turned(&quark, angle, &make, period);
                ends_well(&turned, angle, &what);
                // The time at 0.8 rad/s, plus the time to come to rest.
                assert!(turned.seconds < angle.abs() / 45.0 + 4.0, "{what}: {turned:?}");
            }
        }
    }
}

#[test]
fn rotate_ends_at_its_heading_and_goes_no_further() {
    for make in bodies() {
        for (heading, way) in [(5.0, 5.0), (90.0, 90.0), (179.0, 179.0), (200.0, -160.0), (-30.0, -30.0)] {
            for period in [20, 50, 100, 200] {
                let quark = Rotate::new(Radians::from_degrees(heading));
                let what = format!("{make:?}, to {heading} degrees in turns of {period} ms");
                ends_well(&turned(&quark, way, &make, period), way, &what);
            }
        }
    }
}

#[test]
fn long_turns_of_the_machine_make_slow_turns_of_the_robot() {
    for make in bodies() {
        for angle in [75.0, 90.0, -130.0, 200.0] {
            for period in [500, 1000] {
                let turned = turned(&Turn::new(Radians::from_degrees(angle)), angle, &make, period);
                ends_well(&turned, angle, &format!("{make:?}, {angle} degrees in turns of {period} ms"));
            }
        }
    }
}
