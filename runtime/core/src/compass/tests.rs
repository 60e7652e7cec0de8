//! Tests the compass with handwritten pings of robots in hallways and rooms.

use super::*;
use crate::capability::Steering;
use crate::{Mount, Ping};

const SHAPE: Shape = Shape {
    body_radius: Meters(0.3),
    half_length: Meters(0.3),
    half_width: Meters(0.3),
    wheel_base: Meters(0.4),
    sonars_apart: Some(Meters(0.33)),
    ring_radius: Meters(0.19),
    confirmation: 2,
    steering: Steering::USUAL,
};

/// The pings and the compass of a robot.
struct Trial {
    pings: [Pings; SONARS],
    compass: Compass,
    now: Nanos,
}

impl Trial {
    fn new() -> Self {
        Self { pings: [Pings::default(); SONARS], compass: Compass::default(), now: Nanos::ZERO }
    }

    /// Updates the compass with pings of these ranges, in metres, half a second later and at this pose.
    fn hears(&mut self, pose: Pose, ranges: &[(usize, f64)], shape: &Shape) {
        self.now = Nanos(self.now.0 + 500_000_000);
        for (sonar, range) in ranges {
            let range = Some(Meters(*range));
            self.pings[*sonar].push(Ping { range, at: self.now, pose, mount: Mount::default() });
        }
        self.compass.take(&self.pings, pose, shape);
    }

    /// Drives `metres` metres in a hallway 1.5 m wide whose axis deviates from the axis of odometry by `turned`
    /// degrees. Every seventh echo of the left sonar does not fit the wall, and the right wall recedes by `leads`
    /// metres in each step of 10 cm.
    fn drives(&mut self, turned: f64, metres: f64, leads: f64) {
        let theta = Radians::from_degrees(turned);
        for step in 1..=libm::round(metres / 0.1) as u32 {
            let pose = Pose { theta, ..Pose::ORIGIN.towards(theta, Meters(0.1 * f64::from(step))) };
            let left = if step % 7 == 0 { 1.2 } else { 0.56 };
            self.hears(pose, &[(4, left), (12, leads * f64::from(step) + 0.56)], &SHAPE);
        }
    }

    /// Returns the drift, in degrees, of a frame with an axis in the direction `axis`, in degrees.
    fn drift(&self, axis: f64) -> f64 {
        self.compass.drift(Radians::from_degrees(axis)).degrees()
    }
}

#[test]
fn walls_on_both_sides_tell_how_far_the_heading_is_off() {
    for turned in [-6.0, -4.0, 0.0, 4.0, 6.0] {
        let mut trial = Trial::new();
        trial.drives(turned, 4.0, 0.0);
        assert!((trial.drift(0.0) - turned).abs() < 1.0, "{turned}: {}", trial.drift(0.0));
        assert!((trial.drift(0.0) - trial.drift(90.0)).abs() < 1e-9);
    }
}

/// A plan may begin at any angle to the walls. Measurements in such a room are not used, because among furniture many
/// of them are not of a wall, but for a frame that is parallel to the walls.
#[test]
fn walls_askew_to_the_first_heading_measure_the_drift_of_a_frame_along_them() {
    for turned in [-40.0, 11.0, 20.0, 33.0, 45.0] {
        let mut trial = Trial::new();
        trial.drives(turned, 4.0, 0.0);
        assert!(trial.drift(turned).abs() < 1.0, "{turned}: {}", trial.drift(turned));
        trial.drives(turned + 4.0, 6.0, 0.0);
        assert_eq!([0.0, turned + 22.5].map(|axis| trial.drift(axis)), [0.0; 2], "{turned}");
        for axis in [turned, turned - 8.0, turned + 82.0] {
            let drift = trial.drift(axis) + off_quarter((axis - turned).to_radians()).to_degrees();
            assert!((drift - 4.0).abs() < 1.5, "{turned}, {axis}: {drift}");
        }
    }
}

/// The direction of the plan's first frame need not be that of any wall.
#[test]
fn no_frame_has_drifted_before_a_wall_is_measured() {
    let trial = Trial::new();
    assert_eq!([0.0, 8.6, -19.0].map(|axis| trial.drift(axis)), [0.0; 3]);
}

#[test]
fn a_short_way_and_walls_apart_tell_nothing() {
    for (metres, leads) in [(0.5, 0.0), (3.0, 0.03)] {
        let mut trial = Trial::new();
        trial.drives(6.0, metres, leads);
        assert!(trial.drift(0.0).abs() < 0.01, "{metres} m, {leads}: {}", trial.drift(0.0));
    }
}

#[test]
fn the_drift_is_kept_while_the_robot_turns() {
    let mut trial = Trial::new();
    trial.drives(6.0, 4.0, 0.0);
    for step in 0..=18 {
        let theta = Radians::from_degrees(6.0 + 5.0 * f64::from(step));
        trial.hears(Pose { theta, ..Pose::ORIGIN }, &[], &SHAPE);
    }
    assert!((trial.drift(0.0) - 6.0).abs() < 1.0, "{}", trial.drift(0.0));
    // A line 30 degrees off is not taken for a wall.
    trial.drives(126.0, 3.0, 0.0);
    assert!((trial.drift(0.0) - 6.0).abs() < 1.0, "{}", trial.drift(0.0));
}

/// The last measurement is the best estimate, however wrong it may have become.
#[test]
fn the_drift_is_kept_after_many_circles() {
    let mut trial = Trial::new();
    trial.drives(6.0, 4.0, 0.0);
    for step in 0..=360 {
        let theta = Radians::from_degrees(6.0 + 20.0 * f64::from(step)).wrapped();
        trial.hears(Pose { theta, ..Pose::ORIGIN }, &[], &SHAPE);
    }
    assert!((trial.drift(0.0) - 6.0).abs() < 1.0, "{}", trial.drift(0.0));
}

#[test]
fn a_wall_square_to_a_robot_measures_its_heading() {
    let measured = |degrees: f64, ranges: [f64; 3]| {
        let (mut trial, theta) = (Trial::new(), Radians::from_degrees(degrees));
        let [before, middle, behind] = ranges;
        trial.drives(0.0, 4.0, 0.0);
        // After a full circle, the heading is no longer known precisely.
        for step in 0..36 {
            let theta = Radians::from_degrees(10.0 * f64::from(step) + degrees);
            trial.hears(Pose { theta, ..Pose::ORIGIN }, &[], &SHAPE);
        }
        for _ in 0..20 {
            let ranges = [(3, before), (4, middle), (5, behind)];
            trial.hears(Pose { theta, ..Pose::ORIGIN }, &ranges, &SHAPE);
        }
        trial.drift(0.0)
    };
    let drift = measured(8.0, [0.5, 0.49, 0.5]);
    assert!((3.0..=8.0).contains(&drift), "{drift}");
    for ranges in [[0.5, 0.5, 0.7], [0.7, 0.5, 0.7], [1.7, 1.6, 1.7]] {
        assert!(measured(8.0, ranges).abs() < 0.5, "{ranges:?}");
    }
}

#[test]
fn a_robot_whose_sonars_ping_together_does_not_drift() {
    let mut trial = Trial::new();
    for step in 1..=40 {
        let pose = Pose { x: Meters(0.1 * f64::from(step)), theta: Radians::from_degrees(6.0), ..Pose::ORIGIN };
        trial.hears(pose, &[(4, 0.56), (12, 0.56)], &Shape { confirmation: 3, ..SHAPE });
    }
    assert_eq!(trial.drift(0.0), 0.0);
}
