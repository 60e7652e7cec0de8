//! The area of the floor that a robot's body covers: a disc or a rectangle around its centre. It is used for contacts
//! with walls, moving objects and other robots, and for the echoes of sonars.

#[cfg(test)]
mod tests;

use std::fmt;

use mdle_runtime::{Pose, Radians, Shape};

use crate::grid::Segment;
use crate::point::Point;
use crate::surfaces::{Surface, apart};

/// Radius of a Scout's body, which is a disc, in metres.
pub(crate) const RADIUS: f64 = 0.205;

/// Form of a body, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// A disc.
    Disc {
        /// Radius of the disc, in metres.
        radius: f64,
    },
    /// A rectangle, which drives in the direction of its length.
    Rectangle {
        /// Half of the length, in metres.
        half_length: f64,
        /// Half of the width, in metres.
        half_width: f64,
    },
}

/// A body at its pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    /// Pose of the centre.
    pub pose: Pose,
    /// Form of the body.
    pub form: Form,
}

/// Nearest points of a body and an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contact {
    /// Distance between the two points, in metres; negative where body and obstacle overlap.
    pub(crate) gap: f64,
    /// Point on the obstacle.
    pub(crate) place: Point,
    /// Point of the body at which the obstacle pushes the body; for a disc, its centre.
    pub(crate) body: Point,
}

/// Distance, in metres, beyond a ray's end at which the ray can still hit a body; larger than rounding errors.
const BEYOND: f64 = 1e-6;
/// Gap of a rectangle that overlaps an obstacle. The value does not depend on the depth of the overlap.
const OVERLAPS: f64 = -1.0;

impl Form {
    /// The form of a Scout.
    pub(crate) const SCOUT: Self = Self::Disc { radius: RADIUS };

    /// Returns the form of a robot with these dimensions. It is a disc if the length equals the width.
    #[must_use]
    pub fn of(shape: &Shape) -> Self {
        let (half_length, half_width) = (shape.half_length.0, shape.half_width.0);
        if shape.half_length == shape.half_width {
            Self::Disc { radius: half_length }
        } else {
            Self::Rectangle { half_length, half_width }
        }
    }

    /// Returns the radius of the smallest circle around the body, in metres.
    #[must_use]
    pub fn radius(self) -> f64 {
        match self {
            Self::Disc { radius } => radius,
            Self::Rectangle { half_length, half_width } => libm::hypot(half_length, half_width),
        }
    }

    /// Returns half of the length and half of the width, in metres.
    #[must_use]
    pub fn halves(self) -> (f64, f64) {
        match self {
            Self::Disc { radius } => (radius, radius),
            Self::Rectangle { half_length, half_width } => (half_length, half_width),
        }
    }

    /// Returns the maximum distance, in metres, by which a point of the outline moves when the body moves by `way`
    /// metres and turns by `turn`. Turning a disc does not move its outline.
    pub(crate) fn moved(self, way: f64, turn: Radians) -> f64 {
        match self {
            Self::Disc { .. } => way.abs(),
            Self::Rectangle { .. } => way.abs() + self.radius() * turn.0.abs(),
        }
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Disc { radius } => write!(f, "{radius} m around its centre"),
            Self::Rectangle { half_length, half_width } => {
                write!(f, "{} m long and {} m wide", 2.0 * half_length, 2.0 * half_width)
            }
        }
    }
}

impl Footprint {
    /// Returns the position of the centre.
    #[must_use]
    pub fn at(&self) -> Point {
        Point::of(&self.pose)
    }

