//! A world: the outlines of walls and boxes on a flat floor, and where a robot starts unless told otherwise.

use std::fmt;

use mdle_runtime::{Meters, Pose};

use crate::goal::Goal;
use crate::world_file::{self, WorldError};

/// The floor of the paper's tour, box in the hallway included.
const OFFICE: &str = include_str!("../worlds/office.toml");

/// What the simulated robot moves among. Its coordinates are finite and no wall has length zero.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Walls and boxes.
    pub outlines: Vec<Outline>,
    /// The start pose unless an option says otherwise.
    pub start: Pose,
    /// Where a plan is to leave the robot, if the world says so.
    pub goal: Option<Goal>,
}

/// A wall or a box, as the line around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// What messages call it.
    pub name: String,
    /// Its corners in order; a box ends where it began.
    pub points: Vec<Place>,
    /// Whether it is a box, which is solid inside; a wall has no thickness.
    pub solid: bool,
}

/// A place on the floor, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Along the first axis.
    pub x: f64,
    /// Along the second axis, to the left of the first.
    pub y: f64,
}

impl World {
    /// The world of a TOML text; `file` is what errors call it.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(file: &str, text: &str) -> Result<Self, WorldError> {
        world_file::parse(file, text)
    }

    /// The office floor of the paper's tour.
    ///
    /// # Errors
    /// Never: a test reads it. It is the file of a user like any other.
    pub fn office() -> Result<Self, WorldError> {
        Self::parse("the office floor", OFFICE)
    }

    /// All walls and sides of boxes, each with its outline.
    pub(crate) fn segments(&self) -> impl Iterator<Item = (&Outline, Place, Place)> {
        self.outlines.iter().flat_map(|outline| {
            let ends = outline.points.iter().zip(outline.points.iter().skip(1));
            ends.map(move |(from, to)| (outline, *from, *to))
        })
    }
}

impl Outline {
    /// Whether `place` is inside a box.
    pub(crate) fn holds(&self, place: Place) -> bool {
        let within = |of: fn(&Place) -> f64| {
            let least = self.points.iter().map(of).fold(f64::INFINITY, f64::min);
            let most = self.points.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            least < of(&place) && of(&place) < most
        };
        self.solid && within(|place| place.x) && within(|place| place.y)
    }
}

impl Place {
    /// Where a pose is.
    pub(crate) fn of(pose: &Pose) -> Self {
        let (Meters(x), Meters(y)) = (pose.x, pose.y);
        Self { x, y }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", self.x, self.y)
    }
}
