//! The goal of a run: a zone of the floor and, optionally, a heading.

use mdle_quantity::Quantity;
use mdle_runtime::{Pose, Radians};

use crate::point::Point;

/// Maximum coordinate and maximum radius, in metres, as in a world file.
const FURTHEST: f64 = 1e6;
/// Number of dots on the edge of a circle on a map.
const DOTS: u16 = 72;

/// Zone of the floor in which a run has to end and, optionally, the heading that the robot must have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Zone in which the robot's centre must be.
    pub zone: Zone,
    /// Required heading, and its tolerance to either side; `None` if any heading is accepted.
    pub heading: Option<(Radians, Radians)>,
}

/// Form of a goal. Its edges belong to the goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Zone {
    /// A rectangle whose sides are parallel to the axes of the floor.
    Rectangle {
        /// Minimum coordinates.
        min: Point,
        /// Maximum coordinates.
        max: Point,
    },
    /// A circle.
    Circle {
        /// Centre of the circle.
        center: Point,
        /// Radius, in metres; above 0.
        radius: f64,
    },
}

impl Goal {
    /// Parses `x,y,radius` or `x,y,radius,heading,tolerance`.
    ///
    /// # Errors
    /// Fails if the text has another form. The message says what to type instead.
    pub fn read(text: &str) -> Result<Self, String> {
        let sentence = "expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in \
                        `7,3,0.5` or `7,3,50cm,90,15`";
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let length = |text| Quantity::Length.read(text, "m");
        let angle = |text| Quantity::Angle.read(text, "deg");
        let (x, y, radius, heading) = match *parts {
            [x, y, radius] => (length(x)?, length(y)?, length(radius)?, None),
            [x, y, radius, heading, tolerance] => {
                (length(x)?, length(y)?, length(radius)?, Some((angle(heading)?, angle(tolerance)?)))
            }
            _ => return Err(sentence.to_owned()),
        };
        if [x, y].iter().any(|value| value.abs() > FURTHEST) || radius <= 0.0 || radius > FURTHEST {
            return Err(format!("x and y are at most {FURTHEST} m, and the radius is above 0 and at most that"));
        }
        if heading.is_some_and(|(_, tolerance)| !(0.0..=180.0).contains(&tolerance)) {
            return Err("a tolerance is from 0 to 180 degrees".to_owned());
        }
        let heading = heading
            .map(|(heading, tolerance)| (Radians::from_degrees(heading).wrapped(), Radians::from_degrees(tolerance)));
        Ok(Self { zone: Zone::Circle { center: Point { x, y }, radius }, heading })
    }

    /// Returns `true` if a robot whose centre is at `pose` has arrived.
    #[must_use]
    pub fn holds(&self, pose: &Pose) -> bool {
        let Point { x, y } = Point::of(pose);
        let inside = match self.zone {
            Zone::Rectangle { min, max } => (min.x..=max.x).contains(&x) && (min.y..=max.y).contains(&y),
            Zone::Circle { center, radius } => libm::hypot(x - center.x, y - center.y) <= radius,
        };
        inside
            && self.heading.is_none_or(|(heading, most)| Radians(pose.theta.0 - heading.0).wrapped().0.abs() <= most.0)
    }
}

impl Zone {
    /// Returns the corners with the minimum and the maximum coordinates.
    #[must_use]
    pub fn corners(&self) -> [Point; 2] {
        match *self {
            Self::Rectangle { min, max } => [min, max],
            Self::Circle { center: Point { x, y }, radius } => {
                [Point { x: x - radius, y: y - radius }, Point { x: x + radius, y: y + radius }]
            }
        }
    }
}

/// Returns evenly spaced points on a circle.
pub fn edge(center: Point, radius: f64) -> impl Iterator<Item = Point> {
    (0..DOTS).map(move |dot| {
        let bearing = Radians::from_degrees(f64::from(dot) * (360.0 / f64::from(DOTS))).0;
        Point { x: center.x + radius * libm::cos(bearing), y: center.y + radius * libm::sin(bearing) }
    })
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

    #[test]
    fn a_goal_is_a_circle_and_perhaps_a_heading() {
        let pose = |x, degrees| Pose { x: Meters(x), y: Meters(3.0), theta: Radians::from_degrees(degrees) };
        let circle = Goal::read("7, 3, 50cm").expect("a goal");
        assert!(circle.holds(&pose(7.5, 0.0)) && circle.holds(&pose(6.5, 123.0)) && !circle.holds(&pose(7.51, 0.0)));
        let turned = Goal::read("7,3,0.5,-90deg,15").expect("a goal");
        assert!(
            turned.holds(&pose(7.0, 270.0)) && turned.holds(&pose(7.0, -104.9)) && !turned.holds(&pose(7.0, 250.0))
        );
        assert_eq!(Goal::read("-7m,3,5e-1,270,15"), Goal::read("-700cm,300cm,0.5m,270deg,15deg"));
    }

    #[test]
    fn a_goal_that_is_none_is_refused() {
        let texts =
            ["", "7,3", "7,3,1,90", "7,3,1,90,5,6", "7,3,0", "7,3,-1", "7,3,1,90,181", "7,3,1s", "1e7,0,1", "here"];
        let refused = texts.map(|text| Goal::read(text).expect_err(text));
        insta::assert_snapshot!(refused.join("\n"), @"
        expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in `7,3,0.5` or `7,3,50cm,90,15`
        expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in `7,3,0.5` or `7,3,50cm,90,15`
        expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in `7,3,0.5` or `7,3,50cm,90,15`
        expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in `7,3,0.5` or `7,3,50cm,90,15`
        x and y are at most 1000000 m, and the radius is above 0 and at most that
        x and y are at most 1000000 m, and the radius is above 0 and at most that
        a tolerance is from 0 to 180 degrees
        `1s` is a time: expected a length in m, cm, mm, in, ft, or a number in m
        x and y are at most 1000000 m, and the radius is above 0 and at most that
        expected `world`, or x,y,radius in metres and perhaps heading,tolerance in degrees, as in `7,3,0.5` or `7,3,50cm,90,15`
        ");
    }
}
