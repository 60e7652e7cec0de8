//! Where a plan is to leave the robot: a zone of the floor, and perhaps a heading.

use mdle_runtime::{Pose, Radians};

use crate::world::Place;

/// A zone along the axes of the floor, edges included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Its least coordinates.
    pub min: Place,
    /// Its greatest.
    pub max: Place,
    /// A heading and by how much, to either side, it may be missed.
    pub heading: Option<(Radians, Radians)>,
}

impl Goal {
    /// Whether a robot whose centre is at `pose` has arrived.
    #[must_use]
    pub fn holds(&self, pose: &Pose) -> bool {
        let Place { x, y } = Place::of(pose);
        let inside = (self.min.x..=self.max.x).contains(&x) && (self.min.y..=self.max.y).contains(&y);
        inside
            && self.heading.is_none_or(|(heading, most)| Radians(pose.theta.0 - heading.0).wrapped().0.abs() <= most.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::World;
    use mdle_runtime::Meters;

    #[test]
    fn the_office_is_reached_at_its_door_and_looking_through_it() {
        let goal = World::office().expect("our own floor").goal.expect("a goal");
        let holds =
            |x, y, degrees| goal.holds(&Pose { x: Meters(x), y: Meters(y), theta: Radians::from_degrees(degrees) });
        assert!(holds(11.28, -0.01, 271.0) && holds(11.28, -0.01, -89.0) && holds(11.05, 0.9, -104.9));
        assert!(!holds(11.28, -0.01, 250.0) && !holds(11.28, -0.01, 286.0) && !holds(11.28, -0.01, 90.0));
        assert!(!holds(11.0, -0.01, 270.0) && !holds(11.28, -0.95, 270.0) && !holds(f64::NAN, 0.0, 270.0));
    }
}
