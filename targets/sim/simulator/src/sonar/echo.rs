//! Computes the echo of one ping: determines which rays of a sonar's cone return loud enough to be detected, and which
//! of them returns first.
//!
//! A ray at angle α off the axis that hits a surface at angle β off its normal is detected if (α / lobe)² + (β /
//! facing)² is at most 1 minus the loss over the distance. Near an edge, a small part of the sound is scattered in all
//! directions: there, a fixed loss replaces the term that contains β. A rough surface scatters too: the loss due to β
//! is reduced by the fraction `rough`. A right-angled corner reflects all sound back to its source.
//!
//! The rays of a cone are so far apart that a person 4 m away may be between two rays. Therefore one additional ray is
//! aimed at each moving object and each other robot, of which there are few.
//!
//! Walls have no thickness, so rays that go along a wall do not meet its end. The echo that its edge scatters is
//! therefore computed separately. The sonars of the ideal body hear it in all of their cone.

use mdle_runtime::Radians;

use crate::footprint::Footprint;
use crate::model::Hearing;
use crate::point::Point;
use crate::surfaces::{Surface, dot};
use crate::walls::{Reached, Walls};

/// Number of rays of a cone, which are evenly spread.
const RAYS: u8 = 7;
/// Maximum distance, in metres, from an edge within which a ray must hit so that the edge scatters it.
const SCATTERS: f64 = 0.08;
/// Loss at an edge. With it, an edge is detected up to 0.6 of the angle of the lobe: up to 12.5° for a lobe of 21°.
const EDGE_COSTS: f64 = 0.65;
/// Distance, in metres, up to which the gain of the receiver, which increases with time, compensates for the loss.
const GAIN_LASTS: f64 = 2.0;
/// Loss per metre beyond [`GAIN_LASTS`]: at 6.5 m, a wall is detected up to 26° off its normal.
const METRE_COSTS: f64 = 0.13;
/// Minimum cosine of the angle between a wall and a ray to its end at which other rays may miss the end: 30°.
const ALONG: f64 = 0.866;
/// Distance before the end of a wall, in metres, up to which the way to the end must be free.
const BEFORE: f64 = 1e-3;
/// Maximum distance between the two reflections of a ray in a corner, per metre of range, at which the sound still
/// returns to the sonar.
const CORNER: f64 = 0.35;
/// Maximum cosine of the angle between a ray into a corner and the ray that leaves it: the ray leaves within 15° of the
/// opposite direction.
const BACK: f64 = -0.966;
/// Distance from a surface at which a reflected ray begins, in metres, so that it does not hit the surface again.
const OFF: f64 = 1e-6;

/// Returns the distance, in metres, from a transducer to the nearest object in its cone from which it receives an echo;
/// `None` if it receives no echo. `fade` is the gain or loss of loudness of this ping.
pub(crate) fn echo(walls: &Walls, from: Point, axis: Radians, hearing: &Hearing, fade: f64) -> Option<f64> {
    let spread = (0..RAYS).map(|ray| hearing.half_cone.0 * (2.0 * f64::from(ray) / f64::from(RAYS - 1) - 1.0));
    let others = walls.others_in(from, axis, hearing.half_cone);
    // A ray that leaves a corner continues for a fraction of its range.
    let standing = walls.stand_in_reach(from, (1.0 + CORNER) * hearing.most);
    let (reached, bounced) = (Reached { others: &others, standing }, Reached { standing, ..walls.all() });
    let aimed = walls.things().chain(others.iter().map(Footprint::at)).map(|thing| {
        let Radians(off_axis) = Radians(libm::atan2(thing.y - from.y, thing.x - from.x) - axis.0).wrapped();
        off_axis
    });
    let mut best = None;
    for off_axis in spread.chain(aimed.filter(|off_axis| off_axis.abs() < hearing.half_cone.0)) {
        let most = best.unwrap_or(hearing.most);
        let (sin, cos) = libm::sincos(axis.0 + off_axis);
        let way = Point { x: cos, y: sin };
        let heard = if is_lossless(hearing) {
            walls.cast_among(reached, from, way, most)
        } else {
            let lost = lost(hearing, off_axis) - fade;
            // A ray without any remaining loudness at the start is not heard at any distance.
            let is_loud = 1.0 - lost >= 0.0;
            let found = is_loud.then(|| walls.found_among(reached, from, way, most)).flatten();
            found.and_then(|surface| heard((walls, bounced), from, way, &surface, hearing, lost))
        };
        // The echo of a corner comes from further away than the point where the ray first hit a wall.
        best = heard.filter(|range| *range < most).or(best);
    }
    let end = standing.then(|| end_on((walls, reached), (from, axis), hearing, fade, best.unwrap_or(hearing.most)));
    end.flatten().or(best)
}

