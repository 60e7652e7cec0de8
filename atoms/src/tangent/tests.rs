//! Tests the tangent rule: free ways, walls beside a way, and detours around obstacles.

use super::*;
use crate::trial::{Sensed, sized};

fn wish(side: Option<Side>) -> Wish {
    Wish { goal: Radians(0.0), look_ahead: Meters(0.4), previous: None, side, along: false, close: false }
}

#[test]
fn straight_to_the_goal_where_nothing_is_near() {
    let mut y = Sensed::default();
    y.ping(SonarId::new(0), Some(2.1));
    let obstacles = Obstacles::seen(&y, y.pose);
    assert_eq!(obstacles.free(Radians(0.0)), Meters(FREE_MOST));
    assert_eq!(obstacles.best(&wish(None)), Radians(0.0));
}

#[test]
fn free_way_ends_where_the_body_with_its_margin_touches() {
    let mut y = Sensed::default();
    y.ping(SonarId::new(0), Some(1.0));
    // The point on the axis is 1.19 m from the centre, the margin 0.265 m around it.
    let free = Obstacles::seen(&y, y.pose).free(Radians(0.0));
    assert!((free.0 - 0.925).abs() < 1e-12, "{free:?}");
}

#[test]
fn turns_aside_to_the_side_it_keeps_to() {
    let mut y = Sensed::default();
    y.ping(SonarId::new(0), Some(0.2));
    let obstacles = Obstacles::seen(&y, y.pose);
    let left = obstacles.best(&wish(Some(Side::Left)));
    let right = obstacles.best(&wish(Some(Side::Right)));
    assert!(left.0 > 0.5 && left.0 < 2.0, "{left:?}");
    assert!((left.0 + right.0).abs() < 1e-12, "{right:?}");
}

#[test]
fn leads_off_a_wall_that_is_too_close() {
    let mut y = Sensed::default();
    // A wall 0.4 m to the left of the centre, heard abreast and half a metre ahead.
    y.ping(SonarId::new(4), Some(0.21));
    let there = Pose { x: Meters(0.5), ..y.pose };
    y.pose = there;
    y.ping(SonarId::new(5), Some(0.43 - 0.19));
    y.pose = Pose::ORIGIN;
    let chosen = Obstacles::seen(&y, y.pose).best(&wish(None));
    assert!((-40.0..=-10.0).contains(&chosen.degrees()), "{}", chosen.degrees());
}

/// Returns the direction, in degrees, that an ATRV-mini chooses in a hallway 1.8 m wide, with its centre at this
/// distance, in metres, from the left wall. The goal is straight ahead.
fn in_a_hallway(left: f64) -> f64 {
    let mut y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    for x in [-0.5, -0.25, 0.0] {
        y.pose.x = Meters(x);
        for (sonar, wall) in [(4, left), (12, 1.8 - left)] {
            y.ping(SonarId::new(sonar), Some(wall - y.ring_radius().0));
        }
    }
    Obstacles::seen(&y, y.pose).best(&wish(None)).degrees()
}

#[test]
fn a_wide_body_returns_to_the_middle_of_a_hallway() {
    assert_eq!(in_a_hallway(0.9), 0.0);
    assert!(in_a_hallway(0.55) < 0.0, "to the right");
    assert!(in_a_hallway(1.25) > 0.0, "to the left");
}

/// Returns the distance from a place 60 cm ahead to a wall beside it that sonar 4 heard there at this range.
fn beside_a_wall_at(range: f64, confirmation: usize) -> f64 {
    let mut y = Sensed { confirmation, ..Sensed::default() };
    y.pose.x = Meters(0.6);
    y.ping(SonarId::new(4), Some(range));
    y.pose = Pose::ORIGIN;
    Obstacles::seen(&y, y.pose).beside(Axis::of(Radians(0.0)), Meters(FREE_MOST), ROOM_AT)
}

#[test]
fn a_wall_at_the_least_range_may_be_nearer() {
    assert!((beside_a_wall_at(0.1524, 2) - 0.205 - AT_LEAST_RANGE).abs() < 0.001);
    assert!((beside_a_wall_at(0.1524, 3) - 0.19 - 0.1524).abs() < 0.002, "full rings hear how near it is");
    assert!((beside_a_wall_at(0.1778, 2) - 0.19 - 0.1778).abs() < 0.002);
}

/// Returns `true` if a robot 1 m before two posts, whose edges leave 5.5 cm on both sides of its body,
/// considers the way between them free.
fn passes(confirmation: usize) -> bool {
    let mut y = Sensed { confirmation, ..Sensed::default() };
    for (sonar, side) in [(4, 1.0), (12, -1.0)] {
        // Heard from 20 cm beyond the middle, since a Scout reports its minimum range for a nearer obstacle.
        y.pose = Pose { x: Meters(1.0), y: Meters(-0.2 * side), ..Pose::ORIGIN };
        y.ping(SonarId::new(sonar), Some(0.2 + 0.205 + 0.055 - 0.19));
    }
    y.pose = Pose::ORIGIN;
    Obstacles::seen(&y, y.pose).free(Radians(0.0)).0 == FREE_MOST
}

