//! `lead`: drives as `goAvoid` does, for a robot that leads a formation, in which other robots keep positions beside it
//! (paper, sections II-C and III-G: group atoms).

use mdle_runtime::capability::{DiffDrive, Odometry, SonarRing, StateLink, Steering};
use mdle_runtime::{
    Begin, Completes, Control, Law, Meters, MetersPerSecond, Nanos, Output, PINGS_KEPT, Ping, Pings, Pose, Radians,
    RadiansPerSecond, SONARS, SonarId, Twist,
};

use crate::go_avoid::{GoAvoid, GoingRound};

/// Additional room beside the outermost robot of the group, in metres. It is needed because the robots drift apart on
/// the way.
const DRIFTS: f64 = 0.1;
/// Maximum error, in metres, of another robot's position by its own odometry. A leader that took the echo of a robot in
/// its group for an obstacle would turn away endlessly, because that robot stays beside the leader.
const MISPLACED: f64 = 0.25;
/// Half of the angle of the cone from which a sonar receives echoes.
const CONE: Radians = Radians::from_degrees(15.0);
/// Maximum turn rate, in rad/s, limited because the outermost robots drive on a larger circle.
const FASTEST: f64 = 0.3;

/// The control `lead`: `goAvoid` for a body that is wider on both sides by the width of the group. It ignores echoes of
/// the other robots that the plan names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lead {
    width: Meters,
    goal: GoAvoid,
}

impl Lead {
    /// Creates the quark `lead width bearing range speed`.
    #[must_use]
    pub const fn new(width: Meters, bearing: Radians, range: Meters, speed: MetersPerSecond) -> Self {
        Self { width, goal: GoAvoid::new(bearing, range, speed) }
    }
}

/// The law of [`Lead`], which is done when the law of `goAvoid` is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leading {
    width: Meters,
    /// The pings, without those that were echoes of other robots when they arrived.
    heard: [Pings; SONARS],
    /// Time of the previous turn.
    before: Nanos,
    law: GoingRound,
}

/// The output of a group, presented as the output of one wide robot.
struct Group<'g, Y> {
    y: &'g Y,
    width: Meters,
    heard: &'g [Pings; SONARS],
}

impl<Y: Output> Output for Group<'_, Y> {
    fn here(&self) -> Pose {
        self.y.here()
    }
}

impl<Y: Odometry> Odometry for Group<'_, Y> {
    fn pose(&self) -> Pose {
        self.y.pose()
    }

    fn velocity(&self) -> Twist {
        self.y.velocity()
    }

    fn drift(&self, axis: Radians) -> Radians {
        self.y.drift(axis)
    }
}

impl<Y: DiffDrive> DiffDrive for Group<'_, Y> {
    fn body_radius(&self) -> Meters {
        Meters(self.y.body_radius().0 + self.width.0 + DRIFTS)
    }

    fn wheel_base(&self) -> Meters {
        self.y.wheel_base()
    }

    fn steering(&self) -> Steering {
        self.y.steering()
    }
}

impl<Y: SonarRing> SonarRing for Group<'_, Y> {
    fn pings(&self, sonar: SonarId) -> &Pings {
        // A sonar's number is below `SONARS`, so there is always a place for it.
        self.heard.get(sonar.number()).unwrap_or_else(|| self.y.pings(sonar))
    }

    fn now(&self) -> Nanos {
        self.y.now()
    }

    fn ring_radius(&self) -> Meters {
        self.y.ring_radius()
    }

    fn confirmation(&self) -> usize {
        self.y.confirmation()
    }

    fn blocked_within(&self) -> Meters {
        self.y.blocked_within()
    }
}

/// Returns `true` if the ping may be an echo of another robot that has a body with this radius and reports its position
/// as `place`.
fn is_of(ping: &Ping, sonar: SonarId, ring: Meters, radius: Meters, place: &Pose) -> bool {
    let Some(range) = ping.range else { return false };
    let axis = ping.axis(sonar);
    let transducer = axis.towards(axis.theta, ring);
    let towards = libm::atan2(place.y.0 - transducer.y.0, place.x.0 - transducer.x.0);
    let off = Radians(towards - axis.theta.0).wrapped().0.clamp(-CONE.0, CONE.0);
    transducer.towards(Radians(axis.theta.0 + off), range).distance(place).0 < radius.0 + MISPLACED
}

/// Adds to `heard` the pings after the time `since`, or all pings if it is `None`, except echoes of other robots. All
/// robots are assumed to have bodies of the same size.
fn take<Y: DiffDrive + SonarRing + StateLink>(heard: &mut [Pings; SONARS], y: &Y, since: Option<Nanos>) {
    let (ring, radius) = (y.ring_radius(), y.body_radius());
    for (sonar, heard) in (0..SONARS as u8).map(SonarId::new).zip(heard) {
        let mut new = [None; PINGS_KEPT];
        let are_new = y.pings(sonar).newest_first().filter(|ping| since.is_none_or(|since| ping.at > since));
        new.iter_mut().zip(are_new).for_each(|(place, ping)| *place = Some(ping));
        for ping in new.into_iter().rev().flatten() {
            let mut states = y.links().peers().filter_map(|peer| peer.state.as_ref());
            if !states.any(|state| is_of(ping, sonar, ring, radius, &state.pose)) {
                heard.push(*ping);
            }
        }
    }
}

