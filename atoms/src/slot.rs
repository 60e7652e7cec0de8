//! `slot`: keeps the robot at a position beside a robot that leads a formation (paper, sections II-C and III-G: group
//! atoms).

use mdle_runtime::capability::{DiffDrive, Odometry, StateLink};
use mdle_runtime::{
    Begin, Control, Law, Meters, MetersPerSecond, Nanos, PeerState, Pose, Radians, RadiansPerSecond, Twist,
};

/// Speed of the correction, in m/s for each metre of distance from the slot.
const CORRECTS: f64 = 1.0;
/// Distance, in metres, from the robot's centre to the steered point ahead of it. A point on the axle could not be
/// moved sideways.
const AHEAD: f64 = 0.1;
/// Time constant, in seconds, with which the direction of the formation follows the leader's heading. Without this
/// delay, the slots far from the leader would move too fast.
const TURNS_IN: f64 = 1.5;
/// Age from which the leader's state is stale.
const SILENT: Nanos = Nanos(1_000_000_000);
/// Speed, in m/s, below which a slot is treated as having no direction of motion.
const AT_REST: f64 = 0.02;
/// Distance from a slot at rest, in metres, within which the robot stands still.
const NEAR: f64 = 0.03;
/// Maximum forward speed, in m/s, and maximum turn rate, in rad/s.
const FASTEST: (f64, f64) = (0.5, 1.5);

/// The control `slot`: keeps the robot at its slot, a position relative to the leader of the formation. It steers the
/// point `q + l e` ahead of the robot to the point `g + l f/|f|` ahead of the slot.
///
/// `u = f + k (g + l f/|f| - q - l e)` is the velocity that the steered point should have; `v = u·e` and `ω = u·n/l`
/// are the forward speed and the turn rate, before both are limited to `FASTEST`. Here, `q` is the position of the
/// robot, `e` the unit vector of its heading, `n` the unit vector to its left, `g` and `f` the position and the
/// velocity of the slot, `k` the gain `CORRECTS`, and `l` the distance `AHEAD`. If the slot is at rest, `e` replaces
/// `f/|f|`, and a robot near the slot stands still.
///
/// `g` and `f` are computed with the direction of the formation. This direction is the leader's heading after a
/// low-pass filter with the time constant `TURNS_IN`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slot {
    leader: &'static str,
    ahead: Meters,
    left: Meters,
}

impl Slot {
    /// Creates the quark `slot leader ahead left`.
    #[must_use]
    pub const fn new(leader: &'static str, ahead: Meters, left: Meters) -> Self {
        Self { leader, ahead, left }
    }
}

/// The law of [`Slot`]. The robot stands still while the leader's state is at least one second old.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keeping {
    slot: Slot,
    /// Direction of the formation, in radians, and the time of the turn for which it was computed; `None` before the
    /// leader's state is known.
    direction: Option<(f64, Nanos)>,
}

/// A moving slot: its position and velocity.
struct Moving {
    place: (f64, f64),
    velocity: (f64, f64),
}

impl<Y: DiffDrive + Odometry + StateLink> Control<Y> for Slot {
    type Law = Keeping;

    fn begin(&self, _: &Y, _: Begin) -> Keeping {
        Keeping { slot: *self, direction: None }
    }
}

impl Keeping {
    /// Returns the position and velocity of the slot at time `t`, extrapolated from the leader's state, which belongs
    /// to an earlier turn.
    fn place(&mut self, leader: &PeerState, t: Nanos) -> Moving {
        let since = self.direction.map_or(0.0, |(_, before)| t.since(before).seconds());
        // The age counts from the turn in which the state arrived, one turn after it was sent.
        let age = leader.age.seconds() + since;
        let Twist { v, omega } = leader.velocity;
        let at = leader.pose.moved(Meters(v.0 * age), Radians(omega.0 * age));
        let before = self.direction.map_or(at.theta.0, |(direction, _)| direction);
        let off = Radians(at.theta.0 - before).wrapped().0;
        let direction = before + off * (1.0 - libm::exp(-since / TURNS_IN));
        self.direction = Some((direction, t));
        let rate = Radians(at.theta.0 - direction).wrapped().0 / TURNS_IN;
        let (sin, cos) = libm::sincos(direction);
        let (ahead, left) = (self.slot.ahead.0, self.slot.left.0);
        let (dx, dy) = (ahead * cos - left * sin, ahead * sin + left * cos);
        let (sin, cos) = libm::sincos(at.theta.0);
        Moving { place: (at.x.0 + dx, at.y.0 + dy), velocity: (v.0 * cos - rate * dy, v.0 * sin + rate * dx) }
    }
}

