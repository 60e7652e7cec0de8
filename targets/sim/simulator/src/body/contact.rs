//! Contact of the body with obstacles: the body slides along them, is pushed away when it turns, and never overlaps
//! them.

use mdle_runtime::{Meters, Pose, Radians};

use crate::footprint::{Contact, Footprint};
use crate::point::Point;
use crate::walls::Walls;

/// Distance, in metres, by which a slide moves the body away from the surface, so that rounding errors do not move the
/// body into the surface.
const LED_OFF: f64 = 1e-8;
/// Maximum number of surfaces along which the body slides in a step. A corner has two surfaces.
const SLIDES: usize = 3;

/// Returns the movement that `body` makes when it is to move by `way`. If the path is free, this is the whole movement;
/// otherwise, the body moves up to the contact and then along the surface. The movement must be shorter than the body.
/// Afterwards, the body overlaps no obstacle.
pub(crate) fn slid(body: &Footprint, way: Point, walls: &Walls) -> Point {
    let at = body.at();
    let reach = libm::hypot(way.x, way.y) + LED_OFF;
    let free = |place: Point| walls.gap(&moved(body, place), reach) >= 0.0;
    let (mut here, mut left) = (at, way);
    for _ in 0..SLIDES {
        let there = |part: f64| Point { x: here.x + part * left.x, y: here.y + part * left.y };
        if free(there(1.0)) {
            here = there(1.0);
            break;
        }
        let part = last_free(|part| free(there(part)));
        here = there(part);
        let Some(normal) = walls.contact(&moved(body, here), reach).and_then(normal) else { break };
        let into = ((1.0 - part) * (left.x * normal.x + left.y * normal.y)).min(0.0) - LED_OFF;
        left = Point { x: (1.0 - part) * left.x - into * normal.x, y: (1.0 - part) * left.y - into * normal.y };
    }
    Point { x: here.x - at.x, y: here.y - at.y }
}

/// Returns `body` turned by `turn`. If a corner or side would turn into an obstacle, the obstacle pushes the body away
/// by the distance that the turn needs. If there is no space for that, the body does not turn.
pub(crate) fn turned(body: &Footprint, turn: Radians, walls: &Walls) -> Footprint {
    let Radians(theta) = body.pose.theta;
    let there = Footprint { pose: Pose { theta: Radians(theta + turn.0), ..body.pose }, ..*body };
    let reach = body.form.moved(0.0, turn) + LED_OFF;
    if walls.gap(&there, reach) >= 0.0 {
        return there;
    }
    let Some(normal) = walls.contact(body, reach).and_then(normal) else { return *body };
    // Twice the distance that a corner moves, because the side that turns into the obstacle may be slanted.
    let pushed = |part: f64| {
        let push = 2.0 * reach * part;
        moved(&there, Point { x: there.pose.x.0 + push * normal.x, y: there.pose.y.0 + push * normal.y })
    };
    let free = |part: f64| walls.gap(&pushed(part), reach) >= 0.0;
    if free(1.0) { pushed(1.0 - last_free(|part| free(1.0 - part))) } else { *body }
}

fn moved(body: &Footprint, to: Point) -> Footprint {
    Footprint { pose: Pose { x: Meters(to.x), y: Meters(to.y), ..body.pose }, ..*body }
}

/// Returns the unit vector that points away from the surface of a contact; `None` if the nearest points of body and
/// surface coincide.
fn normal(contact: Contact) -> Option<Point> {
    let Contact { place, body, .. } = contact;
    let (x, y) = (body.x - place.x, body.y - place.y);
    let length = libm::hypot(x, y);
    (length > 0.0).then(|| Point { x: x / length, y: y / length })
}

/// Returns the largest fraction of a step, to a millionth, after which the body still overlaps no obstacle; 0 if there
/// is no such fraction.
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
