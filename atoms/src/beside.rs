//! Drives a rectangle away from a wall that is so near to its side that the sonars cannot measure the distance. If the
//! robot turned on the spot, a rear corner would swing into the wall.

use core::f64::consts::FRAC_PI_2;

use mdle_runtime::{Meters, MetersPerSecond, Radians, RadiansPerSecond, SonarId, Twist};

/// Distance, in metres, over which a robot whose law has just begun drives away from a wall. Later, earlier ranges show
/// how near the wall is.
const DEPARTS: f64 = 1.5;
/// Maximum speed, in m/s.
const FASTEST: f64 = 0.12;
/// Curvature of the arc, in radians per metre. On this arc, the rear corners of an ATRV-mini swing out by 1.6 cm.
const CURVATURE: f64 = 0.35;
/// Angle, in radians, by which the robot may be askew to the wall. With a larger angle, the arc would lead into the
/// wall.
const ASKEW: f64 = 0.1;
/// Angle, in radians, by which the robot may have turned further than on the arc: it turns to its goal until its sonars
/// have heard the wall.
const TURNS: f64 = 0.25;
/// Free length ahead, in metres, that the arc needs.
const NEEDS: f64 = 0.4;

/// The sides of the body at which an obstacle is near.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Beside {
    left: bool,
    right: bool,
    ahead: bool,
}

impl Beside {
    /// Adds the echo of a sonar. To the sides of the body, an obstacle is near if its range is below `saturates`.
    pub(crate) fn take(&mut self, sonar: SonarId, Meters(range): Meters, saturates: f64) {
        match sonar.number() {
            15 | 0 | 1 => self.ahead |= range < NEEDS,
            3..=6 => self.left |= range < saturates,
            10..=13 => self.right |= range < saturates,
            _ => {}
        }
    }

    /// Returns `true` if a robot with this heading in its frame drives along walls. A frame is assumed to be parallel
    /// to the walls.
    pub(crate) fn is_along_walls(heading: Radians) -> bool {
        let quarters = heading.0 / FRAC_PI_2;
        (quarters - libm::round(quarters)).abs() * FRAC_PI_2 <= ASKEW
    }

    /// Returns `true` if a robot that has driven `driven` metres and turned by `turned` may still be on the arc.
    pub(crate) fn is_on_arc(driven: f64, turned: Radians) -> bool {
        driven < DEPARTS && turned.0.abs() <= CURVATURE * driven + TURNS
    }

    /// Returns the input of a robot beside a wall; `None` if there is no wall beside it, or an obstacle ahead.
    pub(crate) fn departs(self, speed: MetersPerSecond) -> Option<Twist> {
        let curvature = match (self.left, self.right) {
            _ if self.ahead => return None,
            (false, false) => return None,
            (true, true) => 0.0,
            (true, false) => -CURVATURE,
            (false, true) => CURVATURE,
        };
        let v = speed.0.min(FASTEST);
        Some(Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(curvature * v) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arc_ends_after_its_length_or_a_turn() {
        assert!([(0.0, -0.2), (1.0, 0.55), (1.4, -0.7)].iter().all(|(way, turned)| is_on_arc(*way, *turned)));
        assert!(![(0.0, -0.3), (1.0, 0.65), (1.6, 0.0)].iter().any(|(way, turned)| is_on_arc(*way, *turned)));
    }

    fn is_on_arc(driven: f64, turned: f64) -> bool {
        Beside::is_on_arc(driven, Radians(turned))
    }
}