/// Returns the distance of the nearest free end of a wall that lies along the ray to this end; `None` if the sonar
/// receives no echo of such an end from within `most` metres.
fn end_on(
    (walls, reached): (&Walls, Reached<'_>),
    (from, axis): (Point, Radians),
    hearing: &Hearing,
    fade: f64,
    most: f64,
) -> Option<f64> {
    let is_lossless = is_lossless(hearing);
    let reach = if is_lossless { most } else { most.min(GAIN_LASTS + (1.0 + fade - EDGE_COSTS) / METRE_COSTS) };
    let (sin, cos) = libm::sincos(axis.0);
    let mut best = None;
    walls.free_ends().near(from, reach, |end, along| {
        let (x, y) = (end.x - from.x, end.y - from.y);
        let range = libm::hypot(x, y);
        if range <= BEFORE || range >= best.unwrap_or(reach) || x * along.x + y * along.y < ALONG * range {
            return;
        }
        let off_axis = libm::atan2(y * cos - x * sin, x * cos + y * sin);
        let way = Point { x: x / range, y: y / range };
        let left = left(range, lost(hearing, off_axis) - fade);
        let is_heard = off_axis.abs() < hearing.half_cone.0 && (is_lossless || left >= EDGE_COSTS);
        if is_heard && walls.cast_among(reached, from, way, range - BEFORE).is_none() {
            best = Some(range);
        }
    });
    best
}

/// Returns `true` if everything in the cone is heard, at any angle.
fn is_lossless(hearing: &Hearing) -> bool {
    hearing.lobe.is_none() && hearing.facing.is_none()
}

/// Returns the loss of a ray at this angle off the axis.
fn lost(hearing: &Hearing, off_axis: f64) -> f64 {
    hearing.lobe.map_or(0.0, |lobe| (off_axis / lobe.0) * (off_axis / lobe.0))
}

/// Returns the remaining loudness of a ray that has already lost `lost` when it has travelled this distance.
fn left(range: f64, lost: f64) -> f64 {
    1.0 - METRE_COSTS * (range - GAIN_LASTS).max(0.0) - lost
}

/// Returns the range of the echo of a ray from this surface; `None` if the echo is too weak. `lost` is the loss of the
/// ray before it hits the surface.
fn heard(
    walls: (&Walls, Reached<'_>),
    from: Point,
    way: Point,
    surface: &Surface,
    hearing: &Hearing,
    lost: f64,
) -> Option<f64> {
    let left = left(surface.range, lost);
    let Some(facing) = hearing.facing else { return (left >= 0.0).then_some(surface.range) };
    let incidence = libm::acos((-dot(way, surface.normal)).min(1.0)) / facing.0;
    let slant = (1.0 - surface.rough) * incidence * incidence;
    let costs = if surface.edge < SCATTERS { EDGE_COSTS.min(slant) } else { slant };
    if costs <= left {
        return Some(surface.range);
    }
    if left < 0.0 {
        return None;
    }
    corner(walls, from, way, surface).filter(|range| *range < hearing.most)
}

/// Returns the range of the corner to which this surface belongs; `None` if no corner reflects the ray back. `bounced`
/// contains the obstacles that the ray may hit after its first reflection.
fn corner((walls, bounced): (&Walls, Reached<'_>), from: Point, way: Point, first: &Surface) -> Option<f64> {
    let on = reflected(way, first.normal);
    let bounce = Point {
        x: from.x + first.range * way.x + OFF * first.normal.x,
        y: from.y + first.range * way.y + OFF * first.normal.y,
    };
    let second = walls.found_among(bounced, bounce, on, CORNER * first.range)?;
    if dot(reflected(on, second.normal), way) > BACK {
        return None;
    }
    let end = Point { x: bounce.x + second.range * on.x, y: bounce.y + second.range * on.y };
    Some((first.range + second.range + crate::surfaces::apart(end, from)) / 2.0)
}

fn reflected(way: Point, normal: Point) -> Point {
    let along = 2.0 * dot(way, normal);
    Point { x: way.x - along * normal.x, y: way.y - along * normal.y }
}
