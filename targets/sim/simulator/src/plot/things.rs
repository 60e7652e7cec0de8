//! Draws the moving objects of a world. Doors are drawn as dashed lines; other objects are drawn at their last
//! position, with the path that they follow.

use svg::node::element::{Group, Path};

use super::film::{Film, changes};
use super::layout::Layout;
use super::shapes::{Pixel, polyline, tenths};
use crate::frames::FilmFrame;
use crate::moving::{Schedule, Thing};
use crate::point::Point;
use crate::trail::Trail;
use crate::world::World;

/// Dash pattern of doors.
const DASHES: &str = "5 4";
/// Displacement of an object that has not moved.
const NOWHERE: Point = Point { x: 0.0, y: 0.0 };

/// A symbol that the legend explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sign {
    Door,
    Moves,
}

impl Sign {
    fn of(thing: &Thing) -> Self {
        match thing.schedule {
            Schedule::Open { .. } => Self::Door,
            Schedule::Way { .. } => Self::Moves,
        }
    }

    /// Draws the symbol around height 0.
    pub(super) fn drawn(self, x: f64) -> Group {
        match self {
            Self::Door => Group::new().add(door([(x - 9.0, 0.0), (x + 9.0, 0.0)])),
            Self::Moves => {
                let corners = [(x - 4.0, -4.0), (x + 4.0, -4.0), (x + 4.0, 4.0), (x - 4.0, 4.0), (x - 4.0, -4.0)];
                Group::new().add(way([(x - 10.0, 0.0), (x + 10.0, 0.0)])).add(outline(corners))
            }
        }
    }

    /// Returns the meaning of the symbol.
    pub(super) fn meaning(self) -> &'static str {
        match self {
            Self::Door => "door",
            Self::Moves => "moves",
        }
    }
}

/// Returns the symbols of the moving objects in the part of the floor that is shown.
pub(super) fn signs(layout: &Layout, world: &World) -> impl Iterator<Item = Sign> {
    let shown = |thing: &&Thing| layout.shows_any(thing.places());
    let shown: Vec<Sign> = world.things.iter().filter(shown).map(Sign::of).collect();
    [Sign::Door, Sign::Moves].into_iter().filter(move |sign| shown.contains(sign))
}

/// Draws all moving objects at their last positions.
pub(super) fn drawn(layout: &Layout, world: &World, trail: &Trail) -> Group {
    let things = world.things.iter().zip(&trail.things);
    things.fold(ways(layout, world), |group, (thing, gone)| match Sign::of(thing) {
        Sign::Door => group.add(door(pixels(layout, thing, NOWHERE))),
        Sign::Moves => group.add(outline(pixels(layout, thing, gone.unwrap_or(NOWHERE)))),
    })
}

/// Draws all moving objects, with their motion.
pub(super) fn moving(layout: &Layout, world: &World, trail: &Trail, film: &Film<'_>) -> Group {
    let things = world.things.iter().zip(&trail.things).enumerate();
    things.fold(ways(layout, world), |group, (number, (thing, end))| {
        let gone = |frame: &FilmFrame| frame.things.get(number).copied().flatten();
        match Sign::of(thing) {
            Sign::Door => {
                let seen = |gone: Option<Point>| if gone.is_some() { "visible" } else { "hidden" };
                let values = film.frames.iter().map(|frame| (frame.t, seen(gone(frame)).to_owned()));
                let closed = polyline(pixels(layout, thing, NOWHERE)).set("class", "ink").set("stroke-width", 3);
                let closed = closed.set("visibility", seen(*end)).add(film.switch("visibility", changes(values)));
                group.add(door(pixels(layout, thing, NOWHERE))).add(closed)
            }
            Sign::Moves => {
                let by = |gone: Option<Point>| {
                    let Point { x, y } = gone.unwrap_or(NOWHERE);
                    format!("{} {}", tenths(x * layout.scale), tenths(-y * layout.scale))
                };
                let values = film.frames.iter().map(|frame| (frame.t, by(gone(frame))));
                let moved = Group::new().set("transform", format!("translate({})", by(*end)));
                let there = outline(pixels(layout, thing, NOWHERE));
                group.add(moved.add(there).add(film.transform("translate", bends(values))))
            }
        }
    })
}

fn pixels(layout: &Layout, thing: &Thing, gone: Point) -> impl Iterator<Item = Pixel> {
    thing.corners(gone).map(|place| layout.at(place))
}

/// Draws the paths of all moving objects that follow a path.
fn ways(layout: &Layout, world: &World) -> Group {
    let moving = world.things.iter().filter(|thing| Sign::of(thing) == Sign::Moves);
    moving.fold(Group::new(), |group, thing| group.add(way(thing.way().map(|place| layout.at(place)))))
}

fn way(pixels: impl IntoIterator<Item = Pixel>) -> Path {
    polyline(pixels).set("class", "faint")
}

fn door(pixels: impl IntoIterator<Item = Pixel>) -> Path {
    polyline(pixels).set("class", "ink").set("stroke-width", 1.5).set("stroke-dasharray", DASHES)
}

fn outline(pixels: impl IntoIterator<Item = Pixel>) -> Path {
    polyline(pixels).set("class", "ink solid").set("stroke-width", 1.5)
}

/// Returns the values without each value that equals both the previous and the next value.
fn bends<T>(values: impl Iterator<Item = (T, String)>) -> impl Iterator<Item = (T, String)> {
    let mut values = values.peekable();
    let mut last: Option<String> = None;
    std::iter::from_fn(move || {
        loop {
            let (t, value) = values.next()?;
            let before = last.replace(value.clone());
            if before.as_ref() != Some(&value) || values.peek().is_none_or(|(_, next)| *next != value) {
                return Some((t, value));
            }
        }
    })
}
