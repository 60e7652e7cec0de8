//! A position on the floor.

use std::fmt;

use mdle_runtime::{Meters, Pose};

/// A position on the floor, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Coordinate along the x axis, in metres.
    pub x: f64,
    /// Coordinate along the y axis, which points to the left of the x axis, in metres.
    pub y: f64,
}

impl Point {
    /// Returns the position of a pose.
    #[must_use]
    pub fn of(pose: &Pose) -> Self {
        let (Meters(x), Meters(y)) = (pose.x, pose.y);
        Self { x, y }
    }
}

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", self.x, self.y)
    }
}