#[test]
fn a_gap_is_free_by_the_hard_margin_of_the_body() {
    assert!(passes(2));
    assert!(!passes(3), "full rings keep 6 cm");
}

#[test]
fn a_wall_ahead_is_come_as_near_to_as_the_look_ahead_lets() {
    let ahead = |range: f64| {
        let mut y = Sensed::default();
        for sonar in [15, 0, 1] {
            let slant = libm::cos(SonarId::new(sonar).bearing().0);
            y.ping(SonarId::new(sonar), Some((range + 0.19) / slant - 0.19));
        }
        Obstacles::seen(&y, y.pose).best(&wish(None))
    };
    assert_eq!(ahead(0.55), Radians(0.0));
    assert!(ahead(0.4).0.abs() > 0.3, "{:?}", ahead(0.4));
}

#[test]
fn a_point_stays_where_it_was_heard() {
    let mut y = Sensed::default();
    y.ping(SonarId::new(0), Some(1.0));
    y.pose = Pose { x: Meters(0.5), y: Meters(0.0), theta: Radians(1.0) };
    let free = Obstacles::seen(&y, y.pose).free(Radians(0.0));
    assert!((free.0 - 0.425).abs() < 1e-12, "{free:?}");
}

/// Returns the free distance ahead of a robot that has heard a wall on its left in three pings, `leans` metres
/// nearer each time.
fn beside_a_wall(leans: f64, confirmation: usize) -> f64 {
    let mut y = Sensed { confirmation, ..Sensed::default() };
    for ping in 0..3 {
        y.pose.x = Meters(0.2 * f64::from(ping));
        y.ping(SonarId::new(4), Some(0.5 - leans * f64::from(ping)));
    }
    Obstacles::seen(&y, y.pose).free(Radians(0.0)).0
}

#[test]
fn a_wall_goes_on_beyond_where_it_was_heard_where_sonars_fire_in_turn() {
    assert_eq!(beside_a_wall(0.0, 2), FREE_MOST);
    // Half a metre ahead a wall that leans in by 0.1 m for each 0.2 m is inside the margin.
    assert!(beside_a_wall(0.1, 2) < 0.6, "{}", beside_a_wall(0.1, 2));
    assert_eq!(beside_a_wall(0.1, 3), FREE_MOST, "full rings see it themselves");
}

#[test]
fn the_ping_before_counts_when_the_newest_heard_nothing() {
    let mut y = Sensed::default();
    y.ping(SonarId::new(0), Some(1.0));
    y.ping(SonarId::new(0), None);
    assert!(Obstacles::seen(&y, y.pose).free(Radians(0.0)).0 < 1.0);
    y.ping(SonarId::new(0), None);
    assert_eq!(Obstacles::seen(&y, y.pose).free(Radians(0.0)), Meters(FREE_MOST));
}

/// Returns the number of positions that this robot remembers after pings of its front sonar, each with the robot's
/// heading, in degrees, and the range.
fn remembered(mut y: Sensed, pings: &[(f64, f64)]) -> usize {
    let (mut memory, mut map) = (Memory::EMPTY, Map::EMPTY);
    for (heading, range) in pings {
        y.now = Nanos(y.now.0 + 100_000_000);
        y.pose.theta = Radians::from_degrees(*heading);
        y.ping_at(SonarId::new(0), Some(*range), y.now);
        memory.take(&y);
        map.take(&y, y.pose);
    }
    let mut obstacles = Obstacles::seen(&y, y.pose);
    let seen = obstacles.remember(&memory, &map, y.pose, y.now);
    obstacles.count - seen
}

#[test]
fn a_wide_body_forgets_positions_that_pings_pass() {
    let atrv = || Sensed { confirmation: 2, ..sized(0.315, 0.27) };
    let passes = [(0.0, 0.8), (-3.0, 1.5), (0.0, 1.5), (3.0, 1.5)];
    assert_eq!(remembered(atrv(), &passes[..1]), 1);
    assert_eq!(remembered(atrv(), &passes), 0, "the object is elsewhere on the arc of the echo");
    let often = [passes[0], passes[0], passes[0], passes[2]];
    assert_eq!(remembered(atrv(), &often), 1, "one ping against three echoes");
    let scout = Sensed { confirmation: 2, ..Sensed::default() };
    assert_eq!(remembered(scout, &passes), 1);
}
