//! Detects a person who is about to cross the robot's way: the echoes of a sonar that faces to the side come nearer
//! faster than the robot drives.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Ping, Pose, Radians, SonarId};

use crate::missed::{BeforeMissed, forward_sonars};

/// Minimum and maximum speed, in m/s, of a person who crosses the way. A slower object is treated as fixed, and faster
/// echoes belong to different objects.
const SPEEDS: [f64; 2] = [0.25, 2.0];
/// Maximum ratio of the two speeds of one person. If one is greater, the echoes belong to different objects.
const STEADY: f64 = 4.0;
/// Maximum turn rate of the robot, in rad/s, between compared echoes: as the robot turns, the echo of a wall
/// moves along the wall.
const TURNS: f64 = 0.02;
/// Maximum angle, in radians, by which the robot may turn between compared echoes, at any rate. A turn by this angle
/// hardly moves an echo, and skidding wheels turn the robot to and fro by this much.
const TURNED: f64 = 0.01;
/// Maximum turn rate of the robot, in rad/s, between echoes that are compared more strictly: a robot that gets back to
/// its way after a random range turns by some degrees between its pings.
const TURNS_MOST: f64 = 0.2;
/// Minimum speed, in m/s, of a person between such echoes, and maximum ratio of the two speeds.
const IN_TURNS: (f64, f64) = (0.35, 1.5);
/// Minimum decrease, in metres, of the distance of a crossing person from the first compared echo to the last. A
/// smaller decrease may be an error of the ranges.
const NEARER: f64 = 0.075;
/// The radius of a person, in metres.
const PERSON: f64 = 0.25;
/// Distance, in metres, that the robot leaves between a person and its body, because the direction of an echo within
/// the cone of its sonar is not known.
const CLEAR: f64 = 0.2;
/// Minimum distance, in metres, between a person and the robot's way: from a nearer person, the robot does not back
/// off. Echoes of the rough walls of a hallway, whose ranges may decrease by chance, are nearer.
const FAR: f64 = 1.2;
/// Maximum time, in seconds, before a person reaches the robot's way: if the person needs longer, the robot does not
/// back off.
const BACK: f64 = 5.0;
/// Minimum distance, in metres, between a crossing person and the way. A person nearer to the way is an obstacle, or
/// walks along the way.
const ASIDE: f64 = 0.45;
/// Maximum time, in seconds, before a person reaches the robot's way: if the person needs longer, the robot does not
/// react. A sonar that pings once a second takes two seconds until three pings agree, and the direction of its echoes
/// is uncertain by several degrees. A robot that stops later may already be where the person walks.
const SOON: f64 = 8.0;

/// An echo: its time in seconds, and its distance along the way and to the left of it, in metres.
struct Echo {
    at: f64,
    along: f64,
    across: f64,
}

/// A person who is about to cross the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing {
    /// Time, in seconds, until the person has crossed the way.
    pub(crate) passed: f64,
    /// Distance, in metres, by which the robot has to back off so that the person passes ahead of it; 0 if the person
    /// passes ahead of it anyway.
    pub(crate) back: f64,
}

/// Returns the person who comes from a side and may meet the robot if it drives on at `speed`, in m/s; `None` if no
/// such person comes. If there are several such persons, the result has the longest of their times and the longest of
/// their distances.
pub(crate) fn crosses<Y: DiffDrive + SonarRing>(
    y: &Y,
    before: &BeforeMissed,
    here: Pose,
    speed: f64,
) -> Option<Crossing> {
    let ahead = libm::sincos(here.theta.0);
    let all = forward_sonars().filter_map(|sonar| comes(y, sonar, before.newest(y, sonar)?, (here, ahead), speed));
    all.reduce(|one, other| Crossing { passed: one.passed.max(other.passed), back: one.back.max(other.back) })
}

