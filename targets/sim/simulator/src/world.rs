//! A world: the outlines of walls and boxes on a flat floor, and the default start pose of a robot.

use std::fmt;

use mdle_runtime::{Meters, Pose};

use crate::charger::Charger;
use crate::goal::Goal;
use crate::moving::Thing;
use crate::ros_map::Header;
use crate::world_file::{self, WorldError};

/// The worlds that come with the simulator: first the floor of the paper's tour, box in the hallway included.
const WORLDS: [(&str, &str); 4] = [
    ("office", include_str!("../../worlds/office.toml")),
    ("maze", include_str!("../../worlds/maze.toml")),
    ("hall", include_str!("../../worlds/hall.toml")),
    ("room", include_str!("../../worlds/room.toml")),
];

/// The surroundings of the simulated robot. All coordinates are finite and no wall has length zero.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Walls, boxes and discs that never move.
    pub outlines: Vec<Outline>,
    /// Doors, and boxes and discs that move.
    pub things: Vec<Thing>,
    /// The start pose unless an option says otherwise.
    pub start: Pose,
    /// The place where a plan is to leave the robot, if the world has one.
    pub goal: Option<Goal>,
    /// The charger, if the world has one.
    pub charger: Option<Charger>,
    /// Roughness of other robots, and of the outlines and things of a file that give none of their own: from 0 (as
    /// smooth as the body's model) to 1 (heard by sonars at any angle).
    pub rough: f64,
    /// Number of the first outlines that are contours of a map: inside an odd number of them it is solid.
    pub(crate) contours: usize,
}

/// A wall, a box or a disc, as the line around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// The name in messages.
    pub name: String,
    /// Corners in order; a box ends where it began. A disc has 48 of them.
    pub points: Vec<Place>,
    /// `true` for a box or a disc, which is solid inside; a wall has no thickness.
    pub solid: bool,
    /// Roughness of the surface, from 0 to 1 as in `World`.
    pub rough: f64,
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
    /// Returns the world of a TOML text, which errors call `file`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(file: &str, text: &str) -> Result<Self, WorldError> {
        world_file::parse(file, text)
    }

    /// Returns the world of a map of ROS, from the text of its YAML file and the bytes of its image; errors call these
    /// `file` and `image`.
    ///
    /// # Errors
    /// The defect of either file, with its place.
    pub fn of_map((file, text): (&str, &str), (image, bytes): (&str, &[u8])) -> Result<Self, WorldError> {
        Header::parse(file, text)?.world(image, bytes)
    }

    /// The office floor of the paper's tour.
    ///
    /// # Errors
    /// Never: a test reads it. It is the file of a user like any other.
    pub fn office() -> Result<Self, WorldError> {
        let [(_, office), ..] = WORLDS;
        Self::parse("the office floor", office)
    }

    /// The world of this name that comes with the simulator, if there is one.
    #[must_use]
    pub fn named(name: &str) -> Option<Result<Self, WorldError>> {
        let (name, text) = WORLDS.iter().find(|(known, _)| *known == name)?;
        Some(Self::parse(name, text))
    }

    /// The names of the worlds that come with the simulator.
    pub fn names() -> impl Iterator<Item = &'static str> {
        WORLDS.iter().map(|(name, _)| *name)
    }

    /// The box, disc or contour inside of which `place` lies.
    pub(crate) fn solid(&self, place: Place) -> Option<&Outline> {
        let around = || self.outlines.iter().take(self.contours).filter(|outline| outline.surrounds(place));
        if around().count() % 2 == 1 {
            return around().next_back();
        }
        let outlines = self.outlines.iter().chain(self.things.iter().map(|thing| &thing.outline));
        outlines.into_iter().find(|outline| outline.solid && outline.surrounds(place))
    }

    /// Returns all corners: of the fixed outlines, and of the moving objects at each of their stops.
    pub fn places(&self) -> impl Iterator<Item = Place> {
        let standing = self.outlines.iter().flat_map(|outline| outline.points.iter().copied());
        standing.chain(self.things.iter().flat_map(Thing::places))
    }

    /// All walls and sides of boxes, each with its outline.
    pub fn segments(&self) -> impl Iterator<Item = (&Outline, Place, Place)> {
        self.outlines.iter().flat_map(Outline::segments)
    }

    /// Returns all walls and sides of boxes, and the sides of everything that moves where it begins, each with its
    /// outline.
    pub(crate) fn everything(&self) -> impl Iterator<Item = (&Outline, Place, Place)> {
        self.segments().chain(self.things.iter().flat_map(|thing| thing.outline.segments()))
    }
}

impl Outline {
    /// Returns the sides of the outline.
    fn segments(&self) -> impl Iterator<Item = (&Self, Place, Place)> {
        self.points.iter().zip(self.points.iter().skip(1)).map(move |(from, to)| (self, *from, *to))
    }

    /// Returns `true` if `place` is inside: a line from it crosses an odd number of sides.
    fn surrounds(&self, place: Place) -> bool {
        let crossed = self.segments().filter(|(_, from, to)| {
            let between = (from.y > place.y) != (to.y > place.y);
            between && place.x < from.x + (to.x - from.x) * (place.y - from.y) / (to.y - from.y)
        });
        crossed.count() % 2 == 1
    }
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
