//! Detects that a robot whose sonars fire in turn is not aligned with the walls: a wall faces it in a direction between
//! the front, the left, the back and the right.

use mdle_runtime::capability::SonarRing;
use mdle_runtime::{Meters, Nanos, Ping, Radians, SONARS, SonarId};

use crate::directions::{CONE, DIRECTIONS, after, newest, off, towards};

/// Maximum range of a wall that faces the robot in a diagonal direction, as a multiple of the range below which a
/// direction is blocked.
const ALSO_FACES: f64 = 1.5;
/// Difference, in metres, below which ranges are treated as equal.
const ALIKE: f64 = 0.06;
/// Minimum angle between a diagonal direction and a ping at which the ping can show that a wall, and not an edge, faces
/// the robot in this direction.
const BESIDE: Radians = Radians::from_degrees(16.0);
/// Maximum distance, in metres, between an echo and the line of a wall that faces the robot in a diagonal direction. At
/// the edge of a passage, the echoes of the rough walls that lead away from the edge are beyond this line by more than
/// that.
const OF_LINE: f64 = 0.04;

/// Directions of the normals of the smooth walls to search for, in degrees counter-clockwise from one of the four
/// directions.
const SMOOTH_AT: [f64; 7] = [26.0, 31.0, 38.0, 45.0, 52.0, 59.0, 64.0];
/// Angle from the normal of a smooth wall up to which the wall returns an echo.
const WIDTH: Radians = Radians::from_degrees(31.0);
/// Angle from the normal of a wall up to which a range is treated as the distance of the wall.
const MIDDLE: Radians = Radians::from_degrees(14.0);
/// Range of angles from the normal of a smooth wall at which the wall returns no echo.
const BEYOND: [Radians; 2] = [Radians::from_degrees(44.0), Radians::from_degrees(66.0)];
/// Age from which a ping is no longer considered for a smooth wall.
const LATELY: Nanos = Nanos(2_200_000_000);
/// Minimum number of pings with an echo of the wall for each ping that has missed the wall or measured a wrong range.
const FEW: usize = 3;

/// Returns `true` if a wall faces the robot between two of the four directions.
pub(crate) fn is_askew<Y: SonarRing>(y: &Y) -> bool {
    DIRECTIONS.iter().any(|direction| {
        let is_smooth_at = |degrees: &f64| is_smooth_wall(y, after_by(*direction, *degrees));
        faces_between(y, *direction) || SMOOTH_AT.iter().any(is_smooth_at)
    })
}

/// Returns the bearing this many degrees counter-clockwise after a direction.
fn after_by(direction: SonarId, degrees: f64) -> Radians {
    Radians(direction.bearing().0 + Radians::from_degrees(degrees).0)
}

/// Returns `true` if a wall faces the robot in the diagonal direction that is counter-clockwise after `direction`. This
/// requires that there are near echoes in this direction and on both sides of it, that those on the sides are not
/// nearer, and that the echoes come neither from an edge nor from a corner between two walls. An edge returns echoes in
/// only one or two directions.
fn faces_between<Y: SonarRing>(y: &Y, direction: SonarId) -> bool {
    let near = |further: usize| towards(y, after(direction, further)).filter(|range| is_near(y, *range));
    let (Some(before), Some(diagonal), Some(behind)) = (near(1), near(2), near(3)) else { return false };
    let in_a_corner = [near(0), near(4)].iter().all(|wall| wall.is_some_and(|wall| wall < diagonal));
    let is_edge = |further: usize| runs_off(y, after(direction, 2), diagonal, after(direction, further));
    !in_a_corner && diagonal.0 <= before.0.min(behind.0) + ALIKE && !is_edge(1) && !is_edge(3)
}

fn is_near<Y: SonarRing>(y: &Y, range: Meters) -> bool {
    range.0 < ALSO_FACES * y.blocked_within().0
}

/// Returns `true` if the two newest pings in the direction of `beside` show only objects that are further away than a
/// straight wall at this range that faces the robot in the direction `diagonal`.
fn runs_off<Y: SonarRing>(y: &Y, diagonal: SonarId, range: Meters, beside: SonarId) -> bool {
    let ring = y.ring_radius().0;
    let angle = |sonar: SonarId, ping: &Ping| off(y, diagonal, sonar, ping).0.abs();
    let pings: [_; 2] = newest(y, beside, |sonar, ping| ping.range.is_some() && angle(sonar, ping) > BESIDE.0);
    let is_beyond = |(sonar, ping): (SonarId, &Ping)| {
        let line = (range.0 + ring) / libm::cos(angle(sonar, ping)) - ring;
        ping.range.is_some_and(|heard| heard.0 > line + OF_LINE)
    };
    pings[1].is_some() && pings.into_iter().flatten().all(is_beyond)
}

/// A ping relative to the normal of a wall.
struct Look {
    /// Angle between the ping's axis and the normal.
    off: Radians,
    /// Distance, in metres, by which the robot was nearer to the wall at the time of the ping than it is now.
    nearer: f64,
    range: Option<Meters>,
}

