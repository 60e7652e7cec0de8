//! Detects a person who approaches the robot: the echoes ahead come nearer faster than the robot drives.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

/// Maximum angle between a sonar's axis and the driving direction at which the sonar is used to detect people.
const AHEAD: Radians = Radians::from_degrees(14.0);
/// Minimum time between two compared echoes. In a shorter time, the range of an approaching person decreases by less
/// than the error of the ranges.
const APART: Nanos = Nanos(200_000_000);
/// Minimum speed of an approaching person, in m/s; the robot avoids a slower object in the same way as a fixed
/// obstacle.
const SLOWEST: f64 = 0.3;
/// Maximum speed of a person, in m/s; echoes that come nearer faster belong to two different objects.
const FASTEST: f64 = 2.0;
/// Minimum decrease, in metres, of the range of an approaching object. A smaller decrease may be the error of the
/// ranges of a fixed obstacle, which is 1.5 cm plus rounding to an inch.
const NEARER: f64 = 0.1;

/// Number of echoes that are kept.
const KEPT: usize = 5;
/// Minimum number of consecutive echoes, each nearer than the one before.
const AGREE: usize = 3;
/// Minimum time, on a robot whose sonars fire in turn, for which the echoes must come nearer. The wide cones of the
/// sonars alternately reach different rough walls beside the way, and three such ranges may decrease by chance.
const LASTS: Nanos = Nanos(1_400_000_000);
/// Maximum lateral distance, in metres, between two echoes of the same object.
const ACROSS: f64 = 0.25;

/// Maximum turn rate of the robot, in rad/s, between compared echoes. While the robot turns faster, the edge of a cone
/// may reach a wall and leave it again.
const TURNS: f64 = 0.02;

/// An echo: its position in odometry coordinates, and its time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Echo {
    at: Nanos,
    /// Position of the echo; the heading is the direction of the sonar's axis.
    place: Pose,
}

/// An echo relative to the robot: its distance along the way and across it, in metres.
#[derive(Debug, Clone, Copy)]
struct Relative {
    at: Nanos,
    axis: Radians,
    along: f64,
    across: f64,
}

/// The last echoes ahead, newest first. Between them there was no ping without an echo.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Approach {
    heard: [Echo; KEPT],
    /// Number of stored echoes.
    count: u8,
}

impl Approach {
    /// Stores the echo of the newest ping of the sonar that faces in the direction `way`; clears the stored echoes if
    /// there is no echo ahead.
    pub(crate) fn take<Y: SonarRing>(&mut self, y: &Y, here: Pose, way: Radians) {
        let Some(sonar) = looking(here, way) else { return };
        let Some(ping) = y.pings(sonar).newest_first().next() else { return };
        if self.stored().next().is_some_and(|newest| ping.at.since(newest.at) < APART) {
            return;
        }
        let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
        let looked = Radians(axis.0 - way.0).wrapped().0.abs() <= AHEAD.0;
        let Some(range) = ping.range.filter(|_| looked) else {
            self.count = 0;
            return;
        };
        let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
        self.heard.rotate_right(1);
        self.heard[0] = Echo { at: ping.at, place };
        self.count = (self.count + 1).min(KEPT as u8);
    }

    /// Returns the stored echoes, newest first.
    fn stored(&self) -> impl Iterator<Item = &Echo> {
        self.heard.iter().take(self.count.into())
    }

    /// Returns the time, in seconds, from the newest echo until an approaching person reaches the robot; `None` if no
    /// person approaches.
    ///
    /// Fixed obstacles are not reported, because their echoes stay at the same position.
    pub(crate) fn seconds(&self, here: Pose, way: Radians, in_turn: bool) -> Option<f64> {
        let (sin, cos) = libm::sincos(way.0);
        let mut heard = self.stored().map(|Echo { at, place }| {
            let (x, y) = (place.x.0 - here.x.0, place.y.0 - here.y.0);
            Relative { at: *at, axis: place.theta, along: x * cos + y * sin, across: y * cos - x * sin }
        });
        let newest = heard.next()?;
        let (mut oldest, mut agree) = (newest, 1);
        for before in heard {
            let seconds = oldest.at.since(before.at).seconds();
            let comes = (SLOWEST..=FASTEST).contains(&((before.along - oldest.along) / seconds));
            let turned = Radians(oldest.axis.0 - before.axis.0).wrapped().0.abs();
            if !comes || turned > TURNS * seconds || (before.across - oldest.across).abs() > ACROSS {
                break;
            }
            (oldest, agree) = (before, agree + 1);
        }
        let (nearer, lasted) = (oldest.along - newest.along, newest.at.since(oldest.at));
        let is_sure = agree >= AGREE && nearer >= NEARER && (!in_turn || lasted >= LASTS);
        (is_sure && newest.along > 0.0).then(|| newest.along * lasted.seconds() / nearer)
    }
}