/// Returns the input that brings the robot at `me` to a moving slot.
fn towards(me: Pose, Moving { place, velocity: (fx, fy) }: Moving) -> Twist {
    let (sin, cos) = libm::sincos(me.theta.0);
    let speed = libm::hypot(fx, fy);
    let (dx, dy) = (place.0 - me.x.0, place.1 - me.y.0);
    if speed < AT_REST && libm::hypot(dx, dy) < NEAR {
        return Twist::default();
    }
    let (ex, ey) = if speed < AT_REST { (cos, sin) } else { (fx / speed, fy / speed) };
    let ux = fx + CORRECTS * (dx + AHEAD * (ex - cos));
    let uy = fy + CORRECTS * (dy + AHEAD * (ey - sin));
    let v = (ux * cos + uy * sin).clamp(-FASTEST.0, FASTEST.0);
    let omega = ((uy * cos - ux * sin) / AHEAD).clamp(-FASTEST.1, FASTEST.1);
    Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
}

impl<Y: DiffDrive + Odometry + StateLink> Law<Y> for Keeping {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let state = y.peer(self.slot.leader).and_then(|peer| peer.state);
        let Some(leader) = state.filter(|state| state.age < SILENT) else { return Twist::default() };
        let place = self.place(&leader, t);
        towards(y.pose(), place)
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Links, Peer};

    use super::*;
    use crate::trial::{PERIOD, Sensed, begun};

    const TURN: u64 = 100_000_000;

    /// Sets the state of the leader, which is the only other robot: its pose with the heading in degrees, its speed and
    /// turn rate, and the age of the state.
    fn see(y: &mut Sensed, (x, side, degrees): (f64, f64, f64), (v, omega): (f64, f64), age: u64) {
        let pose = Pose { x: Meters(x), y: Meters(side), theta: Radians::from_degrees(degrees) };
        let velocity = Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) };
        let state = PeerState { pose, velocity, age: Nanos(age), rounds: 0, atom: 1 };
        y.published = y.published.with_links(Links::NONE);
        y.link(Peer { name: "ada", rounds: 0, state: Some(state) });
    }

    fn slot(ahead: f64, left: f64) -> Slot {
        Slot::new("ada", Meters(ahead), Meters(left))
    }

    #[test]
    fn a_robot_in_its_place_goes_as_fast_as_its_leader() {
        let mut y = Sensed::default();
        see(&mut y, (1.0, 0.5, 0.0), (0.2, 0.0), 0);
        let Twist { v, omega } = slot(-1.0, -0.5).begin(&y, begun()).input(&y, Nanos(0));
        assert!((v.0 - 0.2).abs() < 1e-12 && omega.0.abs() < 1e-12, "{v:?} {omega:?}");
    }

    #[test]
    fn an_old_state_is_carried_on_until_a_second_is_over() {
        let asked = |age| {
            let mut y = Sensed::default();
            see(&mut y, (1.0, 0.0, 0.0), (0.2, 0.0), age);
            slot(-1.0, 0.0).begin(&y, begun()).input(&y, Nanos(0)).v.0
        };
        assert!((asked(500_000_000) - 0.3).abs() < 1e-12, "the leader has gone on by 10 cm");
        assert!(asked(999_999_999) > 0.3);
        assert_eq!(asked(1_000_000_000), 0.0);
        let y = Sensed::default();
        assert_eq!(slot(-1.0, 0.0).begin(&y, begun()).input(&y, Nanos(0)), Twist::default());
    }

    #[test]
    fn a_robot_near_a_place_at_rest_stands() {
        let asked = |off| {
            let mut y = Sensed::default();
            see(&mut y, (1.0 + off, 0.0, 0.0), (0.0, 0.0), 0);
            slot(-1.0, 0.0).begin(&y, begun()).input(&y, Nanos(0)).v.0
        };
        assert_eq!(asked(0.02), 0.0);
        assert!((asked(0.05) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn the_place_is_kept_on_a_bend_and_reached_from_beside_it() {
        let mut y = Sensed::default();
        y.pose.y = Meters(0.3);
        let mut law = slot(-0.866, 0.5).begin(&y, begun());
        let (mut leader, (v, omega)) = (Pose { x: Meters(0.866), y: Meters(-0.3), ..Pose::ORIGIN }, (0.2, 0.1));
        let mut off = f64::INFINITY;
        for turn in 0..300 {
            see(&mut y, (leader.x.0, leader.y.0, leader.theta.0.to_degrees()), (v, omega), 0);
            let input = law.input(&y, Nanos(turn * TURN));
            y.drive(input);
            leader = leader.moved(Meters(v * PERIOD), Radians(omega * PERIOD));
            // The formation turns 1.5 s after its leader.
            let (sin, cos) = libm::sincos(leader.theta.0 - omega * TURNS_IN);
            let place = Pose {
                x: Meters(leader.x.0 - 0.866 * cos - 0.5 * sin),
                y: Meters(leader.y.0 - 0.866 * sin + 0.5 * cos),
                ..Pose::ORIGIN
            };
            off = y.pose.distance(&place).0;
        }
        assert!(off < 0.03, "{off}");
    }
}