/// Returns the minimum speed, in m/s, of a person with these three echoes, newest first, and the maximum ratio of the
/// two speeds between them; `None` if the robot has turned too fast to compare the echoes.
fn limits([new, middle, old]: [(&Ping, Meters); 3]) -> Option<(f64, f64)> {
    let turned = |(from, _): (&Ping, Meters), (to, _): (&Ping, Meters)| {
        let Radians(turned) = Radians(to.pose.theta.0 - from.pose.theta.0).wrapped();
        (turned.abs(), to.at.seconds() - from.at.seconds())
    };
    let turns = [turned(old, middle), turned(middle, new)];
    if turns.iter().all(|(turned, seconds)| *turned <= (TURNS * seconds).max(TURNED)) {
        return Some((SPEEDS[0], STEADY));
    }
    turns.iter().all(|(turned, seconds)| *turned <= TURNS_MOST * seconds).then_some(IN_TURNS)
}

/// Returns the person whose three newest echoes, newest first, `sonar` has received; `None` if they are not from such a
/// person. The conditions are those of [`crosses`]. `sin` and `cos` are the sine and the cosine of the heading of
/// `here`.
fn comes<Y: DiffDrive + SonarRing>(
    y: &Y,
    sonar: SonarId,
    echoes: [(&Ping, Meters); 3],
    (here, (sin, cos)): (Pose, (f64, f64)),
    speed: f64,
) -> Option<Crossing> {
    let (slowest, steady) = limits(echoes)?;
    let [new, middle, old] = echoes;
    let echo = |(ping, range): (&Ping, Meters)| {
        let axis = ping.axis(sonar);
        let place = axis.towards(axis.theta, Meters(y.ring_radius().0 + range.0));
        let (x, y) = (place.x.0 - here.x.0, place.y.0 - here.y.0);
        Echo { at: ping.at.seconds(), along: x * cos + y * sin, across: y * cos - x * sin }
    };
    let approach = |from: &Echo, to: &Echo| {
        (libm::hypot(from.along, from.across) - libm::hypot(to.along, to.across)) / (to.at - from.at)
    };
    let moves = |speed: f64| (SPEEDS[0]..=SPEEDS[1]).contains(&speed);
    // Most echoes come from an obstacle in the way or from a fixed object. Their older places are not computed.
    let new = echo(new);
    let apart = y.body_radius().0 + PERSON;
    let is_far = new.across.abs() > FAR;
    let is_ahead = new.along > if is_far { CLEAR / 2.0 } else { apart };
    if !(is_ahead && new.across.abs() > ASIDE) {
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
    let is_before = new.along + apart < speed * (seconds - apart / mean);
    let meets = new.along < apart + PERSON + speed * seconds && seconds < SOON && !is_before;
    let is_nearer = mean * (new.at - old.at) >= NEARER;
    let back = if is_far && seconds < BACK { (apart + CLEAR - new.along).max(0.0) } else { 0.0 };
    let crossing = Crossing { passed: seconds + apart / mean, back };
    let is_steady = first.min(second) >= slowest && first.max(second) <= steady * first.min(second);
    (moves(first) && is_steady && is_nearer && meets).then_some(crossing)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Nanos;

    /// Returns the time, in seconds, for which a robot at rest waits for a person whose echoes its sonar 3 receives at
    /// these ranges, one second apart; `None` if it does not wait.
    fn seconds(ranges: [f64; 3]) -> Option<f64> {
        person(3, ranges).map(|person| person.passed)
    }

    /// Returns the person whose echoes this sonar of a robot at rest receives at these ranges, one second apart.
    fn person(sonar: u8, ranges: [f64; 3]) -> Option<Crossing> {
        turning(sonar, &ranges.map(|range| (Some(range), 0.0)))
    }

    /// Returns the person whose echoes this sonar receives at these ranges, one second apart, at these headings of the
    /// robot.
    fn turning(sonar: u8, pings: &[(Option<f64>, f64)]) -> Option<Crossing> {
        let (mut y, mut before) = (Sensed::default(), BeforeMissed::default());
        for (second, (range, heading)) in (0..).zip(pings) {
            y.pose.theta = Radians(*heading);
            y.ping_at(SonarId::new(sonar), *range, Nanos(second * 1_000_000_000));
            before.take(&y);
        }
        crosses(&y, &before, y.pose, 0.2)
    }

    /// Returns `true` if a robot at rest waits for the person whose echoes have these ranges.
    fn waits(ranges: [f64; 3]) -> bool {
        seconds(ranges).is_some()
    }

    #[test]
    fn somebody_who_comes_from_the_side_is_waited_for() {
        assert!(waits([2.8, 2.3, 1.8]));
        assert!(!waits([1.8, 1.8, 1.8]), "a wall");
        assert!(!waits([1.8, 2.3, 2.8]), "somebody who leaves");
        assert!(!waits([2.8, 2.8, 1.8]), "two different things");
        assert!(!waits([2.8, 2.5, 1.2]), "two different things, the first a rough wall");
        assert!(!waits([6.0, 5.5, 5.0]), "somebody far away");
    }

    #[test]
    fn the_robot_waits_until_he_has_passed() {
        // The person is 1.84 m beside the way, and leaves it half a metre further on.
        let passed = seconds([2.8, 2.3, 1.8]).expect("somebody");
        assert!((4.5..4.8).contains(&passed), "{passed}");
    }

    #[test]
    fn a_person_who_needs_seven_seconds_is_waited_for() {
        assert!(waits([4.7, 4.2, 3.7]));
    }

    #[test]
    fn a_person_whom_one_ping_misses_is_waited_for() {
        let comes = |ranges: [Option<f64>; 4]| turning(3, &ranges.map(|range| (range, 0.0))).is_some();
        assert!(comes([Some(2.8), None, Some(1.8), Some(1.3)]));
        assert!(!comes([Some(2.8), None, None, Some(1.3)]), "two of three are missed");
        assert!(!comes([Some(1.8), None, Some(1.8), Some(1.8)]), "a wall");
        assert!(!comes([None, None, Some(1.8), Some(1.3)]), "too few echoes");
        let twice = [Some(3.8), None, None, Some(2.3), Some(1.8)].map(|range| (range, 0.0));
        assert_eq!(turning(3, &twice), None, "two pings in a row miss");
    }

    /// A robot that a random range ahead has turned by 9 degrees turns back while the person comes.
    #[test]
    fn a_robot_that_turns_back_to_its_way_waits_for_a_steady_person() {
        let comes = |[old, middle]: [f64; 2], turn| {
            turning(3, &[(Some(old), turn), (Some(middle), 0.0), (Some(1.8), 0.0)]).is_some()
        };
        assert!(comes([2.8, 2.3], 0.16));
        assert!(!comes([2.8, 2.3], 0.21), "a faster turn");
        assert!(comes([3.2, 2.3], 0.0) && !comes([3.2, 2.3], 0.16), "unsteady, as echoes of a rough wall");
        assert!(comes([2.4, 2.1], 0.0) && !comes([2.4, 2.1], 0.16), "slow, as echoes of a rough wall");
    }

    /// Returns `true` if a robot waits while it turns to and fro by `angle` radians between pings that are 180 ms
    /// apart, and of which the second pair shows almost twice the speed of the first.
    fn waits_while_it_turns(angle: f64) -> bool {
        let mut y = Sensed { confirmation: 2, ..Sensed::default() };
        for (number, (range, turned)) in (0..).zip([(2.0, 0.0), (1.9, angle), (1.72, 0.0)]) {
            y.pose.theta = Radians(turned);
            y.ping_at(SonarId::new(3), Some(range), Nanos(number * 180_000_000));
        }
        crosses(&y, &BeforeMissed::default(), y.pose, 0.2).is_some()
    }

    #[test]
    fn a_robot_whose_wheels_skid_a_little_waits_too() {
        assert!(waits_while_it_turns(0.009) && !waits_while_it_turns(0.011));
    }

    /// A person 1.4 m away at 67.5° is 53 cm ahead, and would touch a robot that stands still.
    #[test]
    fn the_robot_backs_off_from_where_a_person_would_meet_it() {
        let back = |ranges| person(3, ranges).map(|person| person.back);
        assert!(back([2.1, 1.7, 1.2]).is_some_and(|back| (0.1..0.15).contains(&back)));
        assert_eq!(back([2.8, 2.3, 1.8]), Some(0.0), "77 cm ahead");
    }

    #[test]
    fn a_person_who_comes_abreast_is_not_waited_for() {
        assert_eq!(person(4, [2.1, 1.7, 1.2]), None);
        assert_eq!(person(3, [1.8, 1.4, 0.9]), None, "a person as near as the wall of a hallway");
    }
}
