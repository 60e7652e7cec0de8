//! Detects a person who is about to cross the robot's way, because the echoes of a sonar that faces to the side
//! get nearer faster than the robot drives.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, PINGS_KEPT, Ping, Pose, Radians, SONARS, SonarId};

/// Minimum and maximum speed, in m/s, of a person who crosses the way. A slower object counts as fixed, and echoes that
/// move faster belong to different objects.
const SPEEDS: [f64; 2] = [0.25, 2.0];
/// Maximum turn rate of the robot, in rad/s, between compared echoes: as the robot turns, the echo of a wall
/// moves along the wall.
const TURNS: f64 = 0.02;
/// Minimum decrease, in metres, of the distance of a crossing person between echoes. A smaller decrease may be an error
/// of the ranges.
const NEARER: f64 = 0.075;
/// The radius of a person, in metres.
const PERSON: f64 = 0.25;
/// Minimum distance, in metres, of a crossing person from the way. A person nearer to the way is an obstacle, or walks
/// along the way.
const ASIDE: f64 = 0.45;
/// Maximum time, in seconds, in which a person reaches the way.
const SOON: f64 = 5.0;

/// An echo: its time in seconds, and its distance along the way and to the left of it, in metres.
struct Echo {
    at: f64,
    along: f64,
    across: f64,
}

/// Returns the time, in seconds, until a person who comes from a side has crossed the way; `None` if no such person
/// comes. The person would pass ahead of the robot if it stood still, but may meet it if it drove on at `speed`, in
/// m/s.
pub(crate) fn crosses<Y: DiffDrive + SonarRing>(y: &Y, here: Pose, speed: f64) -> Option<f64> {
    let ahead = libm::sincos(here.theta.0);
    (0..SONARS as u8).map(SonarId::new).filter_map(|sonar| comes(y, sonar, (here, ahead), speed)).reduce(f64::max)
}

/// Returns the time, in seconds, until a person heard in all kept pings of `sonar` has crossed the way; `None` if there
/// is no such person. The conditions are those of [`crosses`]. `sin` and `cos` belong to the heading of `here`.
fn comes<Y: DiffDrive + SonarRing>(
    y: &Y,
    sonar: SonarId,
    (here, (sin, cos)): (Pose, (f64, f64)),
    speed: f64,
) -> Option<f64> {
    const { assert!(PINGS_KEPT == 3) };
    if sonar.bearing().wrapped().0.abs() > core::f64::consts::FRAC_PI_2 {
        return None;
    }
    let mut pings = y.pings(sonar).newest_first().map(|ping| Some((ping, ping.range?)));
    let [new, middle, old] = [pings.next()??, pings.next()??, pings.next()??];
    let is_straight = |(from, _): (&Ping, Meters), (to, _): (&Ping, Meters)| {
        let turned = Radians(to.pose.theta.0 - from.pose.theta.0).wrapped().0.abs();
        turned <= TURNS * (to.at.seconds() - from.at.seconds())
    };
    if !(is_straight(old, middle) && is_straight(middle, new)) {
        return None;
    }
    let echo = |(ping, range): (&Ping, Meters)| {
        let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
        let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
        let (x, y) = (place.x.0 - here.x.0, place.y.0 - here.y.0);
        Echo { at: ping.at.seconds(), along: x * cos + y * sin, across: y * cos - x * sin }
    };
    let approach = |from: &Echo, to: &Echo| {
        (libm::hypot(from.along, from.across) - libm::hypot(to.along, to.across)) / (to.at - from.at)
    };
    let moves = |speed: f64| (SPEEDS[0]..=SPEEDS[1]).contains(&speed);
    // Most echoes come from an obstacle in the way or from a fixed object. Their older places are not computed.
    let new = echo(new);
    if !(new.along > y.body_radius().0 + PERSON && new.across.abs() > ASIDE) {
        return None;
    }
    let middle = echo(middle);
    let second = approach(&middle, &new);
    if !moves(second) {
        return None;
    }
    let old = echo(old);
    let first = approach(&old, &middle);
    let mean = (first + second) / 2.0;
    let seconds = new.across.abs() / mean;
    let meets = new.along < y.body_radius().0 + 2.0 * PERSON + speed * seconds && seconds < SOON;
    let is_nearer = mean * (new.at - old.at) >= NEARER;
    let passed = seconds + (y.body_radius().0 + PERSON) / mean;
    (moves(first) && is_nearer && meets).then_some(passed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Nanos;

    /// Returns the time, in seconds, for which a robot at rest waits for a person whom its sonar 3 hears at these
    /// ranges, one second apart; `None` if it does not wait.
    fn seconds(ranges: [f64; 3]) -> Option<f64> {
        let mut y = Sensed::default();
        for (second, range) in (0..).zip(ranges) {
            y.ping_at(SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
        }
        crosses(&y, y.pose, 0.2)
    }

    /// Returns `true` if the robot waits for the person.
    fn waits(ranges: [f64; 3]) -> bool {
        seconds(ranges).is_some()
    }

    #[test]
    fn somebody_who_comes_from_the_side_is_waited_for() {
        assert!(waits([2.8, 2.3, 1.8]));
        assert!(!waits([1.8, 1.8, 1.8]), "a wall");
        assert!(!waits([1.8, 2.3, 2.8]), "somebody who leaves");
        assert!(!waits([2.8, 2.8, 1.8]), "two different things");
        assert!(!waits([6.0, 5.5, 5.0]), "somebody far away");
    }

    #[test]
    fn the_robot_waits_until_he_has_passed() {
        // The person is 1.84 m beside the way, and leaves it half a metre further on.
        let passed = seconds([2.8, 2.3, 1.8]).expect("somebody");
        assert!((4.5..4.8).contains(&passed), "{passed}");
    }

    #[test]
    fn a_person_who_comes_abreast_is_not_waited_for() {
        // 1 m away at 67.5°, the person is 46 cm ahead and would walk into a robot that stands.
        assert!(!waits([1.8, 1.4, 0.9]));
    }
}
