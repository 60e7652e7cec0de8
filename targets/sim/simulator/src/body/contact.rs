//! Contact of the disc with obstacles: it slides along them, and never overlaps them.

use crate::walls::Walls;
use crate::world::Place;

/// Distance, in metres, by which a slide is led off the surface, so that rounding does not turn it into the surface.
const LED_OFF: f64 = 1e-8;
/// Greatest number of surfaces along which one step slides: a corner has two.
const SLIDES: usize = 3;

/// Returns the way that the disc at `at` goes when it is to move by `way`: all of it if that is free, else up to the
/// contact and on along the surface. The step must be shorter than the radius; where it ends, the disc overlaps
/// nothing.
pub(crate) fn slid(at: Place, way: Place, radius: f64, walls: &Walls) -> Place {
    let reach = radius + libm::hypot(way.x, way.y) + LED_OFF;
    let free = |place: Place| walls.clearance(place, reach) >= radius;
    let (mut here, mut left) = (at, way);
    for _ in 0..SLIDES {
        let there = |part: f64| Place { x: here.x + part * left.x, y: here.y + part * left.y };
        if free(there(1.0)) {
            here = there(1.0);
            break;
        }
        let part = last_free(|part| free(there(part)));
        here = there(part);
        let Some(normal) = normal(here, reach, walls) else { break };
        let into = ((1.0 - part) * (left.x * normal.x + left.y * normal.y)).min(0.0) - LED_OFF;
        left = Place { x: (1.0 - part) * left.x - into * normal.x, y: (1.0 - part) * left.y - into * normal.y };
    }
    Place { x: here.x - at.x, y: here.y - at.y }
}

/// The direction away from the nearest surface.
fn normal(at: Place, reach: f64, walls: &Walls) -> Option<Place> {
    let nearest = walls.nearest(at, reach)?;
    let (x, y) = (at.x - nearest.x, at.y - nearest.y);
    let length = libm::hypot(x, y);
    (length > 0.0).then(|| Place { x: x / length, y: y / length })
}

/// The largest part of a step, to a millionth, after which the body is still free; 0 if none is.
fn last_free(free: impl Fn(f64) -> bool) -> f64 {
    let (mut least, mut most) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = (least + most) / 2.0;
        if free(middle) {
            least = middle;
        } else {
            most = middle;
        }
    }
    least
}
