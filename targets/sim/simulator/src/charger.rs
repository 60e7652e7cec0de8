//! A charger: the pose of a robot on the charger, and the tolerance of this pose.

use mdle_runtime::{Meters, Pose, Radians};

use crate::point::Point;

/// Maximum error of the heading, to either side, of a robot on its charger.
const HEADING: Radians = Radians::from_degrees(15.0);

/// A charger on the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Charger {
    /// Pose of a robot on the charger: its centre, in metres, and its heading.
    pub pose: Pose,
    /// Maximum distance of the robot's centre from this pose, in metres; above 0.
    pub reach: f64,
}

impl Charger {
    /// Returns `true` if a robot at `pose` is on the charger. The robot must be within the reach of the charger, and
    /// its heading must deviate by at most 15 degrees.
    #[must_use]
    pub fn holds(&self, pose: &Pose) -> bool {
        let off = Radians(pose.theta.0 - self.pose.theta.0).wrapped();
        pose.distance(&self.pose).0 <= self.reach && off.0.abs() <= HEADING.0
    }

    /// Returns points on the circle within which the centre of a robot on the charger has to be.
    pub fn circle(&self) -> impl Iterator<Item = Point> {
        let at = self.pose;
        let reach = Meters(self.reach);
        (0..=24).map(move |corner| Point::of(&at.towards(Radians::from_degrees(f64::from(corner) * 15.0), reach)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_robot_is_on_its_charger_within_reach_and_heading() {
        let pose = |x, degrees| Pose { x: Meters(x), y: Meters(2.0), theta: Radians::from_degrees(degrees) };
        let charger = Charger { pose: pose(1.0, 180.0), reach: 0.1 };
        assert!(charger.holds(&pose(1.0, 180.0)) && charger.holds(&pose(1.09, -166.0)));
        assert!(
            !charger.holds(&pose(1.11, 180.0)) && !charger.holds(&pose(1.0, 164.0)) && !charger.holds(&pose(1.0, 0.0))
        );
    }
}
