//! Tests of `goAvoid`: when the law ends, how it treats its goal, and on which side it turns.

use super::*;
use crate::trial::{Sensed, begun, framed, sized, until_completed};

fn quark(bearing: f64, range: f64) -> GoAvoid {
    GoAvoid::new(Radians::from_degrees(bearing), Meters(range), MetersPerSecond(0.2))
}

#[test]
fn arrives_at_a_point_given_from_where_the_atom_begins() {
    let mut y = Sensed::heading(30.0);
    y.pose.x = Meters(5.0);
    let mut law = quark(90.0, 2.0).begin(&y, framed(180.0));
    until_completed(&mut law, &mut y);
    let goal = Pose { x: Meters(5.0), y: Meters(-2.0), theta: Radians(0.0) };
    assert!(y.pose.distance(&goal) <= ARRIVED, "{:?}", y.pose);
}

#[test]
fn a_range_of_nothing_is_done_at_once() {
    let y = Sensed::default();
    assert!(quark(90.0, 0.0).begin(&y, begun()).completed(&y, Nanos::ZERO));
}

#[test]
fn arrives_by_one_sonar_that_still_works() {
    for number in 0..16 {
        for confirmation in [2, 3] {
            let mut y = Sensed { confirmation, ..Sensed::default() };
            for _ in 0..3 {
                y.ping(mdle_runtime::SonarId::new(number), Some(0.8));
            }
            let mut law = quark(0.0, 2.0).begin(&y, begun());
            until_completed(&mut law, &mut y);
            let goal = Pose { x: Meters(2.0), ..Pose::ORIGIN };
            assert!(y.pose.distance(&goal) <= ARRIVED, "sonar {number}: {:?}", y.pose);
        }
    }
}

/// The rear corners of a rectangle would swing into a wall that is nearer than its sonars can measure.
#[test]
fn a_rectangle_leaves_a_wall_beside_it_in_an_arc() {
    let turns = |sonars: &[u8], halves: (f64, f64)| {
        let mut y = Sensed { confirmation: 2, ..sized(halves.0, halves.1) };
        for sonar in sonars {
            y.ping(mdle_runtime::SonarId::new(*sonar), Some(0.16));
        }
        let twist = quark(90.0, 3.0).begin(&y, begun()).input(&y, Nanos(0));
        (twist.v.0 > 0.0, twist.omega.0)
    };
    let atrv = (0.315, 0.27);
    assert!(matches!(turns(&[12], atrv), (true, 0.04..0.05)), "{:?}", turns(&[12], atrv));
    assert!(matches!(turns(&[4], atrv), (true, -0.05..-0.04)), "{:?}", turns(&[4], atrv));
    assert_eq!(turns(&[4, 12], atrv), (true, 0.0));
    for elsewhere in [turns(&[12, 0], atrv), turns(&[8], atrv), turns(&[12], (0.205, 0.205))] {
        assert!(elsewhere.1 > 0.1, "turns to its goal: {elsewhere:?}");
    }
}

/// An arc that begins askew to a wall would lead into the wall.
#[test]
fn a_rectangle_that_is_askew_to_a_wall_beside_it_drives_no_arc() {
    let beside = |begins: f64, turned: f64| {
        let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        y.pose.theta = Radians::from_degrees(begins);
        let mut law = quark(90.0, 3.0).begin(&y, begun());
        y.pose.theta = Radians::from_degrees(begins + turned);
        law.input(&y, Nanos(0));
        y.ping(mdle_runtime::SonarId::new(12), Some(0.16));
        y.pose.theta = Radians::from_degrees(begins);
        law.input(&y, Nanos(1)).omega.0
    };
    assert!([0.0, 4.0, 94.0, -86.0].iter().all(|begins| (0.04..0.05).contains(&beside(*begins, 0.0))));
    for (begins, turned) in [(20.0, 0.0), (-20.0, 0.0), (0.0, -20.0)] {
        assert!(beside(begins, turned) > 0.1, "begins at {begins}, turned {turned}");
    }
}