/// Returns `true` if the last pings show a smooth wall whose normal has this bearing. Within `WIDTH` of the normal, all
/// pings but a few must have the range of a straight wall, on either side and in the middle. Between the angles
/// `BEYOND`, where a rough wall would also return an echo, no ping may have a near echo. An edge returns echoes only
/// within half of `WIDTH`.
fn is_smooth_wall<Y: SonarRing>(y: &Y, bearing: Radians) -> bool {
    let ring = y.ring_radius().0;
    let looks = || looks(y, bearing);
    let is_beyond = |look: &Look| look.off.0.abs() > BEYOND[0].0 && look.range.is_some_and(|range| is_near(y, range));
    if looks().any(|look| is_beyond(&look)) {
        return false;
    }
    let in_the_middle = looks().filter(|look| look.off.0.abs() <= MIDDLE.0);
    let distances = in_the_middle.filter_map(|look| Some(look.range?.0 + ring + look.nearer));
    let distance = distances.fold(f64::INFINITY, f64::min);
    if !is_near(y, Meters(distance - ring)) {
        return false;
    }
    let (mut heard, mut others) = ([0_usize; 3], 0);
    for Look { off: Radians(off), nearer, range } in looks().filter(|look| look.off.0.abs() <= WIDTH.0) {
        let slant = (off.abs() - CONE.0).max(0.0);
        let (least, most) = (distance - nearer - ring, (distance - nearer) / libm::cos(slant) - ring);
        let of_wall = range.is_some_and(|range| least - ALIKE < range.0 && range.0 < most + ALIKE);
        let [right, middle, left] = &mut heard;
        *match (of_wall, off.abs() <= MIDDLE.0, off < 0.0) {
            (false, ..) => &mut others,
            (true, true, _) => middle,
            (true, false, true) => right,
            (true, false, false) => left,
        } += 1;
    }
    heard.iter().all(|count| *count > 0) && others * FEW <= heard.iter().sum()
}

/// Returns the last pings within `BEYOND` of this bearing.
fn looks<Y: SonarRing>(y: &Y, bearing: Radians) -> impl Iterator<Item = Look> {
    let (here, now) = (y.here(), y.now());
    let normal = here.theta.0 + bearing.0;
    let (sin, cos) = libm::sincos(normal);
    let pings = (0..SONARS as u8)
        .map(SonarId::new)
        .flat_map(|sonar| y.pings(sonar).newest_first().map(move |ping| (sonar.bearing(), ping)));
    pings.filter(move |(_, ping)| now.since(ping.at) < LATELY).filter_map(move |(axis, ping)| {
        let off = Radians(ping.pose.theta.0 + axis.0 - normal).wrapped();
        let nearer = (ping.pose.x.0 - here.x.0) * cos + (ping.pose.y.0 - here.y.0) * sin;
        (off.0.abs() <= BEYOND[1].0).then_some(Look { off, nearer, range: ping.range })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

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
    fn a_wall_that_faces_a_diagonal_is_askew() {
        let mut ranges = [9.0; 16];
        ranges[3..=5].copy_from_slice(&[0.55, 0.53, 0.55]);
        assert!(!is_askew(&in_turn(ranges)), "a wall on the left");
        ranges[3..=5].copy_from_slice(&[9.0, 0.55, 0.53]);
        ranges[6..=7].copy_from_slice(&[0.53, 0.55]);
        assert!(is_askew(&in_turn(ranges)), "a wall that faces the diagonal behind the left");
    }

    #[test]
    fn a_wall_is_one_line_for_pings_at_any_angle() {
        let mut y = in_turn([9.0; 16]);
        // A wall 1.16 m off that faces the diagonal behind the right, heard by sonars while the robot turned.
        for (sonar, turned, range) in [(9, 0.0, 0.99), (10, 0.0, 0.97), (12, -10.0, 1.12)] {
            y.pose.theta = Radians::from_degrees(turned);
            y.ping_at(SonarId::new(sonar), Some(range), Nanos(1));
            y.ping_at(SonarId::new(sonar), Some(range), Nanos(2));
        }
        y.pose.theta = Radians(0.0);
        assert!(faces_between(&y, SonarId::new(8)));
        y.ping_at(SonarId::new(9), Some(1.35), Nanos(3));
        y.ping_at(SonarId::new(9), Some(1.35), Nanos(4));
        assert!(!faces_between(&y, SonarId::new(8)), "an edge");
    }

    /// Returns the output of a robot that has turned by 16 degrees beside a smooth wall 1.1 m away. The wall is now at
    /// this bearing, in degrees, and returned echoes before and after the turn within `width` degrees of its normal.
    fn beside_a_smooth_wall(bearing: f64, width: f64) -> Sensed {
        let mut y = Sensed { confirmation: 2, ..Sensed::default() };
        for turned in [-16.0, -8.0, 0.0] {
            y.pose.theta = Radians::from_degrees(turned);
            for sonar in (0..16).map(SonarId::new) {
                let off = Radians::from_degrees(turned + sonar.bearing().degrees() - bearing).wrapped().degrees();
                y.ping(sonar, (off.abs() < width).then_some(0.91));
            }
        }
        y
    }

    #[test]
    fn a_smooth_wall_a_third_off_a_direction_is_askew() {
        for bearing in [-150.0, 28.0, 45.0, 62.0, 120.0] {
            assert!(is_askew(&beside_a_smooth_wall(bearing, 40.0)), "{bearing}");
            assert!(!is_askew(&beside_a_smooth_wall(bearing, 12.5)), "an edge at {bearing}");
        }
        for bearing in [-90.0, -8.0, 10.0, 180.0] {
            assert!(!is_askew(&beside_a_smooth_wall(bearing, 40.0)), "{bearing}");
        }
    }
}
