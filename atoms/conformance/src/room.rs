//! The rooms in which robots are tested: straight walls around the position at which the robot begins.

use std::string::{String, ToString};

use core::fmt;

use mdle_runtime::{Meters, Pose, Radians};

/// Distance of the outermost walls, in metres, which is beyond the range of any sonar.
const FAR: f64 = 40.0;

/// Pose at which robots begin. It differs from the origin in position and heading, so that the checks detect a robot
/// that confuses odometry coordinates with room coordinates.
pub(super) const AT: Pose = Pose { x: Meters(1.0), y: Meters(-0.5), theta: Radians::from_degrees(30.0) };

/// A straight wall without thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wall {
    /// One end of the wall; the heading is ignored.
    pub from: Pose,
    /// The other end of the wall; the heading is ignored.
    pub to: Pose,
}

/// A flat floor with walls.
///
/// Displayed as text, a room is a world file of `mdle-sim`.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    walls: Vec<Wall>,
}

impl Room {
    /// Returns a hall whose walls are out of range of the sonars.
    pub(super) fn open() -> Self {
        let sides = [0.0, 90.0, 180.0, 270.0];
        sides.into_iter().fold(Self { walls: Vec::new() }, |room, side| room.across(side, FAR, FAR))
    }

    /// Adds a wall that is perpendicular to a direction, `degrees` counter-clockwise from the robot's first heading.
    /// The wall is `distance` metres from the robot's centre, and extends `half` metres to either side of the
    /// direction.
    pub(super) fn across(mut self, degrees: f64, distance: f64, half: f64) -> Self {
        let bearing = AT.theta.0 + Radians::from_degrees(degrees).0;
        let foot = AT.towards(Radians(bearing), Meters(distance));
        let end = |way: f64| foot.towards(Radians(bearing + core::f64::consts::FRAC_PI_2), Meters(way));
        self.walls.push(Wall { from: end(-half), to: end(half) });
        self
    }

    /// Returns the walls of the room.
    #[must_use]
    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    /// Returns the distance from the position of `at` to the nearest wall.
    pub(super) fn nearest(&self, at: Pose) -> Meters {
        let ways = self.walls.iter().map(|wall| wall.distance(at));
        Meters(ways.fold(f64::INFINITY, f64::min))
    }
}

impl Wall {
    fn distance(&self, at: Pose) -> f64 {
        let (x, y) = (self.to.x.0 - self.from.x.0, self.to.y.0 - self.from.y.0);
        let along = (at.x.0 - self.from.x.0) * x + (at.y.0 - self.from.y.0) * y;
        let part = (along / (x * x + y * y)).clamp(0.0, 1.0);
        libm::hypot(at.x.0 - self.from.x.0 - part * x, at.y.0 - self.from.y.0 - part * y)
    }
}

impl fmt::Display for Room {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = |pose: Pose| -> String { [pose.x.0, pose.y.0].map(|number| number.to_string()).join(", ") };
        writeln!(f, "start = {{ x = {}, y = {}, heading = {} }}", AT.x.0, AT.y.0, AT.theta.degrees())?;
        for Wall { from, to } in &self.walls {
            writeln!(f, "[[wall]]\npoints = [[{}], [{}]]", place(*from), place(*to))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_is_as_far_as_it_was_put() {
        let room = Room::open().across(90.0, 0.8, 0.1);
        assert!((room.nearest(AT).0 - 0.8).abs() < 1e-12);
        let beside = AT.towards(Radians(AT.theta.0 + core::f64::consts::FRAC_PI_2), Meters(0.3));
        assert!((room.nearest(beside).0 - 0.5).abs() < 1e-12);
        assert!((room.nearest(AT.towards(AT.theta, Meters(0.7))).0 - libm::hypot(0.8, 0.6)).abs() < 1e-9);
        assert!((Room::open().nearest(AT).0 - FAR).abs() < 1e-9);
    }
}
