//! A place on the floor.

use std::fmt;

use mdle_runtime::{Meters, Pose};

/// A place on the floor, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Along the first axis.
    pub x: f64,
    /// Along the second axis, to the left of the first.
    pub y: f64,
}

impl Place {
    /// Returns the place of a pose.
    #[must_use]
    pub fn of(pose: &Pose) -> Self {
        let (Meters(x), Meters(y)) = (pose.x, pose.y);
        Self { x, y }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", self.x, self.y)
    }
}
