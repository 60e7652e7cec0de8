//! Tests `advance` on the simulated bodies, at the limits of their wheels, with their errors, and with turns of several
//! durations: the law ends at rest at its distance, and the body does not overshoot.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use std::time::Duration;

use mdle_runtime::capability::Odometry;
use mdle_runtime::{Begin, Completes, Control, Frame, Law, Meters, MetersPerSecond, Nanos, Output, Pose, Robot, Twist};
use mdle_sim::alphabet::Advance;
use mdle_sim::{Body, Make, Simulated, World};

/// Result of a drive: metres by odometry, and seconds.
#[derive(Debug)]
struct Driven {
    /// Final distance ahead, in metres; `aside` is the distance to the left.
    ahead: f64,
    aside: f64,
    /// Maximum distance in the direction of travel, in metres.
    furthest: f64,
    /// Number of changes between forward and backward motion.
    hunts: u32,
    seconds: f64,
}

/// Runs `advance` on a body in an empty world, with turns of `period` milliseconds, and then for two more seconds in
/// which the robot should remain at rest.
fn driven(distance: f64, speed: f64, make: &Make, period: u64) -> Driven {
    let world = World::parse("an empty floor", "").expect("a good world");
    let mut robot = Simulated::with(make, &world, Pose::ORIGIN, Duration::from_millis(period)).expect("a start");
    let quark = Advance::new(Meters(distance), MetersPerSecond(speed));
    let (mut input, mut law, mut done) = (Twist::default(), None, None);
    let mut way = Driven { ahead: 0.0, aside: 0.0, furthest: 0.0, hunts: 0, seconds: f64::INFINITY };
    for turn in 0..120_000 / period {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * period * 1_000_000);
        (way.ahead, way.aside) = (y.pose().x.0, y.pose().y.0);
        way.furthest = way.furthest.max(way.ahead * distance.signum());
        let law = law.get_or_insert_with(|| quark.begin(&y, Begin { now: t, frame: Frame(y.here().theta) }));
        if done.is_none() && law.completed(&y, t) {
            (way.seconds, done) = (t.seconds(), Some(t));
        }
        if done.is_some_and(|done| t.since(done).seconds() >= 2.0) {
            return way;
        }
        let next = if done.is_some() { Twist::default() } else { law.input(&y, t) };
        way.hunts += u32::from(next.v.0 * input.v.0 < 0.0);
        input = next;
    }
    way
}

/// Returns all bodies, with and without their errors.
fn bodies() -> Vec<Make> {
    let of = |body| [None, Some(1), Some(7), Some(42)].map(|seed| Make { body, seed, ..Make::default() });
    [Body::Ideal, Body::Scout, Body::Atrv].into_iter().flat_map(of).collect()
}

#[test]
fn advance_ends_at_its_distance_and_goes_no_further() {
    for make in bodies() {
        for (distance, speed) in [(0.05, 0.2), (0.5, 0.1), (1.0, 0.2), (-1.0, 0.2), (3.0, 0.5), (-0.3, 0.4), (2.0, 1.0)]
        {
            for period in [20, 50, 100, 200] {
                let way = driven(distance, speed, &make, period);
                let what = format!("{make:?}, {distance} m at {speed} m/s in turns of {period} ms: {way:?}");
                assert!((way.ahead - distance).abs() <= 0.015 && way.aside.abs() <= 0.03, "{what}");
                assert!(way.furthest <= distance.abs() + 0.02 && way.hunts == 0, "{what}");
                assert!(way.seconds < distance.abs() / speed + 8.0, "{what}");
            }
        }
    }
}

#[test]
fn long_turns_of_the_machine_make_slow_ends() {
    for make in bodies() {
        for period in [500, 1000] {
            let way = driven(1.0, 0.2, &make, period);
            let what = format!("{make:?}, in turns of {period} ms: {way:?}");
            assert!((way.ahead - 1.0).abs() <= 0.03 && way.furthest <= 1.03 && way.hunts == 0, "{what}");
        }
    }
}
