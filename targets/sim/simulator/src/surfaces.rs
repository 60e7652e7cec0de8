//! Determines properties of the surface that a ray hits: its normal, and the nearest edge.

use crate::grid::Segment;
use crate::point::Point;

/// Distance below which the end of a segment is treated as a point of another segment, in metres.
const TOGETHER: f64 = 1e-3;
/// Cosine of the maximum angle at which two segments form a smooth surface: 30°.
const SMOOTH: f64 = 0.866;

/// Situation of one end of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SegmentEnd {
    /// The end is free.
    Edge,
    /// The end touches the middle of another segment, or two or more other segments.
    Covered,
    /// The end meets another segment, which continues in this unit direction.
    Meets(Point),
}

/// Situation of both ends of a segment; the end at `from` is first.
pub(crate) type Ends = [SegmentEnd; 2];

/// The surface that a ray has hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surface {
    /// Length of the ray, in metres.
    pub(crate) range: f64,
    /// Unit normal of the surface, on the side of the ray.
    pub(crate) normal: Point,
    /// Distance of the nearest edge that reflects sound back to the start of the ray, in metres; infinite if there is
    /// no such edge.
    pub(crate) edge: f64,
    /// Roughness, from 0 to 1.
    pub(crate) rough: f64,
}

/// Returns the situation of both ends of `segment` among the segments `others`, which may contain the segment itself.
pub(crate) fn ends<'s>(segment: &Segment, others: impl Iterator<Item = &'s Segment>) -> Ends {
    let mut meeting = Meeting::of(*segment);
    others.for_each(|other| meeting.touched(other));
    meeting.ends()
}

/// The ends of a segment, and the situation of each as far as it is known. The memory needed does not depend on the
/// number of segments.
pub(crate) struct Meeting {
    segment: Segment,
    ends: [(SegmentEnd, Option<Segment>); 2],
}

impl Meeting {
    pub(crate) fn of(segment: Segment) -> Self {
        Self { segment, ends: [(SegmentEnd::Edge, None); 2] }
    }

    /// Adds a segment that may touch an end. The same segment may be added several times.
    pub(crate) fn touched(&mut self, other: &Segment) {
        let places = [self.segment.from, self.segment.to()];
        if *other == self.segment {
            return;
        }
        for ((end, first), at) in self.ends.iter_mut().zip(places) {
            if first.as_ref() == Some(other) || apart(other.nearest(at), at) > TOGETHER {
                continue;
            }
            // Where three segments meet, there is no edge on any side.
            *end = if first.is_none() { met(other, at) } else { SegmentEnd::Covered };
            *first = first.or(Some(*other));
        }
    }

    pub(crate) fn ends(&self) -> Ends {
        self.ends.map(|(end, _)| end)
    }
}

/// Returns the situation of a segment's end at the point `at`, which the segment `other` touches.
fn met(other: &Segment, at: Point) -> SegmentEnd {
    let way = |sign: f64| {
        let length = libm::hypot(other.along.x, other.along.y);
        SegmentEnd::Meets(Point { x: sign * other.along.x / length, y: sign * other.along.y / length })
    };
    if apart(other.from, at) <= TOGETHER {
        way(1.0)
    } else if apart(other.to(), at) <= TOGETHER {
        way(-1.0)
    } else {
        SegmentEnd::Covered
    }
}

/// Returns the surface that a ray in the unit direction `way` hits at the point `at` of `segment`, after `range`
/// metres. The roughness of the returned surface is 0.
pub(crate) fn surface(segment: &Segment, ends: &Ends, at: Point, way: Point, range: f64) -> Surface {
    let length = libm::hypot(segment.along.x, segment.along.y);
    let along = Point { x: segment.along.x / length, y: segment.along.y / length };
    let left = Point { x: -along.y, y: along.x };
    let normal = if dot(left, way) < 0.0 { left } else { Point { x: along.y, y: -along.x } };
    let [first, second] = ends;
    let mut edge = f64::INFINITY;
    for (end, to, outward) in [(first, segment.from, -1.0), (second, segment.to(), 1.0)] {
        let outward = Point { x: outward * along.x, y: outward * along.y };
        if is_edge(end, outward, normal) {
            edge = edge.min(apart(to, at));
        }
    }
    Surface { range, normal, edge, rough: 0.0 }
}

/// Returns `true` if this end of a surface is a free edge, seen from the side to which `normal` points. `outward`
/// points along the surface to the end.
fn is_edge(end: &SegmentEnd, outward: Point, normal: Point) -> bool {
    match end {
        SegmentEnd::Edge => true,
        SegmentEnd::Covered => false,
        // A surface that bends towards the ray forms a corner, and one that continues straight is the same surface.
        SegmentEnd::Meets(on) => dot(*on, outward) < SMOOTH && dot(*on, normal) <= 0.0,
    }
}

pub(crate) fn dot(one: Point, other: Point) -> f64 {
    one.x * other.x + one.y * other.y
}

pub(crate) fn apart(one: Point, other: Point) -> f64 {
    libm::hypot(other.x - one.x, other.y - one.y)
}
