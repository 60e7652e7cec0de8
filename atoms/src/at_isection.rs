//! `atIsection b`: fires where the ways front, left, back and right are as the bits say (paper, section IV-A).

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Bits, Interrupt, Meters, Ping, Radians, SONARS, SonarId};

use crate::askew::is_askew;
use crate::gains::fire_in_turn;

/// The sonars that look front, left, back and right: the order in which the bits are written.
pub(crate) const DIRECTIONS: [SonarId; 4] = [SonarId::new(0), SonarId::new(4), SonarId::new(8), SonarId::new(12)];

/// Maximum angle between a ping's axis and a direction for the ping to count there: half the angle between two sonars
/// and a little more, so that a robot that turns slowly always has one sonar in each direction.
const WITHIN: Radians = Radians::from_degrees(14.0);
/// Ranges of two pings of one sonar that differ by less, in metres, are of one thing, and not random.
const SAME: f64 = 0.1;

/// Half the angle of the cone in which a sonar hears a rough wall.
pub(crate) const CONE: Radians = Radians::from_degrees(12.5);
/// Greatest distance, in metres, from the edge of a cone to the wall that it reaches.
const OF_WALL: f64 = 0.08;
/// Factor and step, in metres, by which the ranges of the neighbours of a sonar may exceed its own along a straight
/// wall; an echo from beyond an opening is further.
const SLANT: (f64, f64) = (1.08, 0.02);

/// Fires while all four directions are as the bits say: 1 where an obstacle is near, 0 where the way is free.
///
/// Where sonars fire in turn, as on robots, it also needs walls to lie in the four directions and not between them: a
/// wall is heard only by those sonars that it faces, and a robot that is turned between two directions hears nothing
/// where a way seems free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AtIsection {
    pattern: Bits<4>,
}

impl AtIsection {
    /// The quark `atIsection pattern`, with the bits front, left, back, right.
    #[must_use]
    pub const fn new(pattern: Bits<4>) -> Self {
        Self { pattern }
    }
}

impl<Y: SonarRing> Interrupt<Y> for AtIsection {
    fn fired(&self, y: &Y) -> bool {
        let is_as_said = |blocked: fn(&Y, SonarId) -> Option<bool>| {
            DIRECTIONS.iter().zip(self.pattern.0).all(|(sonar, obstacle)| blocked(y, *sonar) == Some(obstacle))
        };
        if !fire_in_turn(y) {
            return is_as_said(blocked);
        }
        is_as_said(blocked_in_turn) && !is_askew(y)
    }
}

/// Returns `Some(true)` if an obstacle is near in the direction of this one sonar; `None` before its first ping.
///
/// The smallest of the last pings decides, so "blocked" is believed at once and "free" only when they agree: a missed
/// echo opens no way. Only the sonar in that direction counts: its neighbours see the walls along a corridor.
fn blocked<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<bool> {
    let pings = y.pings(sonar);
    pings.newest_first().next()?;
    Some(pings.nearest(y.confirmation()).is_some_and(|range| range < y.blocked_within()))
}

/// Returns `Some(true)` if an obstacle is near in the direction of `sonar`, on a robot whose sonars fire in turn. The
/// pings of any sonar that looked in that direction of the room count: while the robot turns, the last pings of one
/// sonar were in other directions.
fn blocked_in_turn<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<bool> {
    let near = towards(y, sonar)?;
    Some(near < y.blocked_within())
}

/// Returns the minimum range of the two newest pings in the present direction of a sonar; infinite if both heard
/// nothing.
///
/// `None` where too few looked there: one ping that hears something near is believed, one that does not opens no way.
pub(crate) fn towards<Y: SonarRing>(y: &Y, direction: SonarId) -> Option<Meters> {
    let newest = newest(y, direction, |sonar, ping| !is_of_side(y, direction, sonar, ping));
    let nearest = nearest(newest);
    match nearest.filter(|range| *range < y.blocked_within()) {
        Some(near) => Some(near),
        None => newest[1].map(|_| overheard(y, direction).or(nearest).unwrap_or(Meters(f64::INFINITY))),
    }
}

