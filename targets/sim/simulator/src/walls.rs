//! The fixed and moving obstacles of a world, prepared for queries of rays, distances and contacts.

use std::sync::Arc;

use mdle_runtime::Radians;

use crate::footprint::{Contact, Footprint, Form};
use crate::grid::{Grid, Hit, Segment};
use crate::moving::Moving;
use crate::outline::Outline;
use crate::point::Point;
use crate::surfaces::{Ends, Meeting, Surface, apart, surface};
use crate::wall_ends::WallEnds;
use crate::world::World;

/// Maximum number of pairs of a segment's end and another segment in the same cell. Checking this number of pairs takes
/// about a second.
const PAIRS_MOST: u64 = 100_000_000;

/// Maximum distance outside a cone at which a robot is still treated as inside, in metres. It exceeds the rounding
/// errors.
const BESIDE: f64 = 1e-6;

/// Walls of a world at a certain time.
#[derive(Debug, Clone)]
pub struct Walls {
    /// Fixed obstacles, which all robots in a world share.
    standing: Arc<Standing>,
    moving: Vec<Moving>,
    others: Others,
    /// Roughness of the other robots, from 0 to 1.
    rough: f64,
}

/// Fixed obstacles of a world.
#[derive(Debug)]
struct Standing {
    segments: Vec<Segment>,
    ends: Vec<Ends>,
    /// Roughness of each segment, from 0 to 1.
    roughs: Vec<f64>,
    grid: Grid,
    free_ends: WallEnds,
}

/// The other robots near a robot.
#[derive(Debug, Clone, Default)]
pub struct Others {
    /// Robots from which the robot's sonars may receive an echo.
    pub heard: Vec<Footprint>,
    /// Robots that the robot's body may touch.
    pub touched: Vec<Footprint>,
}

/// Obstacles that rays may hit, in addition to the moving objects.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached<'o> {
    pub(crate) others: &'o [Footprint],
    /// `false` if no ray can hit a fixed obstacle.
    pub(crate) standing: bool,
}