#[test]
fn never_drives_backwards_nor_into_what_is_close_ahead() {
    let mut y = Sensed::default();
    for number in 0..16 {
        y.ping(mdle_runtime::SonarId::new(number), Some(0.02));
    }
    let mut law = quark(0.0, 40.0).begin(&y, begun());
    for turn in 0..50 {
        assert_eq!(law.input(&y, Nanos(turn * 100_000_000)).v.0, 0.0);
    }
}

#[test]
fn the_goal_turns_round_where_the_drift_was_measured_before() {
    let quarter = Radians::from_degrees(90.0);
    let mut law = quark(0.0, 3.0).begin(&Sensed::default(), begun());
    let at = |x: f64, y: f64| Pose { x: Meters(x), y: Meters(y), theta: Radians(0.0) };
    law.turn_goal(quarter, at(1.0, 0.0));
    assert!(law.goal.distance(&at(0.0, 3.0)).0 < 1e-12, "{:?}", law.goal);
    law.turn_goal(quarter, at(2.0, 0.0));
    law.turn_goal(Radians(0.0), at(2.0, 0.0));
    assert!(law.goal.distance(&at(4.0, 1.0)).0 < 1e-12, "{:?}", law.goal);
}

/// Returns the time at which the law ends for a robot that does not move, after it has driven `driven` metres; `None`
/// if the law does not end within 30 s.
fn ends(y: &Sensed, range: f64, driven: f64) -> Option<Nanos> {
    let mut law = quark(0.0, range).begin(y, begun());
    (law.driven.0, law.headed) = (driven, Some(Nanos::ZERO));
    (0..300).map(|turn| Nanos(turn * 100_000_000)).find(|t| {
        law.input(y, *t);
        law.completed(y, *t)
    })
}

/// After 9 m by odometry, a goal may be 18 cm off. A goal inside a wall counts as reached in front of the wall, but
/// only after the robot has tried for a while.
#[test]
fn a_goal_that_has_drifted_into_a_wall_is_reached() {
    let mut y = Sensed::default();
    (0..3).for_each(|_| y.ping(mdle_runtime::SonarId::new(0), Some(0.1)));
    assert_eq!(ends(&y, 0.48, 1.0), None);
    assert!(ends(&y, 0.48, 9.0).is_some_and(|t| t > DRIFTS_AFTER));
}

/// A robot that has searched for 100 m is not done further than half a metre from its goal.
#[test]
fn a_long_way_is_no_arrival() {
    let mut y = Sensed::default();
    (0..3).for_each(|_| y.ping(mdle_runtime::SonarId::new(0), Some(0.2)));
    assert!(ends(&y, 0.5, 100.0).is_some_and(|t| t > DRIFTS_AFTER));
    for range in [0.51, 0.6, 1.0, 1.5] {
        assert_eq!(ends(&y, range, 100.0), None, "{range} m");
    }
}

/// An ATRV-mini 17 cm from its goal has no room to turn towards the goal, but hears no obstacle on the way to it.
#[test]
fn a_robot_that_comes_no_nearer_is_done_beside_its_goal() {
    let y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    assert!(ends(&y, 0.17, 0.0).is_some_and(|t| t > DRIFTS_AFTER));
    assert_eq!(ends(&y, 0.55, 0.0), None);
}

/// The robot turns left to a goal that is behind it, a little to the left. After three quarters of a circle to the
/// left, it turns right instead.
#[test]
fn an_atrv_mini_turns_back_after_a_circle() {
    let turns = |y: &mut Sensed, quarters: u32| {
        let mut law = quark(f64::from(90 * quarters) + 150.0, 5.0).begin(y, begun());
        let mut omega = 0.0;
        for quarter in 0..=quarters {
            y.pose.theta = Radians::from_degrees(f64::from(90 * quarter)).wrapped();
            omega = law.input(y, Nanos(u64::from(quarter))).omega.0;
        }
        omega
    };
    let mut atrv = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    assert_eq!(turns(&mut atrv, 1), FASTEST);
    atrv.pose = Pose::ORIGIN;
    assert_eq!(turns(&mut atrv, 3), -FASTEST);
    assert_eq!(turns(&mut Sensed::default(), 3), FASTEST);
}

