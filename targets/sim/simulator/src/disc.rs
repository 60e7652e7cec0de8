//! Another robot, as the robots in the same world hear and touch it: a disc.

use crate::surfaces::{Surface, apart};
use crate::world::Place;

/// A disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Centre of the disc.
    pub at: Place,
    /// Radius of the disc, in metres.
    pub radius: f64,
}

impl Disc {
    /// Returns `true` if the disc overlaps `other`.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.distance(other.at) < other.radius
    }

    /// Returns the distance from `at` to the disc's edge, negative inside.
    pub(crate) fn distance(&self, at: Place) -> f64 {
        apart(self.at, at) - self.radius
    }

    /// Returns the place of the disc's edge that is nearest to `at`.
    pub(crate) fn nearest(&self, at: Place) -> Place {
        let (x, y) = (at.x - self.at.x, at.y - self.at.y);
        let part = self.radius / libm::hypot(x, y).max(f64::MIN_POSITIVE);
        Place { x: self.at.x + part * x, y: self.at.y + part * y }
    }

    /// Returns the distance that a ray from outside goes in the unit direction `way` before it meets the disc, if that
    /// is less than `most`.
    pub(crate) fn ray(&self, from: Place, way: Place, most: f64) -> Option<f64> {
        let (x, y) = (self.at.x - from.x, self.at.y - from.y);
        let (along, across) = (x * way.x + y * way.y, x * way.y - y * way.x);
        let half = self.radius * self.radius - across * across;
        let range = along - libm::sqrt(half.max(0.0));
        (half >= 0.0 && range >= 0.0 && range < most).then_some(range)
    }

    /// Returns the surface that a ray from outside meets, if its distance is less than `most`: a disc has no edges.
    pub(crate) fn found(&self, from: Place, way: Place, most: f64) -> Option<Surface> {
        let range = self.ray(from, way, most)?;
        let (x, y) = (from.x + range * way.x - self.at.x, from.y + range * way.y - self.at.y);
        let normal = Place { x: x / self.radius, y: y / self.radius };
        Some(Surface { range, normal, edge: f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISC: Disc = Disc { at: Place { x: 2.0, y: 0.0 }, radius: 0.5 };
    const HERE: Place = Place { x: 0.0, y: 0.0 };

    #[test]
    fn a_ray_meets_its_edge_and_nothing_behind_or_beside() {
        let way = |x: f64, y: f64| Place { x, y };
        assert_eq!(DISC.ray(HERE, way(1.0, 0.0), 10.0), Some(1.5));
        assert_eq!(DISC.ray(HERE, way(1.0, 0.0), 1.5), None);
        assert_eq!(DISC.ray(HERE, way(-1.0, 0.0), 10.0), None);
        assert_eq!(DISC.ray(HERE, way(0.8, 0.6), 10.0), None);
        assert_eq!(DISC.found(HERE, way(1.0, 0.0), 10.0).map(|found| found.normal), Some(way(-1.0, 0.0)));
    }

    #[test]
    fn two_discs_overlap_or_touch_alike_from_both_sides() {
        let other = |x: f64| Disc { at: Place { x, y: 0.0 }, radius: 0.25 };
        for (x, overlaps) in [(1.0, false), (1.3, true), (2.0, true), (2.75, false)] {
            assert_eq!([DISC.overlaps(&other(x)), other(x).overlaps(&DISC)], [overlaps; 2], "{x}");
        }
        assert_eq!((DISC.distance(HERE), DISC.nearest(HERE)), (1.5, Place { x: 1.5, y: 0.0 }));
    }
}