impl Walls {
    /// Returns the fixed obstacles of `world`, and the moving objects at their first positions.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let segments = segments(world);
        let grid = Grid::of(&segments);
        Self::in_grid(world, segments, grid)
    }

    /// Returns the walls of a world that may have too many walls.
    ///
    /// # Errors
    /// Returns a sentence if too many pairs of walls share a cell of the grid, so that preparing the walls would take
    /// too long.
    pub fn of_any(world: &World) -> Result<Self, String> {
        let segments = segments(world);
        let grid = Grid::of(&segments);
        let pairs = segments.iter().map(|segment| grid.beside(segment.from) + grid.beside(segment.to())).sum::<u64>();
        if pairs > PAIRS_MOST {
            return Err(format!(
                "{} walls and sides lie too close together for the size of the world: {pairs} pairs of them share a cell of \
                 its grid, and at most {PAIRS_MOST} may; leave out long walls and what the robot never comes near",
                segments.len()
            ));
        }
        Ok(Self::in_grid(world, segments, grid))
    }

    fn in_grid(world: &World, segments: Vec<Segment>, grid: Grid) -> Self {
        let meets = |segment: &Segment| {
            let mut meeting = Meeting::of(*segment);
            for at in [segment.from, segment.to()] {
                grid.near(at, 0.0, |_, other| meeting.touched(other));
            }
            meeting.ends()
        };
        let ends: Vec<Ends> = segments.iter().map(meets).collect();
        let free_ends = WallEnds::of(&segments, &ends);
        let roughs = world.segments().map(|(outline, ..)| outline.rough).collect();
        let moving = world.things.iter().map(Moving::of).collect();
        let standing = Arc::new(Standing { segments, ends, roughs, grid, free_ends });
        Self { standing, moving, others: Others::default(), rough: world.rough }
    }

    /// Returns the distance that a ray from `from` travels before it hits an obstacle; `None` if that is `most` metres
    /// or more.
    #[must_use]
    pub fn ray(&self, from: Point, direction: Radians, most: f64) -> Option<f64> {
        let (sin, cos) = libm::sincos(direction.0);
        self.cast(from, Point { x: cos, y: sin }, most)
    }

    /// Returns the distance that a ray in the direction of the unit vector `way` travels before it hits an obstacle;
    /// `None` if that is `most` metres or more.
    #[must_use]
    pub fn cast(&self, from: Point, way: Point, most: f64) -> Option<f64> {
        self.cast_among(self.all(), from, way, most)
    }

    /// Returns the distance that a ray travels, as [`Walls::cast`] does, but considers only moving objects and the
    /// obstacles in `reached`.
    pub(crate) fn cast_among(&self, reached: Reached<'_>, from: Point, way: Point, most: f64) -> Option<f64> {
        let range = nearest_of(reached.others, from, way, most).map_or(most, |(range, _)| range);
        let hit = reached.standing.then(|| self.standing.grid.ray(from, way, range)).flatten();
        let range = hit.map_or(range, |hit| hit.range);
        let range =
            self.moving.iter().fold(range, |range, thing| thing.ray(from, way, range).map_or(range, |hit| hit.range));
        (range < most).then_some(range)
    }

    /// Returns the fixed obstacles and all other robots, as obstacles for rays.
    pub(crate) fn all(&self) -> Reached<'_> {
        Reached { others: &self.others.heard, standing: true }
    }

    /// Returns `true` if a ray of this length from `from` may hit a fixed obstacle.
    pub(crate) fn stand_in_reach(&self, from: Point, most: f64) -> bool {
        self.standing.grid.is_in_reach(from, most)
    }

    /// Returns the surface that a ray in the direction of the unit vector `way` hits; `None` if there is no hit within
    /// `most` metres. Considers only moving objects and the obstacles in `reached`.
    pub(crate) fn found_among(&self, reached: Reached<'_>, from: Point, way: Point, most: f64) -> Option<Surface> {
        let at = |range: f64| Point { x: from.x + range * way.x, y: from.y + range * way.y };
        let other = nearest_of(reached.others, from, way, most);
        // Only obstacles nearer than the nearest robot are searched.
        let reach = other.map_or(most, |(range, _)| range);
        let Standing { segments, ends, roughs, grid, .. } = &*self.standing;
        let hit = reached.standing.then(|| grid.ray(from, way, reach)).flatten();
        let standing = hit.and_then(|Hit { range, segment }| {
            let (side, ends) = (segments.get(segment)?, ends.get(segment)?);
            Some(Surface { rough: *roughs.get(segment)?, ..surface(side, ends, at(range), way, range) })
        });
        let nearer = |found: Option<Surface>| found.map_or(reach, |surface| surface.range);
        let found = self.moving.iter().fold(standing, |found, thing| thing.found(from, way, nearer(found)).or(found));
        found.or_else(|| {
            let surface = other.and_then(|(_, other)| other.found(from, way, most));
            surface.map(|surface| Surface { rough: self.rough, ..surface })
        })
    }

    /// Returns the distance from `at` to the nearest wall, in metres, or `reach` if that is less.
    #[must_use]
    pub fn clearance(&self, at: Point, reach: f64) -> f64 {
        self.standing(at, reach).min(self.moving(at))
    }

    /// Returns the distance from `at` to the nearest fixed obstacle, in metres, or `reach` if that is less.
    pub(crate) fn standing(&self, at: Point, reach: f64) -> f64 {
        let mut least = reach;
        self.standing.grid.near(at, reach, |_, segment| least = least.min(apart(segment.nearest(at), at)));
        least
    }

    /// Returns the distance from `at` to the nearest moving object or other robot, in metres; infinite if there is no
    /// such object.
    fn moving(&self, at: Point) -> f64 {
        let least = self.moving.iter().fold(f64::INFINITY, |least, thing| thing.distance(at, least).min(least));
        self.others.touched.iter().fold(least, |least, other| least.min(other.distance(at)))
    }

    /// Returns the distance between a body and the nearest obstacle, in metres, or `reach` if that is less; negative if
    /// they overlap.
    #[must_use]
    pub fn gap(&self, body: &Footprint, reach: f64) -> f64 {
        self.standing_gap(body, reach).min(self.moving_gap(body))
    }

    /// Returns the distance between a body and the nearest fixed obstacle, in metres, or `reach` if that is less.
    pub(crate) fn standing_gap(&self, body: &Footprint, reach: f64) -> f64 {
        if let Form::Disc { radius } = body.form {
            return self.standing(body.at(), radius + reach) - radius;
        }
        let mut least = reach;
        let touches = |segment: &Segment, least: f64| {
            // Most walls are further away than the nearest one found so far; the circle around the body suffices to
            // exclude them.
            let far = apart(segment.nearest(body.at()), body.at()) - body.form.radius();
            if far < least { least.min(body.contact(segment).gap) } else { least }
        };
        self.standing.grid.near(body.at(), body.form.radius() + reach, |_, segment| least = touches(segment, least));
        least
    }

    /// Returns the distance between a body and the nearest moving object or other robot, in metres; infinite if there
    /// is no such object.
    pub(crate) fn moving_gap(&self, body: &Footprint) -> f64 {
        let least = self.moving.iter().fold(f64::INFINITY, |least, thing| thing.gap(body, least).min(least));
        self.others.touched.iter().fold(least, |least, other| least.min(body.contact_with(other).gap))
    }

    /// Returns the contact of a body with the nearest obstacle; `None` if there is no obstacle within `reach`.
    pub(crate) fn contact(&self, body: &Footprint, reach: f64) -> Option<Contact> {
        let mut nearest = (reach, None);
        self.contacts(body, reach, |contact| {
            if contact.gap < nearest.0 {
                nearest = (contact.gap, Some(contact));
            }
        });
        nearest.1
    }

    /// Calls `take` with the contact of a body with each obstacle that may be within `reach` of the body.
    pub(crate) fn contacts(&self, body: &Footprint, reach: f64, mut take: impl FnMut(Contact)) {
        let around = body.form.radius() + reach;
        self.standing.grid.near(body.at(), around, |_, segment| take(body.contact(segment)));
        for segment in self.moving.iter().flat_map(Moving::segments) {
            take(body.contact(segment));
        }
        self.others.touched.iter().for_each(|other| take(body.contact_with(other)));
    }

    /// Returns the displacement of each moving object from its first position; `None` for an open door.
    pub(crate) fn gone(&self) -> impl Iterator<Item = Option<Point>> {
        self.moving.iter().map(Moving::gone)
    }

    /// Returns the centre of each moving object, except open doors.
    pub(crate) fn things(&self) -> impl Iterator<Item = Point> {
        self.moving.iter().filter_map(Moving::around)
    }

    /// Returns the free ends of the fixed walls.
    pub(crate) fn free_ends(&self) -> &WallEnds {
        &self.standing.free_ends
    }

    /// Returns the other robots that rays from `from` may hit at angles of at most `half_cone` from `axis`.
    pub(crate) fn others_in(&self, from: Point, axis: Radians, half_cone: Radians) -> Vec<Footprint> {
        if self.others.heard.is_empty() {
            return Vec::new();
        }
        let (along, edge) = (libm::sincos(axis.0), libm::sincos(half_cone.0));
        let is_near = |other: &&Footprint| {
            let (x, y) = (other.pose.x.0 - from.x, other.pose.y.0 - from.y);
            let (ahead, reach) = (x * along.1 + y * along.0, other.form.radius() + BESIDE);
            // The cone is on the near side of two lines: one across its tip, and one along its edge.
            -ahead <= reach && (x * along.0 - y * along.1).abs() * edge.1 - ahead * edge.0 <= reach
        };
        // A cone contains few of the robots, so the list is short.
        self.others.heard.iter().filter(is_near).copied().collect()
    }

    /// Sets the positions of the other robots.
    pub(crate) fn put_others(&mut self, others: &[Footprint]) {
        for known in [&mut self.others.heard, &mut self.others.touched] {
            known.clear();
            known.extend_from_slice(others);
        }
    }

    /// Swaps the other robots with those in `others`.
    pub(crate) fn swap_others(&mut self, others: &mut Others) {
        std::mem::swap(&mut self.others, others);
    }

    /// Returns `true` if the world has moving objects.
    pub(crate) fn move_at_all(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Advances all moving objects by `seconds`, without moving any of them into `body`.
    pub(crate) fn advance(&mut self, seconds: f64, body: &Footprint) {
        for thing in &mut self.moving {
            thing.advance(seconds, body);
        }
    }
}

/// Returns the robot that a ray in the unit direction `way` hits first, and its distance; `None` if there is no hit
/// within `most` metres.
fn nearest_of(others: &[Footprint], from: Point, way: Point, most: f64) -> Option<(f64, &Footprint)> {
    let mut nearest = (most, None);
    for other in others {
        if let Some(range) = other.met(from, way, nearest.0) {
            nearest = (range, Some(other));
        }
    }
    let (range, other) = nearest;
    other.map(|other| (range, other))
}

fn segments(world: &World) -> Vec<Segment> {
    world.segments().map(|(_, from, to)| Segment::between(from, to)).collect()
}

/// Returns the wall or box of `world` that is nearest to `body`, with all moving objects at their first positions;
/// `None` if the world has no walls.
pub(crate) fn nearest<'w>(world: &'w World, body: &Footprint) -> Option<&'w Outline> {
    let distances =
        world.everything().map(|(outline, from, to)| (outline, body.contact(&Segment::between(from, to)).gap));
    distances.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(outline, _)| outline)
}

#[cfg(test)]
mod tests;