/// An ATRV-mini between two walls begins with a turn of 170 degrees, and does not interrupt it to follow a way on its
/// map.
#[test]
fn the_turn_at_the_beginning_is_no_delay() {
    let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    let mut law = quark(170.0, 5.0).begin(&y, begun());
    for turn in 1..=20 {
        let now = Nanos(turn * 100_000_000);
        y.now = now;
        for (number, range) in [(0, 0.3), (4, 0.45), (8, 0.3), (12, 0.45)] {
            y.ping_at(mdle_runtime::SonarId::new(number), Some(range), now);
        }
        law.input(&y, now);
        assert!(law.headed.is_some() || !law.narrow.follows(), "after {turn} turns");
    }
    assert!(law.headed.is_none());
}

/// A wall 4 cm beside a rectangle is in the way of its corners, not in that of a disc, which turns as fast as movements
/// on the map are, or as the tangent rule turns a body whose sonars all ping in every turn. A wall that such a body
/// nearly touches is in its way too.
#[test]
fn a_body_whose_sonars_fire_in_turn_looks_at_its_map_before_it_turns() {
    let turns = |mut y: Sensed, range: f64| {
        let mut law = quark(90.0, 5.0).begin(&y, begun());
        let mut turns = |turn: u64| {
            y.now = Nanos(turn * 100_000_000);
            y.ping_at(mdle_runtime::SonarId::new(12), Some(range), y.now);
            law.input(&y, y.now).omega.0
        };
        (1..=5).map(&mut turns).fold(0.0, |_, omega| omega)
    };
    let atrv = turns(Sensed { confirmation: 2, ..sized(0.315, 0.27) }, 0.12);
    assert!(atrv < 0.2, "{atrv}");
    assert_eq!(turns(Sensed { confirmation: 2, ..Sensed::default() }, 0.12), 0.7);
    assert_eq!([0.12, 0.05].map(|range| turns(Sensed::default(), range)), [FASTEST, 0.7]);
}

/// In a dead end whose ways all lead back, the robot drives back, and its detour changes sides.
#[test]
fn a_dead_end_is_left() {
    let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    let mut law = quark(0.0, 5.0).begin(&y, begun());
    for turn in 1..=200 {
        y.now = Nanos(turn * 100_000_000);
        for (number, range) in [(15, 0.3), (0, 0.25), (1, 0.3), (4, 0.2), (12, 0.2)] {
            y.ping_at(mdle_runtime::SonarId::new(number), Some(range), y.now);
        }
        law.input(&y, y.now);
        if turn == 140 {
            law.detour = Some(Detour::begin(Side::Left, &law.goal, y.pose, Radians(0.0), y.now));
        }
    }
    assert!(law.dwell.leaves());
    assert_eq!(law.detour.map(|detour| detour.side), Some(Side::Right));
    let v = law.input(&y, Nanos(20_100_000_000)).v;
    assert!(v.0 < 0.0, "{v:?}");
}

#[test]
fn the_goal_turns_while_the_robot_follows_its_map() {
    let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    let mut law = quark(0.0, 5.0).begin(&y, begun());
    for turn in 1..=50 {
        y.now = Nanos(turn * 100_000_000);
        for (number, range) in [(15, 0.3), (0, 0.25), (1, 0.3), (4, 0.2), (12, 0.2)] {
            y.ping_at(mdle_runtime::SonarId::new(number), Some(range), y.now);
        }
        law.input(&y, y.now);
    }
    assert!(law.narrow.follows());
    y.drift = Radians::from_degrees(90.0);
    law.input(&y, y.now);
    assert!(law.goal.distance(&Pose { y: Meters(5.0), ..Pose::ORIGIN }).0 < 1e-9, "{:?}", law.goal);
}

