//! Tests the body's motion, stops, slides and odometry.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use mdle_runtime::Radians;

use super::*;
use crate::model::{self, Model, ModelPart};
use crate::noise::{Noise, Purpose};
use crate::world::World;

/// A tenth of an inch per second, in m/s.
const UNIT: f64 = 0.00254;

fn twist(v: f64, omega: f64) -> Twist {
    Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
}

fn walls(text: &str) -> Walls {
    Walls::of(&World::parse("walls", text).expect("good walls"))
}

fn touches(body: &Body, walls: &Walls) -> bool {
    body.pressed(6, walls) != 0
}

/// Returns a body at rest at the origin.
fn at_rest(body: model::Body, seed: Option<u64>) -> Body {
    Body::new(Model::of(body, &[]).drive, Pose::ORIGIN, seed)
}

/// Returns a body that has driven from the origin with this input for this number of turns.
fn driven(input: Twist, turns: usize, walls: &Walls) -> Body {
    let mut body = at_rest(model::Body::Ideal, None);
    for _ in 0..turns {
        body.advance(&input, 0.1, walls);
    }
    body
}

#[test]
fn wheel_speeds_are_truncated_to_tenths_of_an_inch() {
    let body = driven(twist(0.2, 0.0), 10, &walls(""));
    assert_eq!(body.velocity().v, MetersPerSecond(78.0 * UNIT));
    assert_eq!(driven(twist(0.002, 0.0), 10, &walls("")).pose, Pose::ORIGIN);
}

#[test]
fn a_wheel_gains_a_metre_a_second_each_second() {
    let mut body = at_rest(model::Body::Ideal, None);
    for tenths in 1..=5 {
        body.advance(&twist(0.5, 0.0), 0.1, &walls(""));
        assert!((body.velocity().v.0 - 0.1 * f64::from(tenths)).abs() < 0.003, "{tenths}");
    }
    body.brake(&walls(""));
    assert_eq!(body.velocity(), Twist::default());
}

#[test]
fn a_wheel_that_would_be_too_fast_slows_both() {
    let velocity = driven(twist(2.0, 2.0), 40, &walls("")).velocity();
    assert!((velocity.v.0 - velocity.omega.0).abs() < 0.02, "{velocity:?}");
    assert!((velocity.v.0 + velocity.omega.0 * 0.34519 / 2.0 - 1.0).abs() < 0.01, "{velocity:?}");
}

#[test]
fn a_full_circle_comes_back() {
    let wide = walls("");
    let mut body = driven(twist(0.2, 0.5), 20, &wide);
    let (from, rate) = (body.pose, body.velocity().omega.0);
    body.advance(&twist(0.2, 0.5), std::f64::consts::TAU / rate, &wide);
    assert!(from.distance(&body.pose).0 < 1e-9 && (from.theta.0 - body.pose.theta.0).abs() < 1e-9);
}

#[test]
fn stops_at_a_wall_presses_the_bumper_and_may_turn_and_leave() {
    let wall = walls("[[wall]]\npoints = [[1, -1], [1, 1]]");
    let mut body = driven(twist(1.0, 0.0), 9, &wall);
    assert!(!touches(&body, &wall));
    body.advance(&twist(1.0, 0.0), 3.0, &wall);
    assert!(touches(&body, &wall));
    assert!((body.pose.x.0 - (1.0 - 0.205)).abs() < 1e-6 && body.pose.x.0 <= 1.0 - 0.205);
    body.advance(&twist(1.0, 1.0), 1.0, &wall);
    assert!(body.pose.theta.0 > 0.4 && touches(&body, &wall));
    body.advance(&twist(-0.3, 0.0), 1.0, &wall);
    assert!(!touches(&body, &wall));
}

