//! `advance D v`: drives the distance `D` straight ahead, or backwards if `D` is negative. The law is not in the paper;
//! this project has added it beside the paper's `goAvoid` (section IV-A).

use mdle_runtime::capability::{DiffDrive, Odometry};
use mdle_runtime::{Begin, Completes, Control, Law, Meters, MetersPerSecond, Nanos, Pose, Radians, Twist};

use crate::heading::turning;

/// Speed, in m/s, per metre of the remaining distance, so that a body at full speed begins to brake early enough not to
/// overshoot.
const GAIN: f64 = 1.0;
/// Maximum fraction of the remaining distance that one input may cover before the law runs again. An input takes effect
/// a turn later, so with a larger fraction the robot would oscillate.
const AT_ONCE: f64 = 0.25;
/// Distance, in metres, from the end at which the robot has arrived. For a distance that is shorter than twice this
/// value, half of it is used instead.
const NEAR: f64 = 0.01;
/// Speed, in m/s, below which the robot is treated as at rest.
const AT_REST: f64 = 0.02;

/// The control `advance`: `u_f = k(D − distance so far)`, limited to `v`, and `u_θ = k(θ_0 − θ)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advance {
    distance: Meters,
    speed: MetersPerSecond,
}

impl Advance {
    /// Creates the quark `advance distance speed`, which drives along the heading at which the atom begins, backwards
    /// if the distance is negative.
    #[must_use]
    pub const fn new(distance: Meters, speed: MetersPerSecond) -> Self {
        Self { distance, speed }
    }
}

/// The law of [`Advance`], which is done when the robot is at rest and the distance driven, measured along the heading
/// at which the atom began, differs by at most 1 cm from the required distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advancing {
    quark: Advance,
    /// The pose by odometry at which the atom began.
    from: Pose,
    /// Time of the previous request for an input; `None` before the first.
    before: Option<Nanos>,
}

impl Advancing {
    /// Returns the remaining distance, in metres, along the heading at which the atom began; negative if the
    /// robot has to go back.
    fn left<Y: Odometry>(&self, y: &Y) -> f64 {
        let here = y.pose();
        let (sin, cos) = libm::sincos(self.from.theta.0);
        let so_far = (here.x.0 - self.from.x.0) * cos + (here.y.0 - self.from.y.0) * sin;
        self.quark.distance.0 - so_far
    }
}

impl<Y: DiffDrive + Odometry> Control<Y> for Advance {
    type Law = Advancing;

    fn begin(&self, y: &Y, _: Begin) -> Advancing {
        Advancing { quark: *self, from: y.pose(), before: None }
    }
}

impl<Y: DiffDrive + Odometry> Law<Y> for Advancing {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let before = self.before.replace(t);
        let period = before.map_or(0.0, |before| t.since(before).seconds());
        let gain = if GAIN * period > AT_ONCE { AT_ONCE / period } else { GAIN };
        let fastest = self.quark.speed.0.abs();
        let off = Radians(self.from.theta.0 - y.pose().theta.0).wrapped();
        // `clamp` panics where a bound is not a number.
        let v = MetersPerSecond((gain * self.left(y)).max(-fastest).min(fastest));
        Twist { v, ..turning(off, y.steering().rotate, before, t) }
    }
}

impl<Y: DiffDrive + Odometry> Completes<Y> for Advancing {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        let near = NEAR.min(self.quark.distance.0.abs() / 2.0);
        self.left(y).abs() <= near && y.velocity().v.0.abs() < AT_REST
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{PERIOD, Sensed, begun, framed};

    /// Runs `advance` from the heading of `y`. In each of the first ten turns, the robot is pushed `push` degrees to
    /// the left. Returns the number of turns until it ends.
    fn advanced(distance: f64, speed: f64, y: &mut Sensed, push: f64) -> u64 {
        let mut law = Advance::new(Meters(distance), MetersPerSecond(speed)).begin(&*y, framed(77.0));
        for number in 0..2000 {
            let t = Nanos(number * 100_000_000);
            if law.completed(&*y, t) {
                return number;
            }
            let input = law.input(&*y, t);
            assert!(input.v.0.abs() <= speed, "{input:?}");
            y.drive(input);
            y.pose.theta.0 += if number < 10 { push.to_radians() } else { 0.0 };
            y.pose.theta = y.pose.theta.wrapped();
        }
        2000
    }

    #[test]
    fn ends_its_distance_ahead_whatever_the_heading_and_the_frame() {
        for distance in [1.0, -1.0, 0.005, 0.3, 5.0] {
            for heading in [0.0, 100.0, -179.0] {
                let mut y = Sensed::heading(heading);
                let turns = advanced(distance, 0.2, &mut y, 0.0);
                let goal = Pose::ORIGIN.towards(Radians::from_degrees(heading), Meters(distance));
                let off = y.pose.distance(&goal).0;
                assert!(off <= 0.01_f64.min(distance.abs() / 2.0), "{distance} at {heading}: {off} m off");
                assert!(turns as f64 * PERIOD < distance.abs() / 0.2 + 6.0, "{distance}: {turns} turns");
            }
        }
    }

    #[test]
    fn holds_its_heading_against_a_push() {
        for push in [2.0, -2.0] {
            let mut y = Sensed::heading(30.0);
            advanced(2.0, 0.2, &mut y, push);
            let off = Radians(y.pose.theta.0 - 30.0_f64.to_radians()).wrapped().degrees();
            assert!(off.abs() < 0.5, "{off} degrees off");
        }
    }

    #[test]
    fn goes_back_where_it_has_gone_too_far() {
        let mut y = Sensed::heading(0.0);
        let mut law = Advance::new(Meters(1.0), MetersPerSecond(0.2)).begin(&y, begun());
        y.pose.x = Meters(1.5);
        assert!(!law.completed(&y, Nanos(0)));
        assert_eq!(law.input(&y, Nanos(0)).v.0, -0.2);
    }

    #[test]
    fn is_not_done_before_it_is_at_rest() {
        let mut y = Sensed::heading(0.0);
        let law = Advance::new(Meters(1.0), MetersPerSecond(0.2)).begin(&y, begun());
        y.pose.x = Meters(1.0);
        assert!(law.completed(&y, Nanos(0)));
        y.velocity.v.0 = 0.05;
        assert!(!law.completed(&y, Nanos(0)));
    }
}
