//! A world: the outlines of walls and boxes on a flat floor, and where a robot starts unless told otherwise.

use std::fmt;

use mdle_runtime::{Meters, Pose};

use crate::moving::Thing;
use crate::world_file::{self, WorldError};

/// The floor of the paper's tour, box in the hallway included.
const OFFICE: &str = include_str!("../worlds/office.toml");

/// What the simulated robot moves among. Its coordinates are finite and no wall has length zero.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Walls, boxes and discs that stand.
    pub outlines: Vec<Outline>,
    /// Doors, and boxes and discs that move.
    pub things: Vec<Thing>,
    /// The start pose unless an option says otherwise.
    pub start: Pose,
}

/// A wall, a box or a disc, as the line around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// What messages call it.
    pub name: String,
    /// Its corners in order; a box ends where it began. A disc has 48 of them.
    pub points: Vec<Place>,
    /// Whether it is a box or a disc, which is solid inside; a wall has no thickness.
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
        self.outlines.iter().flat_map(Outline::segments)
    }

    /// The same with everything that moves, where it begins.
    pub(crate) fn everything(&self) -> impl Iterator<Item = (&Outline, Place, Place)> {
        self.segments().chain(self.things.iter().flat_map(|thing| thing.outline.segments()))
    }
}

impl Outline {
    /// Its sides.
    fn segments(&self) -> impl Iterator<Item = (&Self, Place, Place)> {
        self.points.iter().zip(self.points.iter().skip(1)).map(move |(from, to)| (self, *from, *to))
    }

    /// Whether `place` is inside something solid: a line from it crosses an odd number of sides.
    pub(crate) fn holds(&self, place: Place) -> bool {
        let crossed = self.segments().filter(|(_, from, to)| {
            let between = (from.y > place.y) != (to.y > place.y);
            between && place.x < from.x + (to.x - from.x) * (place.y - from.y) / (to.y - from.y)
        });
        self.solid && crossed.count() % 2 == 1
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