/// The two newest pings in the direction of a sonar now that count.
pub(crate) fn newest<Y: SonarRing>(
    y: &Y,
    direction: SonarId,
    counts: impl Fn(SonarId, &Ping) -> bool,
) -> [Option<(SonarId, &Ping)>; 2] {
    let mut newest: [Option<(SonarId, &Ping)>; 2] = [None; 2];
    for number in 0..SONARS as u8 {
        let sonar = SonarId::new(number);
        let is_there = |ping: &&Ping| looked_there(y, direction, sonar, ping) && counts(sonar, ping);
        for ping in y.pings(sonar).newest_first().filter(is_there) {
            let [first, second] = newest;
            if first.is_none_or(|(_, first)| first.at < ping.at) {
                newest = [Some((sonar, ping)), first];
            } else if second.is_none_or(|(_, second)| second.at < ping.at) {
                newest = [first, Some((sonar, ping))];
            }
        }
    }
    newest
}

/// Returns `true` if this ping of `sonar` was in the direction in which `direction` looks now, and its echo, if it had
/// one, still lies in that direction: a jamb that the robot has passed no longer does.
fn looked_there<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> bool {
    let here = y.here();
    let axis = Radians(ping.pose.theta.0 + sonar.bearing().0);
    let is_within = |angle: f64| Radians(angle - here.theta.0 - direction.bearing().0).wrapped().0.abs() <= WITHIN.0;
    let Some(range) = ping.range.filter(|_| sonar != direction) else { return is_within(axis.0) };
    let place = ping.pose.towards(axis, Meters(y.ring_radius().0 + range.0));
    is_within(axis.0) && is_within(libm::atan2(place.y.0 - here.y.0, place.x.0 - here.x.0))
}

/// Returns the angle from the direction of a sonar now to the axis of this ping of `sonar`.
pub(crate) fn off<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> Radians {
    Radians(ping.pose.theta.0 + sonar.bearing().0 - y.here().theta.0 - direction.bearing().0).wrapped()
}

/// Returns `true` if the near echo of this ping may be of a wall along the way in `direction`: the ping looked to the
/// side of that wall, and the edge of its cone reaches it. A rough wall along the way is heard so, and closes nothing.
fn is_of_side<Y: SonarRing>(y: &Y, direction: SonarId, sonar: SonarId, ping: &Ping) -> bool {
    let Some(range) = ping.range.filter(|range| *range < y.blocked_within()) else { return false };
    let (Radians(off), here) = (off(y, direction, sonar, ping), y.here());
    let side = after(direction, if off < 0.0 { 12 } else { 4 });
    let Some(wall) = nearest(newest(y, side, |_, _| true)) else { return false };
    let axis = ping.pose.theta.0 + sonar.bearing().0;
    let transducer = ping.pose.towards(Radians(axis), y.ring_radius());
    let edge = transducer.towards(Radians(axis + libm::copysign(CONE.0, off)), range);
    let (sin, cos) = libm::sincos(here.theta.0 + side.bearing().0);
    let to_side = (edge.x.0 - here.x.0) * cos + (edge.y.0 - here.y.0) * sin;
    to_side > y.ring_radius().0 + wall.0 - OF_WALL
}

/// Returns the sonar this many places counter-clockwise after another.
pub(crate) fn after(sonar: SonarId, further: usize) -> SonarId {
    SonarId::new(((sonar.number() + further) % SONARS) as u8)
}

/// Returns the minimum range of these pings; `None` if none of them heard anything.
fn nearest(pings: [Option<(SonarId, &Ping)>; 2]) -> Option<Meters> {
    let heard = pings.into_iter().flatten().filter_map(|(_, ping)| ping.range);
    heard.reduce(|one, other| if other < one { other } else { one })
}

