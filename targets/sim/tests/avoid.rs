//! Tests `goAvoid` on the simulated body: around boxes and through doorways, without contact.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use mdle_runtime::{
    Begin, Completes, Control, Frame, Law, Meters, MetersPerSecond, Nanos, Output, Pose, Radians, Robot, Twist,
};
use mdle_sim::alphabet::GoAvoid;
use mdle_sim::{Simulated, World};

/// Returns how many of ten robots, whose starts are spread across 10 cm, reach the point 6 m ahead without contact.
fn arrived(walls: &str) -> usize {
    let world = World::parse("a test's world", walls).expect("a good world");
    (0..10).filter(|start| reaches(&world, 0.05 * (f64::from(*start) / 4.5 - 1.0))).count()
}

fn reaches(world: &World, y: f64) -> bool {
    let period = std::time::Duration::from_millis(100);
    let start = Pose { y: Meters(y), ..Pose::ORIGIN };
    let mut robot = Simulated::new(world, start, None, period).expect("a start on the floor");
    let mut input = Twist::default();
    let mut law = None;
    for turn in 0..900 {
        let y = robot.exchange(&input).expect("finite inputs");
        let t = Nanos(turn * 100_000_000);
        let quark = GoAvoid::new(Radians(0.0), Meters(6.0), MetersPerSecond(0.2));
        let law = law.get_or_insert_with(|| quark.begin(&y, Begin { now: t, frame: Frame(y.here().theta) }));
        if mdle_runtime::capability::Bumpers::pressed(&y) {
            return false;
        }
        if law.completed(&y, t) {
            return true;
        }
        input = law.input(&y, t);
    }
    false
}

/// Returns a hallway of this width along the first axis, with the additional walls `more`.
fn hallway(width: f64, more: &str) -> String {
    let half = width / 2.0;
    format!("[[wall]]\npoints = [[-1, {half}], [8, {half}]]\n[[wall]]\npoints = [[-1, -{half}], [8, -{half}]]\n{more}")
}

#[test]
fn goes_round_a_box_at_the_wall_of_a_hallway() {
    assert_eq!(arrived(&hallway(1.5, "[[box]]\nmin = [3, -0.75]\nmax = [3.5, -0.35]")), 10);
}

/// Before ideal sonars heard the end of a wall that points at them, 4 of these robots passed it.
#[test]
fn goes_round_the_end_of_a_wall_along_its_way() {
    assert_eq!(arrived(&hallway(2.0, "[[wall]]\npoints = [[3, 0.002], [3.6, 0.002]]")), 10);
}

#[test]
fn goes_round_a_box_in_the_middle_of_a_wide_hallway() {
    assert_eq!(arrived(&hallway(2.0, "[[box]]\ncentre = [3, 0]\nsize = [0.4, 0.4]")), 10);
}

#[test]
fn goes_through_a_doorway() {
    for width in [0.7, 0.8, 0.9] {
        let half = width / 2.0;
        let doorway = format!("[[wall]]\npoints = [[3, {half}], [3, 1]]\n[[wall]]\npoints = [[3, -{half}], [3, -1]]");
        assert_eq!(arrived(&hallway(2.0, &doorway)), 10, "{width} m");
    }
}