/// Odometry may report a heading across the walls for a robot that is parallel to them.
#[test]
fn the_drift_of_the_heading_decides_whether_a_robot_is_askew() {
    let departs = |degrees: f64, drift: f64| {
        let mut y = Sensed { confirmation: 2, drift: Radians::from_degrees(drift), ..sized(0.315, 0.27) };
        y.pose.theta = Radians::from_degrees(degrees);
        quark(90.0, 3.0).begin(&y, begun()).departs
    };
    assert!(departs(0.0, 0.0) && departs(20.0, 20.0));
    assert!(!departs(0.0, 20.0) && !departs(20.0, 0.0));
}

/// Returns `true` if a robot that has driven `driven` metres follows its map after it has not moved for this time.
fn follows_map(y: &Sensed, driven: f64, seconds: f64) -> bool {
    let mut law = quark(0.0, 5.0).begin(y, begun());
    law.driven.0 = driven;
    let chosen = Chosen { direction: Radians(0.0), ahead: Meters(0.2), to_goal: None };
    law.squeeze(y, y.pose, Nanos::ZERO, &chosen);
    law.squeeze(y, y.pose, Nanos((seconds * 1e9) as u64), &chosen).is_some()
}

#[test]
fn a_rectangle_that_has_just_begun_follows_its_map_later() {
    let follows =
        |driven: f64, seconds: f64| follows_map(&Sensed { confirmation: 2, ..sized(0.315, 0.27) }, driven, seconds);
    assert!(!follows(0.0, 1.5) && follows(0.0, 2.1));
    assert!(!follows(0.6, 1.1) && follows(0.6, 1.5));
}

#[test]
fn a_robot_without_progress_follows_its_map_and_goes_round_by_turns() {
    let follows = [40.0, 50.0, 100.0, 110.0].map(|seconds| follows_map(&Sensed::default(), 1.0, seconds));
    assert_eq!(follows, [true, false, false, true]);
}

/// The robot stands beside a wall on its right, where it would drive away in an arc to the left.
#[test]
fn a_robot_beside_a_wall_gives_way_before_it_drives_away() {
    let turns = |nearer: f64| {
        let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        let mut law = quark(0.0, 8.0).begin(&y, begun());
        let mut omega = 0.0;
        for echo in 0..6 {
            y.now = Nanos(echo * 360_000_000);
            y.ping_at(mdle_runtime::SonarId::new(0), Some(5.0 - nearer * 0.36 * echo as f64), y.now);
            y.ping_at(mdle_runtime::SonarId::new(12), Some(0.16), y.now);
            omega = law.input(&y, y.now).omega.0;
        }
        (law.passers.gives_way().is_some(), omega)
    };
    let (gives_way, arc) = turns(0.0);
    assert!(!gives_way && (0.04..0.05).contains(&arc), "{arc}");
    let (gives_way, aside) = turns(1.0);
    assert!(gives_way && !(0.04..0.05).contains(&aside), "{aside}");
}

