//! Compares rays and distances with the library parry2d. Only `.ci/thorough 4` runs this test, because the library
//! takes long to compile.

use parry2d_f64::math::Vector;
use parry2d_f64::query::{PointQuery, Ray, RayCast};
use parry2d_f64::shape::Polyline;

use super::*;

/// Returns the walls of `world` as a polyline of parry2d.
fn beside(world: &World) -> Polyline {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for ((_, from, to), first) in world.segments().zip((0_u32..).step_by(2)) {
        vertices.extend([Vector::new(from.x, from.y), Vector::new(to.x, to.y)]);
        indices.push([first, first + 1]);
    }
    Polyline::new(vertices, Some(indices))
}

#[test]
fn rays_and_distances_are_those_of_parry() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for walls in [1, 2, 3, 10, 40, 200, 1000] {
        let world = scene(&mut random, walls);
        let (ready, library) = (Walls::of(&world), beside(&world));
        for _ in 0..2000 {
            let (from, direction) = look(&mut random);
            let (sin, cos) = libm::sincos(direction.0);
            let ray = Ray::new(Vector::new(from.x, from.y), Vector::new(cos, sin));
            match (ready.ray(from, direction, 6.0), library.cast_local_ray(&ray, 6.0, true)) {
                (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-9, "{found} {expected}"),
                (found, expected) => assert_eq!(found, expected, "from {from} along {direction:?}"),
            }
            let expected = library.distance_to_local_point(Vector::new(from.x, from.y), true);
            assert!((ready.clearance(from, 1.0) - expected.min(1.0)).abs() < 1e-9);
            let nearest = ready.contact(&point(from), 1.0).map(|contact| apart(contact.place, from));
            assert_eq!(nearest.is_some(), expected < 1.0);
            assert!(nearest.is_none_or(|nearest| (nearest - expected).abs() < 1e-9));
        }
    }
}
