//! Tests of the people who cross the way: whom the robot waits for, and how far it backs off.

use super::*;
use crate::trial::Sensed;
use mdle_runtime::Nanos;

const DRIVES: Driving = Driving { speed: 0.2, waits: false };
const STANDS: Driving = Driving { waits: true, ..DRIVES };

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
    heard(sonar, pings, DRIVES)
}

/// Returns the person whom [`turning`] returns, for a robot that drives in this way.
fn heard(sonar: u8, pings: &[(Option<f64>, f64)], driving: Driving) -> Option<Crossing> {
    let (mut y, mut before) = (Sensed::default(), BeforeMissed::default());
    for (second, (range, heading)) in (0..).zip(pings) {
        y.pose.theta = Radians(*heading);
        y.ping_at(SonarId::new(sonar), *range, Nanos(second * 1_000_000_000));
        before.take(&y);
    }
    crosses(&y, &before, y.pose, driving)
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
    crosses(&y, &BeforeMissed::default(), y.pose, DRIVES).is_some()
}

#[test]
fn a_robot_whose_wheels_skid_a_little_waits_too() {
    assert!(waits_while_it_turns(0.009) && !waits_while_it_turns(0.011));
}

/// Sonar 3 faces 67.5° to the left. If sonar 4, which faces to the left, also receives the echo, the person is
/// nearer to the robot's own place than sonar 3 alone shows.
#[test]
fn a_robot_backs_off_further_from_a_person_whom_two_sonars_hear() {
    let mut y = Sensed::default();
    for (second, range) in (0..).zip([2.1, 1.7, 1.3]) {
        y.ping_at(SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
    }
    let back = |y: &Sensed| crosses(y, &BeforeMissed::default(), y.pose, DRIVES).map(|person| person.back);
    assert!(back(&y).is_some_and(|back| (0.05..0.15).contains(&back)), "{:?}", back(&y));
    y.ping_at(SonarId::new(4), Some(1.3), Nanos(2_000_000_000));
    assert!(back(&y).is_some_and(|back| back > 0.3), "{:?}", back(&y));
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
    assert_eq!(person(3, [1.3, 0.9, 0.4]), None, "a person as near as the wall of a hallway");
}

#[test]
fn a_robot_that_waits_backs_off_from_a_person_who_comes_abreast() {
    let back = |ranges: [f64; 3]| heard(4, &ranges.map(|range| (Some(range), 0.0)), STANDS).map(|person| person.back);
    assert!(back([2.5, 2.0, 1.5]).is_some_and(|back| back > 0.6), "{:?}", back([2.5, 2.0, 1.5]));
    assert_eq!(back([1.5, 1.5, 1.5]), None, "a wall");
}

/// Sonar 3 faces 67.5° to the left. The edge of its cone, at 55°, is 1.18 m ahead of the robot's centre when the range
/// is 1.8 m.
#[test]
fn echoes_that_may_come_from_the_wall_ahead_are_nobody() {
    let waits = |wall: Option<f64>| {
        let mut y = Sensed::default();
        y.ping_at(SonarId::new(0), wall, Nanos(1_500_000_000));
        for (second, range) in (0..).zip([2.8, 2.3, 1.8]) {
            y.ping_at(SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
        }
        crosses(&y, &BeforeMissed::default(), y.pose, DRIVES).is_some()
    };
    assert!(!waits(Some(1.2)) && waits(Some(1.6)) && waits(None));
}

/// Sonar 2 faces 45° to the left. The person comes at 0.5 m/s, and the robot drives towards the person's way.
#[test]
fn a_person_who_comes_from_ahead_and_from_the_side_is_waited_for() {
    let waits = |ranges| person(2, ranges).is_some();
    assert!(waits([3.4, 2.9, 2.4]), "3.4 s before they meet");
    assert!(!waits([3.65, 3.15, 2.65]), "3.7 s before they meet");
    let is_kept_waiting = |ranges: [f64; 3]| heard(2, &ranges.map(|range| (Some(range), 0.0)), STANDS).is_some();
    assert!(is_kept_waiting([3.0, 2.5, 2.0]), "3.5 s before the person reaches the robot");
    assert!(!is_kept_waiting([3.4, 2.9, 2.4]), "4.3 s before");
}

/// The person is 39 cm ahead of the robot's centre, and 92 cm to its left.
#[test]
fn a_person_almost_abreast_is_waited_for() {
    assert!(waits([1.8, 1.3, 0.8]));
    assert_eq!(person(4, [1.8, 1.3, 0.8]), None, "abreast");
}