    /// Returns `true` if the body overlaps `other`.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.contact_with(other).gap < 0.0
    }

    /// Returns the distance between the body and `other`, in metres; negative where they overlap.
    #[must_use]
    pub fn gap(&self, other: &Self) -> f64 {
        self.contact_with(other).gap
    }

    /// Returns the sides of a rectangle, counter-clockwise from the front; a disc has no sides.
    pub(crate) fn sides(&self) -> impl Iterator<Item = Segment> {
        let corners = match self.form {
            Form::Disc { .. } => None,
            Form::Rectangle { half_length: x, half_width: y } => {
                Some([(x, -y), (x, y), (-x, y), (-x, -y)].map(|(x, y)| self.outward(Point { x, y })))
            }
        };
        let sides = corners.map(|[a, b, c, d]| [(a, b), (b, c), (c, d), (d, a)]);
        sides.into_iter().flatten().map(|(from, to)| Segment::between(from, to))
    }

    /// Returns the ends of each side of a rectangle, counter-clockwise from the front; a disc has no sides.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> {
        self.sides().map(|side| (side.from, side.to()))
    }

    /// Converts a point in the body's frame to a point on the floor.
    fn outward(&self, place: Point) -> Point {
        let (sin, cos) = libm::sincos(self.pose.theta.0);
        let at = self.at();
        Point { x: at.x + place.x * cos - place.y * sin, y: at.y + place.x * sin + place.y * cos }
    }

    /// Converts a point on the floor to a point in the body's frame.
    fn inward(&self, place: Point) -> Point {
        let (sin, cos) = libm::sincos(self.pose.theta.0);
        let (x, y) = (place.x - self.pose.x.0, place.y - self.pose.y.0);
        Point { x: x * cos + y * sin, y: y * cos - x * sin }
    }

    /// Returns the distance from `at` to the edge of the body; negative inside the body.
    pub(crate) fn distance(&self, at: Point) -> f64 {
        match self.form {
            Form::Disc { radius } => apart(self.at(), at) - radius,
            Form::Rectangle { half_length, half_width } => {
                let Point { x, y } = self.inward(at);
                let (x, y) = (x.abs() - half_length, y.abs() - half_width);
                if x <= 0.0 && y <= 0.0 { x.max(y) } else { libm::hypot(x.max(0.0), y.max(0.0)) }
            }
        }
    }

    /// Returns the point of the body that is nearest to `at`, which must be outside the body. For a disc, this point is
    /// on the edge.
    fn nearest(&self, at: Point) -> Point {
        match self.form {
            Form::Disc { radius } => {
                let (x, y) = (at.x - self.pose.x.0, at.y - self.pose.y.0);
                let part = radius / libm::hypot(x, y).max(f64::MIN_POSITIVE);
                Point { x: self.pose.x.0 + part * x, y: self.pose.y.0 + part * y }
            }
            Form::Rectangle { half_length, half_width } => {
                let Point { x, y } = self.inward(at);
                self.outward(Point { x: x.clamp(-half_length, half_length), y: y.clamp(-half_width, half_width) })
            }
        }
    }

    /// Returns the contact of the body with `segment`, which is a wall or a side of an obstacle.
    pub(crate) fn contact(&self, segment: &Segment) -> Contact {
        let at = self.at();
        if let Form::Disc { radius } = self.form {
            let place = segment.nearest(at);
            return Contact { gap: apart(place, at) - radius, place, body: at };
        }
        if self.is_crossed(segment) {
            return Contact { gap: OVERLAPS, place: segment.nearest(at), body: at };
        }
        let from_ends = [segment.from, segment.to()].map(|place| (place, self.nearest(place)));
        let from_corners = self.sides().map(|side| (segment.nearest(side.from), side.from));
        let pairs = from_ends.into_iter().chain(from_corners);
        let contacts = pairs.map(|(place, body)| Contact { gap: apart(place, body), place, body });
        let nothing = Contact { gap: f64::INFINITY, place: at, body: at };
        contacts.fold(nothing, |least, contact| if contact.gap < least.gap { contact } else { least })
    }

    /// Returns `true` if a part of the segment is inside the rectangle. For this purpose, the segment is clipped at
    /// each pair of sides.
    fn is_crossed(&self, segment: &Segment) -> bool {
        let (half_length, half_width) = self.form.halves();
        let (from, to) = (self.inward(segment.from), self.inward(segment.to()));
        let (mut least, mut most) = (0.0_f64, 1.0_f64);
        for (from, to, half) in [(from.x, to.x, half_length), (from.y, to.y, half_width)] {
            let along = to - from;
            if along == 0.0 {
                if from.abs() > half {
                    return false;
                }
                continue;
            }
            let (one, other) = ((-half - from) / along, (half - from) / along);
            (least, most) = (least.max(one.min(other)), most.min(one.max(other)));
        }
        least <= most
    }

    /// Returns the contact of the body with another body.
    pub(crate) fn contact_with(&self, other: &Self) -> Contact {
        let at = self.at();
        match (self.form, other.form) {
            (_, Form::Disc { radius }) => {
                let body = if let Form::Disc { .. } = self.form { at } else { self.nearest(other.at()) };
                Contact { gap: self.distance(other.at()) - radius, place: other.nearest(at), body }
            }
            (Form::Disc { radius }, Form::Rectangle { .. }) => {
                Contact { gap: other.distance(at) - radius, place: other.nearest(at), body: at }
            }
            (Form::Rectangle { .. }, Form::Rectangle { .. }) => {
                let contacts = other.sides().map(|side| self.contact(&side));
                let apart = Contact { gap: self.distance(other.at()), place: other.at(), body: at };
                contacts.fold(apart, |least, contact| if contact.gap < least.gap { contact } else { least })
            }
        }
    }

    /// Returns the distance that a ray travels before it hits the body. The ray begins outside of the body at `from`,
    /// and `way` is its unit direction. Returns `None` if the ray does not hit the body within `most` metres.
    pub(crate) fn met(&self, from: Point, way: Point, most: f64) -> Option<f64> {
        let Form::Disc { radius } = self.form else {
            return self.sides().filter_map(|side| side.met(from, way, most)).reduce(f64::min);
        };
        let (x, y) = (self.pose.x.0 - from.x, self.pose.y.0 - from.y);
        // A quick check skips most bodies beyond a short ray.
        if x.abs().max(y.abs()) > most + radius + BEYOND {
            return None;
        }
        let (along, across) = (x * way.x + y * way.y, x * way.y - y * way.x);
        let half = radius * radius - across * across;
        if half < 0.0 {
            return None;
        }
        let range = along - libm::sqrt(half);
        (range >= 0.0 && range < most).then_some(range)
    }

    /// Returns the surface that a ray hits; `None` if it does not hit the body within `most` metres. The ray begins
    /// outside of the body at `from`, and `way` is its unit direction. The surface is smooth; the surface of a disc has
    /// no edges.
    pub(crate) fn found(&self, from: Point, way: Point, most: f64) -> Option<Surface> {
        let Form::Disc { radius } = self.form else {
            let met = self.sides().filter_map(|side| Some((side.met(from, way, most)?, side)));
            let (range, side) = met.reduce(|one, other| if other.0 < one.0 { other } else { one })?;
            let length = libm::hypot(side.along.x, side.along.y);
            let at = Point { x: from.x + range * way.x, y: from.y + range * way.y };
            let edge = apart(at, side.from).min(apart(at, side.to()));
            return Some(Surface {
                range,
                normal: Point { x: side.along.y / length, y: -side.along.x / length },
                edge,
                rough: 0.0,
            });
        };
        let range = self.met(from, way, most)?;
        let (x, y) = (from.x + range * way.x - self.pose.x.0, from.y + range * way.y - self.pose.y.0);
        let normal = Point { x: x / radius, y: y / radius };
        Some(Surface { range, normal, edge: f64::INFINITY, rough: 0.0 })
    }
}
