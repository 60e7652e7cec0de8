//! Rays against the walls and the distance to them: the only place that knows the geometry library.

use mdle_runtime::Radians;
use parry2d_f64::math::Vector;
use parry2d_f64::query::{PointQuery, Ray, RayCast};
use parry2d_f64::shape::{Polyline, Segment};

use crate::world::{Outline, Place, World};

/// The walls of a world, made ready for questions. `None` where there are no walls at all.
pub(crate) struct Walls {
    lines: Option<Polyline>,
}

impl Walls {
    /// The walls and the sides of the boxes of `world`.
    pub(crate) fn of(world: &World) -> Self {
        let mut vertices = Vec::new();
        let mut indices = Vec::new();
        for ((_, from, to), first) in world.segments().zip((0_u32..).step_by(2)) {
            vertices.extend([vector(from), vector(to)]);
            indices.push([first, first + 1]);
        }
        // An empty tree is not something to ask.
        Self { lines: (!indices.is_empty()).then(|| Polyline::new(vertices, Some(indices))) }
    }

    /// How far a ray from `from` goes before it hits a wall; `None` if that is further than `most` metres.
    pub(crate) fn ray(&self, from: Place, direction: Radians, most: f64) -> Option<f64> {
        let (sin, cos) = libm::sincos(direction.0);
        let ray = Ray::new(vector(from), Vector::new(cos, sin));
        self.lines.as_ref()?.cast_local_ray(&ray, most, true)
    }

    /// The distance from `at` to the nearest wall, in metres; infinite without walls.
    pub(crate) fn distance(&self, at: Place) -> f64 {
        self.lines.as_ref().map_or(f64::INFINITY, |lines| lines.distance_to_local_point(vector(at), true))
    }
}

/// The wall or box of `world` that is nearest to `at`.
pub(crate) fn nearest(world: &World, at: Place) -> Option<&Outline> {
    let distances = world.segments().map(|(outline, from, to)| {
        (outline, Segment::new(vector(from), vector(to)).distance_to_local_point(vector(at), true))
    });
    distances.min_by(|(_, one), (_, other)| one.total_cmp(other)).map(|(outline, _)| outline)
}

fn vector(place: Place) -> Vector {
    Vector::new(place.x, place.y)
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;

    /// Walls scattered over 10 m × 10 m, boxes among them.
    fn scene(random: &mut ChaCha8Rng, walls: usize) -> World {
        let mut number = || 10.0 * ((random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64);
        let mut text = String::new();
        for wall in 0..walls {
            let (x, y, across) = (number(), number(), number());
            text += &match wall % 3 {
                0 => format!("[[wall]]\npoints = [[{x}, {y}], [{x}, {across}], [{across}, {across}]]\n"),
                1 => format!("[[wall]]\npoints = [[{x}, {y}], [{}, {across}]]\n", number()),
                _ => format!("[[box]]\ncentre = [{x}, {y}]\nsize = [{}, 0.3]\n", 0.1 + across / 10.0),
            };
        }
        World::parse("scene", &text).expect("a good scene")
    }

    /// Where a ray meets a segment, by Cramer's rule.
    fn met(from: Place, direction: Radians, one: Place, other: Place) -> Option<f64> {
        let (dx, dy) = (libm::cos(direction.0), libm::sin(direction.0));
        let (sx, sy) = (other.x - one.x, other.y - one.y);
        let (ox, oy) = (one.x - from.x, one.y - from.y);
        let determinant = dx * sy - dy * sx;
        let along = (ox * sy - oy * sx) / determinant;
        let part = (ox * dy - oy * dx) / determinant;
        ((0.0..=1.0).contains(&part) && along >= 0.0).then_some(along)
    }

    /// The distance of a place from a segment, by projection.
    fn apart(at: Place, one: Place, other: Place) -> f64 {
        let (sx, sy) = (other.x - one.x, other.y - one.y);
        let part = ((at.x - one.x) * sx + (at.y - one.y) * sy) / (sx * sx + sy * sy);
        let part = part.clamp(0.0, 1.0);
        libm::hypot(one.x + part * sx - at.x, one.y + part * sy - at.y)
    }

    #[test]
    fn rays_and_distances_are_those_of_brute_force() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for walls in [1, 2, 3, 10, 40, 200] {
            let world = scene(&mut random, walls);
            let ready = Walls::of(&world);
            for _ in 0..400 {
                let mut number = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                let from = Place { x: 10.0 * number(), y: 10.0 * number() };
                // Every third ray runs along an axis, as most walls do.
                let turn = number();
                let turn = if turn < 0.33 { libm::floor(turn * 12.0) / 4.0 } else { turn };
                let direction = Radians(turn * std::f64::consts::TAU);
                let hits = world.segments().filter_map(|(_, one, other)| met(from, direction, one, other));
                let expected = hits.filter(|hit| *hit < 6.0).reduce(f64::min);
                match (ready.ray(from, direction, 6.0), expected) {
                    (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-9),
                    (found, expected) => assert_eq!(found, expected, "from {from} along {direction:?}"),
                }
                let expected = world.segments().map(|(_, one, other)| apart(from, one, other)).reduce(f64::min);
                assert!((ready.distance(from) - expected.expect("walls")).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_world_without_walls_is_endless() {
        let walls = Walls::of(&World::parse("empty", "").expect("an empty world"));
        assert_eq!(walls.ray(Place { x: 0.0, y: 0.0 }, Radians(0.3), 1e6), None);
        assert_eq!(walls.distance(Place { x: 0.0, y: 0.0 }), f64::INFINITY);
    }

    #[test]
    fn the_nearest_wall_is_named() {
        let world = World::office().expect("our own floor");
        let name = |x, y| nearest(&world, Place { x, y }).map(|outline| outline.name.as_str());
        assert_eq!(name(3.6, 4.6), Some("obstacle"));
        assert_eq!(name(-0.5, 2.0), Some("A west"));
    }
}
