//! The floor of a plot: axes in metres, walls and boxes, and the zone in which a run has to end.

use svg::node::element::{ClipPath, Group, Path, Rectangle};

use super::layout::{Layout, round_step};
use super::shapes::{Pixel, circle, line, polyline, tenths, text, through};
use super::sizes::{LEFT, MARGIN};
use crate::goal::Zone;
use crate::outline::Outline;
use crate::point::Point;
use crate::world::World;

/// Minimum distance between two labels of an axis, in pixels.
const APART: f64 = 50.0;

/// Name of the region to which all drawings on the floor are clipped.
const REGION: &str = "floor";

/// Returns the background of a picture of this height, with its title and the axes of its floor.
pub(super) fn drawn(layout: &Layout, world: &World, height: f64) -> Group {
    let background = Rectangle::new().set("width", layout.width()).set("height", height).set("class", "paper");
    let region = ClipPath::new().set("id", REGION).add(
        Rectangle::new()
            .set("x", MARGIN + LEFT)
            .set("y", tenths(layout.top))
            .set("width", tenths(layout.chart - 2.0 * MARGIN - LEFT))
            .set("height", tenths(layout.bottom() - layout.top)),
    );
    Group::new()
        .add(region)
        .add(background)
        .add(layout.title.drawn())
        .add(axes(layout))
        .add(clipped().add(walls(layout, world)))
}

/// Returns a group that is clipped to the visible part of the floor.
pub(super) fn clipped() -> Group {
    Group::new().set("clip-path", format!("url(#{REGION})"))
}

fn axes(layout: &Layout) -> Group {
    let (left, right) = (MARGIN + LEFT, layout.chart - MARGIN);
    let (top, bottom) = (layout.top, layout.bottom());
    let step = round_step(APART / layout.scale);
    let mut grid = Group::new().set("class", "grid");
    let mut numbers = Group::new().set("font-size", 12);
    for x in multiples(layout.view.x, step) {
        let (at, _) = layout.at(Point { x, y: 0.0 });
        grid = grid.add(line((at, top), (at, bottom)));
        numbers = numbers.add(text(&number(x, step), (at, bottom + 13.0), "middle"));
    }
    for y in multiples(layout.view.y, step) {
        let (_, at) = layout.at(Point { x: 0.0, y });
        grid = grid.add(line((left, at), (right, at)));
        numbers = numbers.add(text(&number(y, step), (left - 8.0, at), "end"));
    }
    let middle = ((left + right) / 2.0, (top + bottom) / 2.0);
    let turned = format!("rotate(-90 {} {})", tenths(MARGIN - 4.0), tenths(middle.1));
    let names = Group::new()
        .set("font-size", 13)
        .add(text("x in m", (middle.0, bottom + 34.0), "middle"))
        .add(text("y in m", (MARGIN - 4.0, middle.1), "middle").set("transform", turned));
    let axis = polyline([(left, top), (left, bottom), (right, bottom)]).set("class", "faint");
    Group::new().add(grid).add(axis).add(numbers).add(names)
}

/// Returns the multiples of `step` in a range.
fn multiples((least, most): (f64, f64), step: f64) -> impl Iterator<Item = f64> {
    let first = libm::ceil(least / step) as i64;
    let last = libm::floor(most / step) as i64;
    (first..=last).map(move |times| times as f64 * step)
}

/// Formats a number for an axis, without unnecessary zeros.
fn number(value: f64, step: f64) -> String {
    let places = (-libm::floor(libm::log10(step * (1.0 + 1e-9)))).clamp(0.0, 9.0) as usize;
    // Adding zero turns a negative zero into a positive one.
    format!("{:.places$}", libm::round(value / step) * step + 0.0)
}

/// Draws a charger: the circle within which the centre of a robot has to be, with a lightning symbol in its centre.
pub(super) fn socket(circle: impl IntoIterator<Item = Pixel>, (x, y): Pixel) -> Group {
    let flash = format!("M{} {}l-5 9h4l-3 7l8 -10h-4l4 -6z", tenths(x + 1.0), tenths(y - 8.0));
    let flash = Path::new().set("d", flash).set("class", "ink charge").set("stroke-width", 1);
    Group::new().add(polyline(circle).set("class", "ink").set("stroke-dasharray", "3 2")).add(flash)
}

fn walls(layout: &Layout, world: &World) -> Group {
    let mut group = Group::new();
    match world.goal.map(|goal| goal.zone) {
        Some(Zone::Rectangle { min, max }) => {
            let (left, top) = layout.at(Point { x: min.x, y: max.y });
            let (right, bottom) = layout.at(Point { x: max.x, y: min.y });
            let zone = Rectangle::new().set("x", tenths(left)).set("y", tenths(top));
            let zone = zone.set("width", tenths(right - left)).set("height", tenths(bottom - top));
            group = group.add(zone.set("class", "goal"));
        }
        Some(Zone::Circle { center, radius }) => {
            group = group.add(circle(layout.at(center), radius * layout.scale).set("class", "goal"));
        }
        None => {}
    }
    if let Some(charger) = &world.charger {
        group = group.add(socket(charger.circle().map(|place| layout.at(place)), layout.at(Point::of(&charger.pose))));
    }
    // Combines all outlines in few paths: a map has many, and viewers draw few long paths faster than many short ones.
    let (contours, outlines) = world.outlines.split_at(world.contours.min(world.outlines.len()));
    let (boxes, walls): (Vec<&Outline>, Vec<&Outline>) = outlines.iter().partition(|outline| outline.solid);
    for (outlines, class) in [(contours.iter().collect(), "ink solid"), (boxes, "ink solid"), (walls, "ink")] {
        let outlines = outlines.into_iter().filter(|outline| layout.shows_any(outline.points.iter().copied()));
        let outlines = outlines.map(|outline| outline.points.iter().map(|place| layout.at(*place)));
        let data: String = outlines.map(through).collect();
        if !data.is_empty() {
            let path = Path::new().set("d", data).set("fill", "none").set("class", class).set("stroke-width", 3);
            group = group.add(path.set("stroke-linecap", "square"));
        }
    }
    group
}
