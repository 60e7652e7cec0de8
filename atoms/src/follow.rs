//! `Follow`: drives straight at another robot, by local pursuit (paper, section IV-D).

use mdle_runtime::capability::{DiffDrive, Odometry, StateLink};
use mdle_runtime::{
    Begin, Completes, Control, Law, MetersPerSecond, Nanos, PeerState, Pose, Radians, RadiansPerSecond, Twist,
};

/// Distance to keep between the centres of the robots, in metres; with a larger distance, the path becomes shorter with
/// each trip.
const GAP: f64 = 0.90;
/// Maximum forward speed, in m/s.
const SPEED: f64 = 0.5;
/// Turn rate, in rad/s, per radian between the heading and the direction of the leader.
const TURNS: f64 = 3.0;
/// Maximum turn rate, in rad/s.
const FASTEST: f64 = 1.5;
/// Speed, in m/s, that is added to the leader's speed for each metre by which the gap is too large.
const CLOSES: f64 = 1.0;
/// Distance beyond [`GAP`], in metres, at which the follower has arrived.
const NEAR: f64 = 0.05;
/// Speed below which the leader is treated as at rest, in m/s.
const AT_REST: f64 = 0.02;

/// The control `Follow`: `u_f = v_leader + k_v (ρ − d)`, limited to `v`, and lower while the leader is not straight
/// ahead, and `u_θ = k(φ − θ)`, with the leader at the distance `ρ` in the direction `φ`. In the paper, `u_f` is the
/// constant `v`, with which the follower runs into a leader that stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Follow(&'static str);

impl Follow {
    /// Creates the quark `Follow robot`.
    #[must_use]
    pub const fn new(robot: &'static str) -> Self {
        Self(robot)
    }
}

/// The law of [`Follow`], which is done when the leader is at rest nearby. In addition, either the leader must have
/// moved since the law began, or the robot must have driven at least 0.9 m. The robot stands still while the leader's
/// state is stale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pursuing {
    robot: &'static str,
    /// `true` if the leader has moved since the law began.
    has_led: bool,
    /// Length of the robot's path since the law began, in metres.
    way: f64,
    /// Pose in the previous turn.
    last: Pose,
}

impl Pursuing {
    /// Returns the leader's state if it is fresh; `None` if it is stale or not known.
    fn leader<'y, Y: StateLink>(&self, y: &'y Y) -> Option<&'y PeerState> {
        y.peer(self.robot)?.fresh()
    }
}

impl<Y: DiffDrive + Odometry + StateLink> Control<Y> for Follow {
    type Law = Pursuing;

    fn begin(&self, y: &Y, _: Begin) -> Pursuing {
        Pursuing { robot: self.0, has_led: false, way: 0.0, last: y.pose() }
    }
}

impl<Y: DiffDrive + Odometry + StateLink> Law<Y> for Pursuing {
    type Input = Twist;

    fn input(&mut self, y: &Y, _: Nanos) -> Twist {
        let me = y.pose();
        self.way += self.last.distance(&me).0;
        self.last = me;
        let Some(leader) = self.leader(y) else { return Twist::default() };
        let (speed, gap) = (leader.velocity.v.0, me.distance(&leader.pose).0);
        self.has_led |= speed.abs() >= AT_REST;
        let towards = libm::atan2(leader.pose.y.0 - me.y.0, leader.pose.x.0 - me.x.0);
        let off = Radians(towards - me.theta.0).wrapped().0;
        let v = (speed + CLOSES * (gap - GAP)).clamp(0.0, SPEED) * libm::cos(off).max(0.0);
        let omega = (TURNS * off).clamp(-FASTEST, FASTEST);
        Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }
    }
}

impl<Y: DiffDrive + Odometry + StateLink> Completes<Y> for Pursuing {
    fn completed(&self, y: &Y, _: Nanos) -> bool {
        self.leader(y).is_some_and(|leader| {
            let is_near = y.pose().distance(&leader.pose).0 <= GAP + NEAR;
            let is_at_rest = leader.velocity.v.0.abs() < AT_REST;
            is_near && is_at_rest && (self.has_led || self.way >= GAP)
        })
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Meters, Peer};