/// Returns the sonar whose axis is nearest to the direction `way` in odometry coordinates.
fn looking(here: Pose, way: Radians) -> Option<SonarId> {
    let off = |sonar: SonarId| Radians(here.theta.0 + sonar.bearing().0 - way.0).wrapped().0.abs();
    let sonars = (0..SONARS as u8).map(SonarId::new).map(|sonar| (sonar, off(sonar)));
    sonars.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(sonar, _)| sonar)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Twist;

    /// Returns the time, in seconds, until an approaching person reaches a robot that drives at `v` m/s and turns at
    /// `omega` rad/s, and that receives echoes of the person at these ranges, one second apart; `None` if the robot
    /// detects no approaching person.
    fn seconds(ranges: &[Option<f64>], v: f64, omega: f64) -> Option<f64> {
        let (mut y, mut approach) = (Sensed::default(), Approach::default());
        for (second, range) in (0..).zip(ranges) {
            y.ping_at(SonarId::new(0), *range, Nanos(second * 1_000_000_000));
            approach.take(&y, y.pose, Radians(0.0));
            for _ in 0..10 {
                let input = Twist { v: mdle_runtime::MetersPerSecond(v), omega: mdle_runtime::RadiansPerSecond(omega) };
                y.drive(input);
            }
        }
        approach.seconds(y.pose, Radians(0.0), false)
    }

    #[test]
    fn a_person_faster_than_the_robot_differs_from_a_wall() {
        let comes = [Some(5.0), Some(3.8), Some(2.6)];
        // The distance was 2.6 m plus the ring's radius, and the robot has driven 0.2 m since.
        let arrives = seconds(&comes, 0.2, 0.0).expect("somebody");
        assert!((arrives - 2.59).abs() < 1e-9, "{arrives}");
        assert_eq!(seconds(&[Some(5.0), Some(4.8), Some(4.6)], 0.2, 0.0), None, "a wall");
        assert_eq!(seconds(&[Some(5.0), Some(4.6), Some(4.2)], 0.2, 0.0), None, "too slow");
        assert_eq!(seconds(&[Some(5.0), Some(2.6), Some(0.2)], 0.2, 0.0), None, "too fast");
    }

    #[test]
    fn three_echoes_in_a_row_must_come_nearer() {
        assert!(seconds(&[Some(3.0), Some(5.0), Some(3.8), Some(2.6)], 0.2, 0.0).is_some());
        assert_eq!(seconds(&[None, Some(3.8), Some(2.6)], 0.2, 0.0), None);
        assert_eq!(seconds(&[Some(3.8), None, Some(2.6)], 0.2, 0.0), None);
        assert_eq!(seconds(&[Some(4.0), Some(3.8), Some(2.6)], 0.2, 0.0), None);
    }

    /// Returns `true` if a robot at rest, whose sonars fire in turn, detects a person who approaches at 1 m/s. The
    /// person causes `echoes` echoes, 0.36 s apart.
    fn avoids(echoes: u64) -> bool {
        let (mut y, mut approach) = (Sensed::default(), Approach::default());
        for echo in 0..echoes {
            y.ping_at(SonarId::new(0), Some(4.0 - 0.36 * echo as f64), Nanos(echo * 360_000_000));
            approach.take(&y, y.pose, Radians(0.0));
        }
        approach.seconds(y.pose, Radians(0.0), true).is_some()
    }

    #[test]
    fn where_sonars_fire_in_turn_echoes_come_nearer_longer() {
        assert!(avoids(5) && !avoids(4));
    }

    #[test]
    fn nobody_is_heard_by_a_robot_that_turns() {
        assert!(seconds(&[Some(5.0), Some(3.8), Some(2.6)], 0.0, 0.01).is_some());
        assert_eq!(seconds(&[Some(5.0), Some(3.8), Some(2.6)], 0.0, 0.03), None);
    }
}