/// Returns the range of a wall that a sonar no longer hears in its two last pings, because they missed it, strayed, or
/// look past it by now. The sonar must have heard the wall before, and both its neighbours must have heard it lately
/// and nothing further.
fn overheard<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<Meters> {
    let [new, old, before] = [0, 1, 2].map(|number| y.pings(sonar).newest_first().nth(number)?.range);
    let before = before.filter(|range| *range < y.blocked_within())?;
    if new.zip(old).is_some_and(|(new, old)| (new.0 - old.0).abs() < SAME) {
        return None;
    }
    let most = SLANT.0 * before.0 + SLANT.1;
    let hears = |further: u8| {
        let beside = SonarId::new(sonar.number() as u8 + further);
        let mut ranges = y.pings(beside).newest_first().take(2).filter_map(|ping| ping.range).peekable();
        ranges.peek().is_some() && ranges.all(|range| range.0 < most)
    };
    (hears(1) && hears(SONARS as u8 - 1)).then_some(before)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Nanos;

    const NEAR: Option<f64> = Some(1.14);
    const FAR: Option<f64> = Some(1.15);

    /// An output with these pings, oldest first, of the sonars front, left, back and right.
    fn seen(pings: [&[Option<f64>]; 4]) -> Sensed {
        let mut y = Sensed::default();
        for (sonar, ranges) in DIRECTIONS.iter().zip(pings) {
            for range in ranges {
                y.ping(*sonar, *range);
            }
        }
        y
    }

    fn fires(bits: &str, y: &Sensed) -> bool {
        let mut pattern = [false; 4];
        for (bit, digit) in pattern.iter_mut().zip(bits.chars()) {
            *bit = digit == '1';
        }
        AtIsection::new(Bits(pattern)).fired(y)
    }

    #[test]
    fn bits_are_front_left_back_right() {
        let y = seen([&[FAR; 3], &[NEAR; 3], &[None; 3], &[FAR; 3]]);
        assert!(fires("0100", &y));
        for other in ["0000", "1000", "0010", "0001", "1100", "0110", "0101"] {
            assert!(!fires(other, &y), "{other}");
        }
    }

    #[test]
    fn blocked_is_believed_at_once() {
        assert!(fires("1000", &seen([&[None, FAR, NEAR], &[FAR; 3], &[FAR; 3], &[FAR; 3]])));
    }

    #[test]
    fn free_is_believed_when_three_pings_agree() {
        let way = |pings| seen([pings, &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        assert!(!fires("0000", &way(&[NEAR, None, FAR])), "a missed echo must open nothing");
        assert!(fires("0000", &way(&[NEAR, FAR, None, FAR])));
    }

    #[test]
    fn free_is_believed_after_two_pings_where_sonars_fire_in_turn() {
        let mut y = seen([&[NEAR, None, FAR], &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        y.confirmation = 2;
        assert!(fires("0000", &y));
    }

    #[test]
    fn a_sonar_that_has_not_pinged_is_neither_blocked_nor_free() {
        let y = seen([&[], &[FAR; 3], &[FAR; 3], &[FAR; 3]]);
        assert!(!fires("0000", &y));
        assert!(!fires("1000", &y));
    }

    /// Returns whether the way to the left seems free, and whether it seems blocked, after `pings` of its sonar and the
    /// last two pings of both neighbours, `beside`, all oldest first.
    fn left(pings: [Option<f64>; 3], beside: [[Option<f64>; 2]; 2]) -> (bool, bool) {
        let mut y = in_turn([9.0; 16]);
        let [before, after] = &beside;
        for (sonar, ranges) in [(3, &before[..]), (4, &pings), (5, after)] {
            for (at, range) in (1..).zip(ranges) {
                y.ping_at(SonarId::new(sonar), *range, Nanos(at));
            }
        }
        (fires("0000", &y), fires("0100", &y))
    }

    const FREE: (bool, bool) = (true, false);
    const BLOCKED: (bool, bool) = (false, true);

    #[test]
    fn a_wall_that_is_missed_twice_is_there_while_it_is_heard_on_both_sides() {
        let missed = |beside: [f64; 2]| left([Some(0.7), None, None], beside.map(|range| [Some(range); 2]));
        assert_eq!(missed([0.74, 0.75]), BLOCKED);
        assert_eq!(missed([0.74, 0.82]), FREE, "a jamb");
        assert_eq!(missed([0.82, 0.74]), FREE, "a jamb");
    }

    #[test]
    fn a_stray_ping_and_a_missed_one_open_no_way_in_a_wall_that_is_heard_on_both_sides() {
        let wall = [[Some(0.74); 2]; 2];
        for pings in [[Some(0.7), None, Some(5.8)], [Some(0.7), Some(2.5), None], [Some(0.7), Some(1.7), Some(6.2)]] {
            assert_eq!(left(pings, wall), BLOCKED, "{pings:?}");
        }
        let one_missed = [[None, Some(0.74)], [Some(0.74), None]];
        assert_eq!(left([Some(0.7), None, Some(5.8)], one_missed), BLOCKED);
    }

    #[test]
    fn two_ranges_alike_from_beyond_an_opening_are_no_accident() {
        // The jambs of a rough wall, heard on both sides of the opening.
        let jambs = [[Some(0.84), Some(0.85)], [Some(0.89); 2]];
        assert_eq!(left([Some(0.82), Some(3.73), Some(3.74)], jambs), FREE);
        assert_eq!(left([Some(0.82), Some(2.1), Some(3.74)], jambs), BLOCKED);
    }

    #[test]
    fn what_a_sonar_beside_heard_through_an_opening_tells_its_jamb_from_a_wall() {
        let jambs = [[Some(4.0), Some(1.02)], [Some(1.02), Some(1.09)]];
        assert_eq!(left([Some(1.02), Some(3.9), Some(3.9)], jambs), FREE);
        assert_eq!(left([Some(1.02), Some(3.9), Some(3.9)], [[None; 2], [Some(1.02); 2]]), FREE);
    }

    #[test]
    fn one_ping_opens_no_way_where_sonars_fire_in_turn() {
        let mut y = Sensed { confirmation: 2, ..Sensed::default() };
        for number in (0..16).filter(|number| !(3..=5).contains(number)) {
            y.ping(SonarId::new(number), None);
            y.ping(SonarId::new(number), None);
        }
        y.ping(SonarId::new(4), None);
        assert!(!fires("0000", &y) && !fires("0100", &y));
        y.ping(SonarId::new(4), None);
        assert!(fires("0000", &y));
    }

    #[test]
    fn what_was_passed_since_another_sonar_heard_it_is_not_there_any_more() {
        let mut y = in_turn([9.0; 16]);
        y.ping_at(SonarId::new(5), Some(0.58), Nanos(1));
        y.pose.theta = Radians::from_degrees(10.0);
        assert!(fires("0100", &y) && !fires("0000", &y), "22.5 degrees behind, and the robot has turned to it");
        y.pose.x = Meters(0.2);
        assert!(fires("0000", &y) && !fires("0100", &y));
    }

    /// A robot whose sonars fire in turn, with these ranges heard twice by the sonars from the front on.
    fn in_turn(ranges: [f64; 16]) -> Sensed {
        let mut y = Sensed { confirmation: 2, ..Sensed::default() };
        for _ in 0..2 {
            for (number, range) in (0..).zip(ranges) {
                y.ping(SonarId::new(number), (range < 6.0).then_some(range));
            }
        }
        y
    }

    #[test]
    fn the_edge_of_a_way_between_rough_walls_is_no_wall() {
        let mut ranges = [9.0; 16];
        ranges[3..=5].copy_from_slice(&[0.57, 0.55, 0.57]);
        // The edge, and the walls that run off from there.
        ranges[13..=15].copy_from_slice(&[1.07, 0.87, 1.07]);
        assert!(fires("0100", &in_turn(ranges)));
        ranges[13..=15].copy_from_slice(&[0.9, 0.87, 0.9]);
        assert!(!fires("0100", &in_turn(ranges)), "a wall");
    }

    #[test]
    fn a_rough_wall_along_the_way_closes_nothing() {
        let mut y = in_turn([9.0; 16]);
        // A wall 0.47 m to the right of the centre, heard ahead while the robot had turned 11 degrees towards it.
        y.ping_at(SonarId::new(12), Some(0.28), Nanos(1));
        y.pose.theta = Radians::from_degrees(-11.0);
        y.ping_at(SonarId::new(0), Some(1.04), Nanos(2));
        y.pose.theta = Radians(0.0);
        assert!(fires("0001", &y) && !fires("1001", &y));
        // Without that wall the same echo is of an obstacle ahead.
        let mut open = in_turn([9.0; 16]);
        open.pose.theta = Radians::from_degrees(-11.0);
        open.ping_at(SonarId::new(0), Some(1.04), Nanos(2));
        open.pose.theta = Radians(0.0);
        assert!(fires("1000", &open) && !fires("0000", &open));
    }

    #[test]
    fn a_corner_is_no_wall_that_stands_askew() {
        let mut ranges = [9.0; 16];
        // Walls in front and to the right; between them the corner, further than both.
        (ranges[0], ranges[15], ranges[14], ranges[13], ranges[12]) = (0.55, 0.57, 0.6, 0.57, 0.55);
        assert!(fires("1001", &in_turn(ranges)));
    }

    #[test]
    fn a_robot_that_turns_goes_by_where_each_sonar_looked() {
        let mut y = in_turn({
            let mut ranges = [9.0; 16];
            ranges[4] = 0.5;
            ranges
        });
        assert!(fires("0100", &y));
        // A quarter turn on, what was on the left is ahead.
        y.pose.theta = Radians::from_degrees(90.0);
        assert!(fires("1000", &y) && !fires("0100", &y));
    }
}