/// A person who comes to within 1.4 m at 67.5° is 53 cm ahead: the robot would be touched where it stands.
#[test]
fn the_robot_backs_off_from_a_person_who_crosses() {
    let mut y = Sensed::default();
    for (second, range) in (0..).zip([2.1, 1.7, 1.2]) {
        y.ping_at(mdle_runtime::SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
    }
    let mut law = quark(0.0, 5.0).begin(&y, begun());
    let mut speed = |y: &Sensed| (0..5).map(|turn| law.input(y, Nanos(turn * 100_000_000)).v.0).fold(0.0, |_, v| v);
    assert_eq!(speed(&y), -0.2);
    y.pose.x = Meters(-0.3);
    assert_eq!(speed(&y), 0.0, "far enough");
}

/// Returns the speeds of a robot that a person approaches at these ranges from the left, one second apart; the robot
/// has turned by this angle, in degrees, since its law began.
fn speeds_before_a_person<const N: usize>(ranges: [f64; N], turned: f64) -> [f64; N] {
    let mut y = Sensed::default();
    let mut law = quark(0.0, 5.0).begin(&y, begun());
    y.pose.theta = Radians::from_degrees(turned);
    let mut second = 0;
    ranges.map(|range| {
        y.ping_at(mdle_runtime::SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
        let turn = |tenth: u64| Nanos(second * 1_000_000_000 + tenth * 100_000_000);
        let speed = (0..5).map(|tenth| law.input(&y, turn(tenth)).v.0).fold(0.0, |_, v| v);
        second += 1;
        speed
    })
}

/// At 1.08 m, the person is less than 1.2 m from the way. From there, the robot would not begin to back off.
#[test]
fn a_robot_that_backs_off_goes_on_while_the_person_comes_nearer() {
    assert_eq!(speeds_before_a_person([2.0, 1.68, 1.36, 1.08], 0.0)[2..], [-0.2, -0.2]);
    assert_eq!(speeds_before_a_person([1.68, 1.36, 1.08], 0.0)[2], 0.0);
}

/// Sonar 3 receives echoes of a person who passes ahead of the robot, and sonar 4 of one who comes abreast.
#[test]
fn a_robot_that_stands_for_a_person_backs_off_from_another_who_comes_abreast() {
    let speed = |abreast: [Option<f64>; 3]| {
        let mut y = Sensed::default();
        for (second, (range, abreast)) in (0..).zip([2.8, 2.3, 1.8].into_iter().zip(abreast)) {
            y.ping_at(mdle_runtime::SonarId::new(3), Some(range), Nanos(second * 1_000_000_000));
            y.ping_at(mdle_runtime::SonarId::new(4), abreast, Nanos(second * 1_000_000_000));
        }
        let mut law = quark(0.0, 5.0).begin(&y, begun());
        (0..10).map(|turn| law.input(&y, Nanos(turn * 100_000_000)).v.0).fold(0.0, |_, v| v)
    };
    assert_eq!([speed([None; 3]), speed([Some(2.5), Some(2.0), Some(1.5)])], [0.0, -0.2]);
}

#[test]
fn a_robot_that_has_turned_off_its_way_does_not_back_off() {
    assert_eq!(speeds_before_a_person([2.2, 1.8, 1.2], 25.0)[2], -0.2);
    assert_ne!(speeds_before_a_person([2.2, 1.8, 1.2], 35.0)[2], -0.2);
}

/// The law has to know the echo before the missed ping, which the output no longer keeps.
#[test]
fn the_robot_stands_for_a_person_whom_a_ping_misses() {
    let speed = |ranges: [Option<f64>; 4]| {
        let (mut y, mut speed) = (Sensed::default(), 0.0);
        let mut law = quark(0.0, 5.0).begin(&y, begun());
        for (second, range) in (0..).zip(ranges) {
            y.ping_at(mdle_runtime::SonarId::new(3), range, Nanos(second * 1_000_000_000));
            for tenth in 0..5 {
                speed = law.input(&y, Nanos(second * 1_000_000_000 + tenth * 100_000_000)).v.0;
            }
        }
        speed
    };
    assert_eq!(speed([Some(3.3), None, Some(2.3), Some(1.8)]), 0.0);
    assert_eq!(speed([None, None, Some(2.3), Some(1.8)]), 0.2);
}

/// The corner of a wall may look like a person whenever the robot comes past it.
#[test]
fn the_robot_backs_off_once_from_one_place() {
    let mut y = Sensed::default();
    let mut law = quark(0.0, 50.0).begin(&y, begun());
    for (minute, place, expected) in [(1, 0.0, -0.2), (2, 0.3, 0.0), (3, 0.6, -0.2)] {
        let at = |seconds: u64| Nanos(1_000_000_000 * (60 * minute + seconds));
        y.pose.x = Meters(place);
        for (second, range) in (0..).zip([2.1, 1.7, 1.2]) {
            y.ping_at(mdle_runtime::SonarId::new(3), Some(range), at(second));
        }
        let last = (0..5).map(|turn| law.input(&y, Nanos(at(2).0 + turn * 100_000_000)).v.0).fold(0.0, |_, v| v);
        assert_eq!(last, expected, "at {place} m");
    }
}
