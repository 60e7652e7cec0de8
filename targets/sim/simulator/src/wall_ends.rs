//! Finds the free ends of the fixed walls. The rays of a sonar's cone miss the end of a wall along which they go.

use crate::grid::{Grid, Segment};
use crate::point::Point;
use crate::surfaces::{Ends, SegmentEnd, apart};

/// The free ends of walls. Each is a segment that begins at the end and goes 1 m in the direction of its wall.
#[derive(Debug)]
pub(crate) struct WallEnds(Grid);

impl WallEnds {
    /// Returns the free ends of `segments`, whose ends are in the situations `ends`.
    pub(crate) fn of(segments: &[Segment], ends: &[Ends]) -> Self {
        let both = segments.iter().zip(ends).flat_map(|(segment, [first, last])| {
            [(segment.from, segment.to(), *first), (segment.to(), segment.from, *last)]
        });
        let is_free = |(.., end): &(Point, Point, SegmentEnd)| *end == SegmentEnd::Edge;
        let inward = |(from, to, _): (Point, Point, SegmentEnd)| {
            let long = apart(from, to);
            Segment { from, along: Point { x: (to.x - from.x) / long, y: (to.y - from.y) / long } }
        };
        Self(Grid::of(&both.filter(is_free).map(inward).collect::<Vec<_>>()))
    }

    /// Calls `take` with each free end that may be within `reach` of `at`, and with the unit direction from this end
    /// along its wall. May call `take` with ends that are further away, and several times with one end.
    pub(crate) fn near(&self, at: Point, reach: f64, mut take: impl FnMut(Point, Point)) {
        if self.0.is_in_reach(at, reach) {
            self.0.near(at, reach, |_, end| take(end.from, end.along));
        }
    }
}
