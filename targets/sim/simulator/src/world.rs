//! A world: the outlines of walls and boxes on a flat floor, and the default start pose of a robot.

use mdle_runtime::Pose;
use mdle_sound::SoundSource;

use crate::charger::Charger;
use crate::goal::{Goal, Zone};
use crate::moving::Thing;
use crate::outline::Outline;
use crate::point::Point;

/// Maximum number of walls and sides; preparing that many takes a second.
const SEGMENTS_MOST: usize = 1_000_000;

/// Surroundings of the simulated robot. All coordinates are finite, and every wall has a positive length.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Walls, boxes and discs that never move.
    pub outlines: Vec<Outline>,
    /// Doors, and boxes and discs that move.
    pub things: Vec<Thing>,
    /// Default start pose.
    pub start: Pose,
    /// Place of the start pose in the world's file, as `file:line:column`; `None` if no file gives a start pose.
    pub start_at: Option<String>,
    /// Goal; `None` if the world has no goal.
    pub goal: Option<Goal>,
    /// Charger; `None` if the world has no charger.
    pub charger: Option<Charger>,
    /// Sources of sound.
    pub sounds: Vec<SoundSource>,
    /// Reverberation time in which sound decays by 60 dB, in seconds; 0 if nothing reflects sound.
    pub t60: f64,
    /// Default roughness of the other robots and of the outlines and objects of a file, from 0 (as smooth as in the
    /// body's sonar model) to 1 (detected by sonars at any angle).
    pub rough: f64,
    /// Number of leading `outlines` that are contours of a map; a position inside an odd number of contours is
    /// occupied.
    pub(crate) contours: usize,
}

impl World {
    /// Returns a floor without walls, on which a robot starts at the origin.
    #[must_use]
    pub fn empty() -> Self {
        Self {
            outlines: Vec::new(),
            things: Vec::new(),
            start: Pose::ORIGIN,
            start_at: None,
            goal: None,
            charger: None,
            sounds: Vec::new(),
            t60: 0.0,
            rough: 0.0,
            contours: 0,
        }
    }

    /// Returns the box, disc or contour that contains the position `place`; `None` if this position is free.
    pub(crate) fn solid(&self, place: Point) -> Option<&Outline> {
        let around = || self.outlines.iter().take(self.contours).filter(|outline| outline.surrounds(place));
        if around().count() % 2 == 1 {
            return around().next_back();
        }
        let outlines = self.outlines.iter().chain(self.things.iter().map(|thing| &thing.outline));
        outlines.into_iter().find(|outline| outline.solid && outline.surrounds(place))
    }

    /// Returns the closed wall that contains the whole goal or the charger but not the position `place`, from which
    /// neither can be reached; `None` if there is no such wall.
    pub(crate) fn shut_out(&self, place: Point) -> Option<&Outline> {
        let goal = self.goal.map(|goal| match goal.zone {
            Zone::Rectangle { min, max } => [min, max],
            Zone::Circle { center, radius } => [-radius, radius].map(|far| Point { x: center.x + far, ..center }),
        });
        let charger = self.charger.map(|charger| [Point::of(&charger.pose); 2]);
        let walls = self.outlines.iter().skip(self.contours).filter(|outline| !outline.solid);
        let mut closed = walls.filter(|wall| wall.points.len() > 3 && wall.points.first() == wall.points.last());
        closed.find(|wall| {
            let mut wanted = [goal, charger].into_iter().flatten();
            !wall.surrounds(place) && wanted.any(|places| places.iter().all(|at| wall.surrounds(*at)))
        })
    }

    /// Returns the name of the wall, box or disc that prevents robots of this radius, in metres, from reaching a
    /// charger; `None` if the charger can be reached. The obstacle contains the position of a robot on the charger, or
    /// is closer to it than the radius.
    pub(crate) fn obstacle_at(&self, charger: &Charger, radius: f64) -> Option<&str> {
        let place = Point::of(&charger.pose);
        let near = || {
            self.segments().find(|(_, from, to)| {
                let (dx, dy) = (to.x - from.x, to.y - from.y);
                let along = ((place.x - from.x) * dx + (place.y - from.y) * dy) / (dx * dx + dy * dy);
                let along = along.clamp(0.0, 1.0);
                libm::hypot(place.x - from.x - along * dx, place.y - from.y - along * dy) < radius
            })
        };
        self.solid(place).or_else(|| near().map(|(outline, ..)| outline)).map(|outline| outline.name.as_str())
    }

    /// Checks that the world does not have too many walls and sides.
    pub(crate) fn check_size(&self) -> Result<(), String> {
        match self.everything().count() {
            count if count > SEGMENTS_MOST => {
                Err(format!("{count} walls and sides are too many; expected at most {SEGMENTS_MOST}"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the positions of all corners of the fixed outlines, and of all corners of the moving objects at each of
    /// their stops.
    pub fn places(&self) -> impl Iterator<Item = Point> {
        let standing = self.outlines.iter().flat_map(|outline| outline.points.iter().copied());
        standing.chain(self.things.iter().flat_map(Thing::places))
    }

    /// Returns all walls and sides of boxes, each with its outline.
    pub fn segments(&self) -> impl Iterator<Item = (&Outline, Point, Point)> {
        self.outlines.iter().flat_map(Outline::segments)
    }

    /// Returns all walls and sides of boxes, and the sides of all moving objects at their first positions, each
    /// with its outline.
    pub(crate) fn everything(&self) -> impl Iterator<Item = (&Outline, Point, Point)> {
        self.segments().chain(self.things.iter().flat_map(|thing| thing.outline.segments()))
    }
}
