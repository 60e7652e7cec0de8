//! Dead reckoning: computes the position of the robot on the floor by odometry, in order to distinguish landmarks
//! without maps (docs/src/navigation.md).

use mdle_runtime::{Meters, Pose, Printable, Radians};

/// The position of a landmark on the floor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LandmarkPlace {
    /// Name of the landmark.
    pub(crate) name: String,
    /// Position on the floor; the axes are parallel to the axes of the first landmark of the route.
    pub(crate) at: (Meters, Meters),
}

/// The last landmark at which the robot was, and the pose by odometry that the robot had there.
#[derive(Debug)]
pub(super) struct Reckoning<'p> {
    places: &'p [LandmarkPlace],
    /// Position of the last landmark, and the robot's pose there by odometry; `None` if the position is not known.
    last: Option<((Meters, Meters), Pose)>,
}

impl<'p> Reckoning<'p> {
    /// Creates the reckoning of a robot that has not been at any of these landmarks yet.
    pub(super) fn new(places: &'p [LandmarkPlace]) -> Self {
        Self { places, last: None }
    }

    /// Records that the robot is at a landmark; `here` is the robot's pose by odometry.
    pub(super) fn is_at(&mut self, landmark: &str, here: Pose) {
        self.last = self.place(landmark).map(|place| (place.at, here));
    }

    /// Checks that no landmark is nearer to the robot than the expected one. `drift` is the drift of the odometry
    /// heading. Checks nothing if the position of the expected landmark or of the last landmark is unknown.
    ///
    /// # Errors
    /// Fails with a message that names the landmark at which the robot is.
    pub(super) fn check(&self, expected: &str, here: Pose, drift: Radians) -> Result<(), String> {
        let (Some((last, before)), Some(place)) = (self.last, self.place(expected)) else { return Ok(()) };
        let (sin, cos) = libm::sincos(drift.0);
        let (dx, dy) = (here.x.0 - before.x.0, here.y.0 - before.y.0);
        let (x, y) = (last.0.0 + dx * cos + dy * sin, last.1.0 - dx * sin + dy * cos);
        let off = |place: &LandmarkPlace| libm::hypot(place.at.0.0 - x, place.at.1.0 - y);
        let nearest = self.places.iter().fold(place, |best, other| if off(other) < off(best) { other } else { best });
        if nearest == place {
            return Ok(());
        }
        let (there, expected) = (Printable(&nearest.name), Printable(expected));
        let ways = format!("{:.2} m from its place, and {:.2} m from that of {expected}", off(nearest), off(place));
        Err(format!("the robot is at {there} and not at {expected}, by odometry: {ways}"))
    }

    fn place(&self, landmark: &str) -> Option<&'p LandmarkPlace> {
        self.places.iter().find(|place| place.name == landmark)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: Radians = Radians(0.0);

    fn places() -> Vec<LandmarkPlace> {
        let place = |(name, x, y): (&str, f64, f64)| LandmarkPlace { name: name.into(), at: (Meters(x), Meters(y)) };
        [("a", 1.0, 0.0), ("b", 1.0, 4.0), ("c", 9.0, 0.0)].map(place).to_vec()
    }

    fn at(x: f64, y: f64) -> Pose {
        Pose { x: Meters(x), y: Meters(y), theta: Radians(0.0) }
    }

    #[test]
    fn the_nearest_landmark_is_where_the_robot_is() {
        let places = places();
        let mut reckoning = Reckoning::new(&places);
        reckoning.is_at("a", at(0.0, 0.0));
        assert_eq!(reckoning.check("b", at(0.0, 2.1), LEVEL), Ok(()));
        let sentence = reckoning.check("b", at(0.0, 1.9), LEVEL).unwrap_err();
        assert_eq!(
            sentence,
            "the robot is at a and not at b, by odometry: 1.90 m from its place, and 2.10 m from that of b"
        );
        assert!(reckoning.check("b", at(7.0, 2.0), LEVEL).unwrap_err().starts_with("the robot is at c and not at b"));
        assert_eq!(reckoning.check("b", at(0.0, 2.0), LEVEL), Ok(()), "half-way the robot is believed");
    }

    #[test]
    fn each_landmark_sets_the_place_anew() {
        let places = places();
        let mut reckoning = Reckoning::new(&places);
        // Odometry is three metres off.
        reckoning.is_at("b", at(0.0, 7.0));
        assert_eq!(reckoning.check("a", at(0.0, 3.0), LEVEL), Ok(()));
        assert!(reckoning.check("a", at(0.0, 6.0), LEVEL).is_err());
    }

    #[test]
    fn odometry_that_has_turned_is_turned_back() {
        let places = places();
        let mut reckoning = Reckoning::new(&places);
        reckoning.is_at("a", at(0.0, 0.0));
        // Four metres along the second axis, which odometry has turned by a right angle.
        assert_eq!(reckoning.check("b", at(-4.0, 0.0), Radians::from_degrees(90.0)), Ok(()));
        assert!(reckoning.check("b", at(4.0, 0.0), Radians::from_degrees(90.0)).is_err());
    }

    #[test]
    fn without_places_a_robot_is_believed() {
        let places = places();
        let mut reckoning = Reckoning::new(&places);
        assert_eq!(reckoning.check("b", at(0.0, 0.0), LEVEL), Ok(()), "the robot has not been anywhere");
        reckoning.is_at("elsewhere", at(0.0, 0.0));
        assert_eq!(reckoning.check("b", at(0.0, 0.0), LEVEL), Ok(()));
        reckoning.is_at("a", at(0.0, 0.0));
        assert_eq!(reckoning.check("elsewhere", at(0.0, 0.0), LEVEL), Ok(()));
    }
}
