//! Drives a rectangle away from a wall that is so near to its side that the sonars cannot measure the distance. If the
//! robot turned on the spot, a rear corner would swing into the wall.

use mdle_runtime::{Meters, MetersPerSecond, RadiansPerSecond, SonarId, Twist};

/// Distance, in metres, over which a robot whose law has just begun drives away from a wall. Later, earlier ranges show
/// how near the wall is.
const DEPARTS: f64 = 1.5;
/// Maximum speed, in m/s.
const FASTEST: f64 = 0.12;
/// Curvature of the arc, in radians per metre. On this arc, the rear corners of an ATRV-mini swing out by 1.6 cm.
const CURVATURE: f64 = 0.35;
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

    /// Returns the input of a robot beside a wall, `driven` metres after its law began; `None` if there is no wall
    /// beside it, or an obstacle ahead.
    pub(crate) fn departs(self, driven: f64, speed: MetersPerSecond) -> Option<Twist> {
        let curvature = match (self.left, self.right) {
            _ if driven >= DEPARTS || self.ahead => return None,
            (false, false) => return None,
            (true, true) => 0.0,
            (true, false) => -CURVATURE,
            (false, true) => CURVATURE,
        };
        let v = speed.0.min(FASTEST);
        Some(Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(curvature * v) })
    }
}
