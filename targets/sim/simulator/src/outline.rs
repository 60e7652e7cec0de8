//! The outline of a wall, a box or a disc.

use crate::point::Point;

/// A wall, a box or a disc, represented by its outline.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Name of the outline in messages.
    pub name: String,
    /// Corners in order; the last corner of a box equals the first. A disc has 48 corners.
    pub points: Vec<Point>,
    /// `true` for a box or a disc, whose inside is solid. A wall has no thickness.
    pub solid: bool,
    /// Roughness of the surface, from 0 to 1, as defined for `World`.
    pub rough: f64,
}

impl Outline {
    /// Returns the sides of the outline.
    pub(crate) fn segments(&self) -> impl Iterator<Item = (&Self, Point, Point)> {
        self.points.iter().zip(self.points.iter().skip(1)).map(move |(from, to)| (self, *from, *to))
    }

    /// Returns `true` if `place` is inside the outline. This is the case if a line from `place` crosses an odd number
    /// of sides.
    pub(crate) fn surrounds(&self, place: Point) -> bool {
        let crossed = self.segments().filter(|(_, from, to)| {
            let between = (from.y > place.y) != (to.y > place.y);
            between && place.x < from.x + (to.x - from.x) * (place.y - from.y) / (to.y - from.y)
        });
        crossed.count() % 2 == 1
    }
}