#[test]
fn never_overlaps_a_wall_and_odometry_stays_true() {
    let world = World::office().expect("our own floor");
    let walls = Walls::of(&world);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut pressed = 0;
    for _ in 0..8 {
        let mut body = at_rest(model::Body::Ideal, None);
        for _ in 0..300 {
            let mut within = |most: f64| most * ((random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
            let input = twist(0.5 + within(0.7), within(4.0));
            for _ in 0..5 {
                body.advance(&input, 0.1, &walls);
                assert!(walls.clearance(Point::of(&body.pose), 1.0) >= 0.205);
                // The body starts at the origin, so both poses have the same coordinates.
                assert_eq!(body.pose, body.odometry());
                pressed += u32::from(touches(&body, &walls));
            }
        }
    }
    assert!(pressed > 200, "a run that touches nothing tests nothing: {pressed}");
}

#[test]
fn slides_along_a_wall_that_it_meets_aslant() {
    let wall = walls("[[wall]]\npoints = [[-1, 0.3], [9, 0.3]]");
    let mut body = at_rest(model::Body::Ideal, None);
    body.pose.theta = Radians(0.5);
    body.advance(&twist(0.5, 0.0), 4.0, &wall);
    assert!(body.pose.y.0 <= 0.095 && body.pose.y.0 > 0.0949, "{:?}", body.pose);
    // The wall stops only the part of the motion that is directed into it.
    assert!(body.pose.x.0 > 1.0, "{:?}", body.pose);
    assert_eq!(body.pressed(6, &wall), 0b10, "60 degrees to the left, where the wall is: {:?}", body.pose);
}

#[test]
fn a_corner_presses_the_switches_of_both_its_walls() {
    let corner = walls("[[wall]]\npoints = [[-3, 0.3], [1, 0.3], [1, -3]]");
    let mut body = at_rest(model::Body::Ideal, None);
    body.pose.theta = Radians(0.2);
    body.advance(&twist(0.5, 0.0), 9.0, &corner);
    assert_eq!(body.pressed(12, &corner), 0b1001, "ahead and to the left: {:?}", body.pose);
}

/// Returns a rectangle of 0.63 m by 0.54 m at the origin, at rest.
fn atrv() -> Body {
    at_rest(model::Body::Atrv, None)
}

#[test]
fn a_rectangle_meets_a_wall_with_its_front_and_a_doorway_with_its_sides() {
    let mut body = atrv();
    let wall = walls("[[wall]]\npoints = [[1, -1], [1, 1]]");
    body.advance(&twist(0.5, 0.0), 5.0, &wall);
    assert!((body.pose.x.0 - (1.0 - 0.315)).abs() < 1e-6, "{:?}", body.pose);
    assert_eq!(body.pressed(2, &wall), 0b01);
    for (half, passes) in [(0.275, true), (0.265, false)] {
        let doorway = format!("[[wall]]\npoints = [[1, 3], [1, {half}]]\n[[wall]]\npoints = [[1, -{half}], [1, -3]]");
        let mut body = atrv();
        body.advance(&twist(0.5, 0.0), 6.0, &walls(&doorway));
        assert_eq!(body.pose.x.0 > 2.5, passes, "{half}: {:?}", body.pose);
    }
}

#[test]
fn a_rectangle_that_turns_beside_a_wall_is_pushed_off_it() {
    let wall = walls("[[wall]]\npoints = [[-5, 0.28], [5, 0.28]]");
    let mut body = atrv();
    body.advance(&twist(0.0, 0.5), 6.0, &wall);
    assert!((2.5..3.0).contains(&body.pose.theta.0), "{:?}", body.pose);
    assert!((-0.14..-0.11).contains(&body.pose.y.0) && body.pose.x.0.abs() < 0.05, "{:?}", body.pose);
    let narrow = walls("[[wall]]\npoints = [[-5, 0.28], [5, 0.28]]\n[[wall]]\npoints = [[-5, -0.28], [5, -0.28]]");
    let mut body = atrv();
    body.advance(&twist(0.0, 0.5), 6.0, &narrow);
    assert!(body.pose.theta.0.abs() < 0.1 && body.velocity().omega.0.abs() < 0.1, "{:?}", body.pose);
    body.advance(&twist(0.0, -0.25), 0.1, &narrow);
    body.brake(&narrow);
    body.advance(&twist(0.5, 0.0), 3.0, &narrow);
    assert!(body.pose.x.0 > 1.0, "it turns back and leaves: {:?}", body.pose);
}

#[test]
fn nothing_is_passed_through_at_any_speed_and_period() {
    let mut random = Noise::of(7, Purpose::Ranges);
    let mut pressed = 0;
    for world in 0..60 {
        // Walls with free ends, wedges and boxes around the robot, some of them nearly touching.
        let mut text = String::new();
        while text.lines().count() < 40 {
            let mut within = |most: f64| most * (2.0 * random.uniform() - 1.0);
            let [x, y, along, up] = [within(2.0), within(2.0), within(1.5), within(1.5)];
            let wall = format!("[[wall]]\npoints = [[{x}, {y}], [{}, {}]]\n", x + along, y + up);
            if walls(&wall).clearance(Point { x: 0.0, y: 0.0 }, 1.0) > 0.45 {
                text += &wall;
            }
        }
        let walls = walls(&text);
        for kind in [model::Body::Ideal, model::Body::Scout, model::Body::Atrv] {
            let mut body = at_rest(kind, Some(world));
            for _ in 0..40 {
                let input = twist(0.3 + 1.5 * random.uniform(), 8.0 * (random.uniform() - 0.5));
                body.advance(&input, 2.0 * random.uniform() * random.uniform(), &walls);
                let gap = walls.gap(&body.footprint(), 2.0);
                assert!(gap >= -1e-6, "world {world}, {kind:?}: {gap} m");
                pressed += u32::from(touches(&body, &walls));
            }
        }
    }
    assert!(pressed > 1000, "a run that touches nothing tests nothing: {pressed}");
}

#[test]
fn a_seed_makes_odometry_drift_as_far_as_its_model_says() {
    let model = Model::of(model::Body::Scout, &[]);
    let slip = model.drive.slip.expect("a body that slips");
    let (mut ways, mut headings) = (Vec::new(), Vec::new());
    for seed in 0..300 {
        let mut body = at_rest(model::Body::Scout, Some(seed));
        body.advance(&twist(0.5, 0.0), 20.6, &walls(""));
        let truly = body.pose.x.0;
        ways.push(body.odometry().distance(&Pose::ORIGIN).0 / truly - 1.0);
        headings.push(body.odometry().theta.0);
    }
    let spread =
        |values: &[f64]| libm::sqrt(values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64);
    let way = 10.0;
    let heading = libm::sqrt((slip.bend * way) * (slip.bend * way) + slip.wander * slip.wander * way);
    assert!((spread(&ways) / slip.way - 1.0).abs() < 0.15, "{}", spread(&ways));
    assert!((spread(&headings) / heading - 1.0).abs() < 0.15, "{} {heading}", spread(&headings));
    let exact = Body::new(Model::of(model::Body::Scout, &[ModelPart::Slip]).drive, Pose::ORIGIN, Some(1));
    assert_eq!(exact.odometry(), Pose::ORIGIN);
}