    use super::*;
    use crate::trial::{PERIOD, Sensed, begun};

    /// Sets the state of the leader: its position, its speed, and the age of the state.
    fn see(y: &mut Sensed, (x, side): (f64, f64), v: f64, age: u64) {
        let pose = Pose { x: Meters(x), y: Meters(side), theta: Radians(0.0) };
        let velocity = Twist { v: MetersPerSecond(v), ..Twist::default() };
        let state = PeerState { pose, velocity, age: Nanos(age), rounds: 0, atom: 1 };
        y.link(Peer { name: "ada", rounds: 0, state: Some(state) });
    }

    /// Returns the input that the law returns in its first turn, for a leader at this position and speed whose state
    /// has this age.
    fn asked(place: (f64, f64), v: f64, age: u64) -> [f64; 2] {
        let mut y = Sensed::default();
        see(&mut y, place, v, age);
        let Twist { v, omega } = Follow::new("ada").begin(&y, begun()).input(&y, Nanos(0));
        [v.0, omega.0]
    }

    #[test]
    fn the_speed_is_the_leaders_and_closes_the_gap() {
        let near = |place, v, expected: [f64; 2]| {
            let asked = asked(place, v, 0);
            let is_near = asked.iter().zip(expected).all(|(asked, expected)| (asked - expected).abs() < 1e-12);
            assert!(is_near, "{place:?} at {v}: {asked:?} where {expected:?} is expected");
        };
        near((0.9, 0.0), 0.3, [0.3, 0.0]);
        near((1.0, 0.0), 0.3, [0.4, 0.0]);
        near((9.0, 0.0), 0.3, [0.5, 0.0]);
        near((0.5, 0.0), 0.3, [0.0, 0.0]);
        near((0.0, 1.0), 0.3, [0.0, 1.5]);
        near((-1.0, -0.0), 0.3, [0.0, -1.5]);
    }

    #[test]
    fn it_stands_while_the_state_is_old_or_unknown() {
        assert_eq!(asked((2.0, 1.0), 0.3, 500_000_000), [0.0, 0.0]);
        let y = Sensed::default();
        let mut law = Follow::new("ada").begin(&y, begun());
        assert_eq!(law.input(&y, Nanos(0)), Twist::default());
        assert!(!law.completed(&y, Nanos(0)));
    }

    #[test]
    fn it_ends_only_after_one_of_the_two_has_moved() {
        let mut y = Sensed::default();
        see(&mut y, (0.9, 0.0), 0.0, 0);
        let mut law = Follow::new("ada").begin(&y, begun());
        for _ in 0..9 {
            law.input(&y, Nanos(0));
            assert!(!law.completed(&y, Nanos(0)), "neither has moved");
        }
        see(&mut y, (0.9, 0.0), 0.3, 0);
        law.input(&y, Nanos(0));
        assert!(!law.completed(&y, Nanos(0)), "the leader moves");
        see(&mut y, (0.9, 0.0), 0.0, 0);
        assert!(law.completed(&y, Nanos(0)));
        see(&mut y, (0.96, 0.0), 0.0, 0);
        assert!(!law.completed(&y, Nanos(0)), "it is too far");
    }

    #[test]
    fn it_arrives_behind_a_leader_that_has_gone_before() {
        let mut y = Sensed::default();
        see(&mut y, (3.0, 1.0), 0.0, 0);
        let mut law = Follow::new("ada").begin(&y, begun());
        let mut turns = 0;
        while !law.completed(&y, Nanos(0)) {
            let input = law.input(&y, Nanos(0));
            y.drive(input);
            turns += 1;
            assert!(turns < 200, "{:?}", y.pose);
        }
        let left = libm::hypot(3.0 - y.pose.x.0, 1.0 - y.pose.y.0);
        assert!((0.9..=0.95).contains(&left) && f64::from(turns) * PERIOD < 12.0, "{left} m after {turns} turns");
    }
}