impl<Y: DiffDrive + Odometry + SonarRing + StateLink> Control<Y> for Lead {
    type Law = Leading;

    // Not inlined, so that the large law is constructed only once, in its final place.
    #[inline(never)]
    fn begin(&self, y: &Y, begin: Begin) -> Leading {
        let mut heard = [Pings::default(); SONARS];
        take(&mut heard, y, None);
        let law = self.goal.begin(&Group { y, width: self.width, heard: &heard }, begin);
        Leading { width: self.width, heard, before: y.now(), law }
    }
}

impl<Y: DiffDrive + Odometry + SonarRing + StateLink> Law<Y> for Leading {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let Self { width, heard, before, law } = self;
        take(heard, y, Some(*before));
        *before = y.now();
        let Twist { v, omega } = law.input(&Group { y, width: *width, heard }, t);
        Twist { v, omega: RadiansPerSecond(omega.0.clamp(-FASTEST, FASTEST)) }
    }

    fn stalled(&self, y: &Y, t: Nanos) -> Option<Nanos> {
        self.law.stalled(&Group { y, width: self.width, heard: &self.heard }, t)
    }
}

impl<Y: DiffDrive + Odometry + SonarRing + StateLink> Completes<Y> for Leading {
    fn completed(&self, y: &Y, t: Nanos) -> bool {
        self.law.completed(&Group { y, width: self.width, heard: &self.heard }, t)
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Peer, PeerState};

    use super::*;
    use crate::trial::{Sensed, begun};

    fn quark(width: f64) -> Lead {
        Lead::new(Meters(width), Radians(0.0), Meters(5.0), MetersPerSecond(0.2))
    }

    /// Returns the output of a robot at the origin whose front sonar measures this range, and which has the state of
    /// another robot at this position.
    fn beside(range: f64, (x, side): (f64, f64)) -> Sensed {
        let mut y = Sensed::default();
        (0..3).for_each(|_| y.ping(SonarId::new(0), Some(range)));
        let pose = Pose { x: Meters(x), y: Meters(side), ..Pose::ORIGIN };
        let state = PeerState { pose, velocity: Twist::default(), age: Nanos(0), rounds: 0, atom: 1 };
        y.link(Peer { name: "bob", rounds: 0, state: Some(state) });
        y
    }

    fn input(width: f64, y: &Sensed) -> [f64; 2] {
        let Twist { v, omega } = quark(width).begin(y, begun()).input(y, Nanos(0));
        [v.0, omega.0]
    }

    #[test]
    fn echoes_of_other_robots_are_not_heard() {
        // The transducer is 0.19 m ahead of the centre, and the edge of the other robot's body 0.2 m before its centre.
        assert_eq!(input(0.5, &beside(0.4, (0.79, 0.0))), [0.2, 0.0], "the echo is the other robot's");
        let [v, omega] = input(0.5, &beside(0.4, (9.0, 0.0)));
        assert!(v < 0.2 && omega.abs() == FASTEST, "something is there: {v} {omega}");
    }

    #[test]
    fn a_robot_is_not_heard_where_odometry_has_misplaced_it() {
        let radius = Sensed::default().body_radius().0;
        // The echo is 0.6 m ahead of the centre: from the near side of a robot that reports itself further away.
        let turn = |misplaced: f64| input(0.5, &beside(0.4, (0.59 + radius + misplaced, 0.0)))[1];
        assert_eq!(turn(0.2), 0.0, "the echo is of the other robot, whose odometry has drifted");
        assert!(turn(0.3) != 0.0, "an echo so far from the other robot is not of it");
    }

    #[test]
    fn an_echo_is_judged_when_it_is_new() {
        let mut y = beside(0.4, (0.79, 0.0));
        let mut law = quark(0.5).begin(&y, begun());
        let away = beside(0.4, (9.0, 0.0));
        y.published = away.published;
        assert_eq!(law.input(&y, Nanos(0)).omega.0, 0.0, "the other robot has gone on, and its echo is old");
    }

    #[test]
    fn there_is_room_for_the_robots_beside() {
        let beside_a_wall = |width| {
            let mut y = Sensed::default();
            (0..3).for_each(|_| y.ping(SonarId::new(2), Some(1.0)));
            input(width, &y)[1]
        };
        assert!(beside_a_wall(0.0) == 0.0 && beside_a_wall(0.6) < 0.0);
    }
}
