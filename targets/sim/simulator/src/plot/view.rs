//! The part of the floor that a plot shows: the driven path, and the floor around it.

use crate::trail::Trail;
use crate::world::World;

/// Margin around walls, in metres.
const AROUND: f64 = 0.4;
/// Margin around the driven path, in metres. It is smaller where the world ends.
const ROOM: f64 = 2.0;
/// Minimum fraction of the world's area that a view must cover so that the whole world is shown instead of the view.
const MOST: f64 = 0.5;

/// A rectangle of the floor, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FloorView {
    pub(super) x: (f64, f64),
    pub(super) y: (f64, f64),
}

impl FloorView {
    /// Returns the view of the driven path with the floor around it. If the world is at most twice as large as this
    /// view, returns the whole world.
    pub(super) fn of(world: &World, trail: &Trail) -> Self {
        // Without a world, the view is based on the echoes that the robot has heard.
        let heard = || trail.echoes.iter().copied().filter(|_| world.places().next().is_none());
        let places = || world.places().chain(trail.places()).chain(heard());
        let all = Self { x: range(places().map(|place| place.x)), y: range(places().map(|place| place.y)) };
        let way = Self { x: range(trail.places().map(|place| place.x)), y: range(trail.places().map(|place| place.y)) };
        let all = Self { x: grown(all.x, AROUND), y: grown(all.y, AROUND) };
        let near = Self { x: within(grown(way.x, ROOM), all.x), y: within(grown(way.y, ROOM), all.y) };
        if near.area() >= MOST * all.area() { all } else { near }
    }

    fn area(&self) -> f64 {
        (self.x.1 - self.x.0) * (self.y.1 - self.y.0)
    }
}

/// Returns the minimum and the maximum of `coordinates`.
pub(super) fn range(coordinates: impl Iterator<Item = f64>) -> (f64, f64) {
    coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), coordinate| {
        (least.min(coordinate), most.max(coordinate))
    })
}

fn grown((least, most): (f64, f64), by: f64) -> (f64, f64) {
    (least - by, most + by)
}

fn within((least, most): (f64, f64), (low, high): (f64, f64)) -> (f64, f64) {
    (least.max(low), most.min(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::footprint::{Footprint, Form};
    use mdle_runtime::{Meters, Pose};

    fn view(world: &str, to: f64) -> FloorView {
        let mut trail = Trail::from(&Footprint { pose: Pose::ORIGIN, form: Form::SCOUT });
        trail.went(&Pose { x: Meters(to), ..Pose::ORIGIN });
        FloorView::of(&World::parse("a world", world).expect("a good world"), &trail)
    }

    #[test]
    fn a_short_way_in_a_large_hall_is_shown_large() {
        let hall = "[[wall]]\npoints = [[-1, -9], [30, -9], [30, 9], [-1, 9]]";
        assert_eq!(view(hall, 3.0), FloorView { x: (-1.4, 5.0), y: (-2.0, 2.0) });
        assert_eq!(view(hall, 28.0), FloorView { x: (-1.4, 30.0), y: (-2.0, 2.0) });
    }

    #[test]
    fn a_small_room_is_shown_whole() {
        let room = "[[wall]]\npoints = [[-1, -2], [5, -2], [5, 3], [-1, 3]]";
        assert_eq!(view(room, 3.0), FloorView { x: (-1.4, 5.4), y: (-2.4, 3.4) });
        assert_eq!(view("", 3.0), FloorView { x: (-0.4, 3.4), y: (-0.4, 0.4) });
    }
}
