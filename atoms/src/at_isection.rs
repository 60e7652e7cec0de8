//! `atIsection b`: fires when the directions front, left, back and right are blocked or free, as the bits of `b`
//! require (paper, section IV-A).

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Bits, Interrupt, SonarId};

use crate::askew::is_askew;
use crate::directions::{DIRECTIONS, towards};
use crate::gains::fire_in_turn;

/// The interrupt `atIsection`, which fires while all four directions match the bits: 1 for a near obstacle, 0 for a
/// free direction.
///
/// On a robot whose sonars fire in turn, as on real robots, the interrupt also requires that walls face the robot in
/// the four directions and not between them. A wall returns echoes only to the sonars that it faces, so a robot whose
/// heading is between two directions of the walls receives no echo, and a blocked direction seems free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AtIsection {
    pattern: Bits<4>,
}

impl AtIsection {
    /// Creates the quark `atIsection pattern`, with the bits front, left, back, right.
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

/// Returns `Some(true)` if `sonar` itself receives the echo of a near obstacle, and `Some(false)` if its direction is
/// free; `None` before its first ping.
///
/// The smallest of the last ranges decides: one near echo blocks the direction, and the direction is free again only
/// when all last pings agree, so that a missed echo does not make it free. Only the sonar in that direction is
/// considered, because its neighbours receive echoes of the walls along a corridor.
fn blocked<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<bool> {
    let pings = y.pings(sonar);
    pings.newest_first().next()?;
    Some(pings.nearest(y.confirmation()).is_some_and(|range| range < y.blocked_within()))
}

/// Returns `Some(true)` if an obstacle is near in the direction of `sonar`, and `Some(false)` if the direction is free,
/// on a robot whose sonars fire in turn; `None` after too few pings. Considers all pings that any sonar has made in
/// that direction of the room, because the last pings of a single sonar of a turning robot were in other directions.
fn blocked_in_turn<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<bool> {
    let near = towards(y, sonar)?;
    Some(near < y.blocked_within())
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Meters, Radians};

    use super::*;
    use crate::trial::Sensed;
    use mdle_runtime::Nanos;

    const NEAR: Option<f64> = Some(1.14);
    const FAR: Option<f64> = Some(1.15);

    /// Returns an output with these pings, oldest first, of the sonars front, left, back and right.
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

    /// Returns two verdicts after the `pings` of the left sonar and the last two pings of both neighbours, `beside`,
    /// all oldest first: `true` if the left seems free, and `true` if it seems blocked.
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

    /// Returns the verdicts on the direction ahead after the three `pings` of the front sonar, oldest first.
    fn ahead(pings: [f64; 3]) -> (bool, bool) {
        let mut y = in_turn([9.0; 16]);
        pings.into_iter().for_each(|range| y.ping(SonarId::new(0), Some(range)));
        (fires("0000", &y), fires("1000", &y))
    }

    #[test]
    fn a_near_echo_ahead_is_believed_when_the_next_one_agrees() {
        const UNDECIDED: (bool, bool) = (false, false);
        assert_eq!([ahead([3.7, 3.66, 0.37]), ahead([3.7, 0.37, 3.62])], [UNDECIDED; 2]);
        assert_eq!([ahead([3.7, 0.37, 0.35]), ahead([0.37, 3.66, 3.62])], [BLOCKED, FREE]);
        assert_eq!(ahead([1.3, 1.2, 1.1]), BLOCKED, "a wall that comes nearer");
        let left = left([Some(3.7), Some(3.66), Some(0.57)], [[None; 2]; 2]);
        assert_eq!(left, BLOCKED, "a wall that begins beside the robot");
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

    /// Returns the output of a robot whose sonars fire in turn, in which each sonar has measured its range twice. The
    /// first range is that of the front sonar.
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

    /// Returns two verdicts for a robot that turns fast by 73° beside a wall: that nothing is near behind the robot,
    /// and that something is near behind it. The wall is behind the robot, but its sonars 10 and 9 miss the wall; sonar
    /// 9 pings `later` nanoseconds after sonar 10.
    fn behind_a_robot_that_turns(later: u64) -> (bool, bool) {
        let mut ranges = [9.0; 16];
        ranges[11] = 0.762;
        let mut y = in_turn(ranges);
        let at = Nanos(1_740_000_000);
        for (sonar, turned, range, at) in [(10, 36.7, 3.05, at), (9, 41.0, 1.75, Nanos(at.0 + later))] {
            y.pose.theta = Radians::from_degrees(turned);
            y.ping_at(SonarId::new(sonar), Some(range), at);
        }
        y.pose.theta = Radians::from_degrees(73.0);
        (fires("0000", &y), fires("0010", &y))
    }

    #[test]
    fn two_sonars_that_pass_a_direction_in_one_ring_do_not_free_it() {
        assert_eq!(behind_a_robot_that_turns(60_000_000), BLOCKED);
        assert_eq!(behind_a_robot_that_turns(960_000_000), FREE);
    }

    #[test]
    fn a_robot_that_turns_goes_by_where_each_sonar_looked() {
        let mut y = in_turn({
            let mut ranges = [9.0; 16];
            ranges[4] = 0.5;
            ranges
        });
        assert!(fires("0100", &y));
        // After a quarter turn, the obstacle that was on the left is ahead.
        y.pose.theta = Radians::from_degrees(90.0);
        assert!(fires("1000", &y) && !fires("0100", &y));
    }
}
