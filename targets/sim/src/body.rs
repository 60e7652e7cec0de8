//! The body: a disc on two driven wheels, with the limits of its motors, that stops at walls
//! (`dx/dt = f(x) + G(x) u`, paper, Eq. 1).

use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, Twist};

use crate::walls::Walls;
use crate::world::Place;

/// The radius of the disc, in metres.
pub(crate) const RADIUS: f64 = 0.205;
/// The distance between the wheels, in metres.
pub(crate) const WHEEL_BASE: f64 = 0.34519;
/// The fastest a wheel turns, in m/s.
const FASTEST: f64 = 1.0;
/// How fast the speed of a wheel changes, in m/s².
const ACCELERATION: f64 = 1.0;
/// Wheel speeds are commanded in whole tenths of an inch a second; this many metres a second, rounded towards zero.
const UNIT: f64 = 0.00254;
/// The longest step of the integration, in seconds: at most a centimetre of way, so no wall is stepped over.
const STEP: f64 = 0.01;
/// How near a wall must be for the bumper to feel it, in metres.
const FEELS: f64 = 0.001;

/// Where the body is and how it moves.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Body {
    /// On the floor.
    pub(crate) pose: Pose,
    /// By the turns of the wheels: the origin at the start.
    pub(crate) odometry: Pose,
    /// The speed of the left wheel, in m/s.
    left: f64,
    /// The speed of the right wheel, in m/s.
    right: f64,
}

/// What the body ran into in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Met {
    Nothing,
    Wall,
}

impl Body {
    /// At rest at `pose`.
    pub(crate) fn at(pose: Pose) -> Self {
        Self { pose, odometry: Pose::ORIGIN, left: 0.0, right: 0.0 }
    }

    /// The velocities of the wheels, as a twist of the body.
    pub(crate) fn velocity(&self) -> Twist {
        Twist {
            v: MetersPerSecond((self.left + self.right) / 2.0),
            omega: RadiansPerSecond((self.right - self.left) / WHEEL_BASE),
        }
    }

    /// Whether a bumper is in contact.
    pub(crate) fn touches(&self, walls: &Walls) -> bool {
        walls.distance(Place::of(&self.pose)) < RADIUS + FEELS
    }

    /// Moves for `seconds` with this input, which must be finite.
    pub(crate) fn advance(&mut self, input: &Twist, seconds: f64, walls: &Walls) {
        let (left, right) = commanded(input);
        let steps = libm::ceil(seconds / STEP).max(1.0);
        let step = seconds / steps;
        // A period is at most a minute, so this fits.
        for _ in 0..steps as u32 {
            let across = self.right - self.left;
            self.left = approached(self.left, left, ACCELERATION * step);
            self.right = approached(self.right, right, ACCELERATION * step);
            if self.step(step, walls) == Met::Wall {
                // The wheels stall as far as they push, and gain speed only against each other.
                let across = approached(across, right - left, 2.0 * ACCELERATION * step);
                (self.left, self.right) = (-across / 2.0, across / 2.0);
            }
        }
    }

    /// Brakes until the wheels stand still.
    pub(crate) fn brake(&mut self, walls: &Walls) {
        self.advance(&Twist::default(), FASTEST / ACCELERATION + STEP, walls);
    }

    /// One step of the integration. Against a wall the body may turn, but goes no further; nor do the wheels, so that
    /// odometry does not run away.
    fn step(&mut self, step: f64, walls: &Walls) -> Met {
        let Twist { v, omega } = self.velocity();
        let (way, turn) = (v.0 * step, omega.0 * step);
        let free = |part: f64| walls.distance(Place::of(&moved(&self.pose, way * part, turn))) >= RADIUS;
        let part = if way == 0.0 || free(1.0) { 1.0 } else { last_free(free) };
        self.pose = moved(&self.pose, way * part, turn);
        self.odometry = moved(&self.odometry, way * part, turn);
        if part < 1.0 { Met::Wall } else { Met::Nothing }
    }
}

/// The wheel speeds of an input: both slowed alike where one is too fast, so the curve stays the same, then truncated.
fn commanded(input: &Twist) -> (f64, f64) {
    let across = input.omega.0 * (WHEEL_BASE / 2.0);
    let (left, right) = (input.v.0 - across, input.v.0 + across);
    let scale = (left.abs().max(right.abs()) / FASTEST).max(1.0);
    let truncated = |speed: f64| libm::trunc(speed / scale / UNIT) * UNIT;
    (truncated(left), truncated(right))
}

/// A speed that has come nearer to the commanded one, by `most` at most.
fn approached(speed: f64, commanded: f64, most: f64) -> f64 {
    speed + (commanded - speed).clamp(-most, most)
}

/// The pose after an arc of length `way` that turns by `turn`: exactly, by its chord.
fn moved(pose: &Pose, way: f64, turn: f64) -> Pose {
    let half = turn / 2.0;
    let chord = if half.abs() < 1e-9 { way } else { way * libm::sin(half) / half };
    let end = pose.towards(Radians(pose.theta.0 + half), Meters(chord));
    Pose { theta: Radians(pose.theta.0 + turn).wrapped(), ..end }
}

/// The largest part of a step, to a millionth, after which the body is still free; 0 if none is.
fn last_free(free: impl Fn(f64) -> bool) -> f64 {
    let (mut least, mut most) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = (least + most) / 2.0;
        if free(middle) {
            least = middle;
        } else {
            most = middle;
        }
    }
    least
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;
    use crate::world::World;

    fn twist(v: f64, omega: f64) -> Twist {
        Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
    }

    fn walls(text: &str) -> Walls {
        Walls::of(&World::parse("walls", text).expect("good walls"))
    }

    /// A body at the origin that has driven this long with this input.
    fn driven(input: Twist, turns: usize, walls: &Walls) -> Body {
        let mut body = Body::at(Pose::ORIGIN);
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
        let mut body = Body::at(Pose::ORIGIN);
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
        assert!((velocity.v.0 + velocity.omega.0 * WHEEL_BASE / 2.0 - FASTEST).abs() < 0.01, "{velocity:?}");
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
        assert!(!body.touches(&wall));
        body.advance(&twist(1.0, 0.0), 3.0, &wall);
        assert!(body.touches(&wall));
        assert!((body.pose.x.0 - (1.0 - RADIUS)).abs() < 1e-6 && body.pose.x.0 <= 1.0 - RADIUS);
        body.advance(&twist(1.0, 1.0), 1.0, &wall);
        assert!(body.pose.theta.0 > 0.4 && body.touches(&wall));
        body.advance(&twist(-0.3, 0.0), 1.0, &wall);
        assert!(!body.touches(&wall));
    }

    #[test]
    fn never_overlaps_a_wall_and_odometry_stays_true() {
        let world = World::office().expect("our own floor");
        let walls = Walls::of(&world);
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut pressed = 0;
        for _ in 0..8 {
            let mut body = Body::at(Pose::ORIGIN);
            for _ in 0..300 {
                let mut within = |most: f64| most * ((random.next_u64() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0);
                let input = twist(0.5 + within(0.7), within(4.0));
                for _ in 0..5 {
                    body.advance(&input, 0.1, &walls);
                    assert!(walls.distance(Place::of(&body.pose)) >= RADIUS);
                    // It starts in the origin, so the two are the same numbers.
                    assert_eq!(body.pose, body.odometry);
                    pressed += u32::from(body.touches(&walls));
                }
            }
        }
        assert!(pressed > 200, "a run that touches nothing tests nothing: {pressed}");
    }
}
