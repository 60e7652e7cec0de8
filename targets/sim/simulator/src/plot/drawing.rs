//! The picture of a finished run: the floor, the driven path in the colours of the atoms, echoes and contacts, and the
//! legend.

use std::collections::BTreeSet;

use mdle_runtime::{Meters, Pose};
use svg::Document;
use svg::node::element::{Group, Path, Style, Title};

use super::colours::{class, style};
use super::layout::Layout;
use super::rows::ROWS_MOST;
use super::shapes::{Pixel, RADIUS, badge, circle, cross, dots, line, simplified, tenths, through};
use super::sizes::{LEFT, MARGIN};
use super::{floor, labels, legend, things};
use crate::footprint::{Footprint, Form};
use crate::point::Point;
use crate::trail::{Companion, Trail};
use crate::world::World;

/// Maximum distance, in pixels, between two points of the driven path that callouts must not cover.
const STEP: f64 = 6.0;

/// Side length, in pixels, of the squares in which at most one echo is drawn.
const SQUARE: f64 = 8.0;

/// Draws `trail` on the floor of `world` as an SVG picture.
pub(crate) fn svg(world: &World, trail: &Trail) -> String {
    let layout = Layout::of(world, trail);
    let document = document(&layout, layout.height)
        .add(floor::drawn(&layout, world, layout.height))
        .add(floor::clipped().add(things::drawn(&layout, world, trail)).add(echoes(&layout, trail)))
        .add(body(&layout, &trail.start, trail.form, "faint"))
        .add(way(&layout, trail))
        .add(contacts(&layout, trail))
        .add(body(&layout, &trail.here, trail.form, "ink"));
    let document = trail.companions.iter().fold(document, |document, Companion { form, start, here }| {
        document.add(body(&layout, start, *form, "faint")).add(body(&layout, here, *form, "ink"))
    });
    let document = document.add(marks(&layout, trail)).add(legend::drawn(&layout, world, trail));
    format!("{document}\n")
}

/// Returns an empty picture of this height.
pub(super) fn document(layout: &Layout, height: f64) -> Document {
    let size = (0, 0, tenths(layout.width()), tenths(height));
    let document = Document::new().set("viewBox", size).set("width", size.2).set("height", size.3);
    let document = document.set("font-family", "sans-serif").set("font-size", 14);
    document.add(Title::new(&layout.title.whole)).add(Style::new(style()))
}

/// Draws the echoes. In each small square, at most one echo is drawn, because more could not be distinguished.
fn echoes(layout: &Layout, trail: &Trail) -> Path {
    let shown = trail.echoes.iter().filter(|place| layout.shows_any([**place].into_iter()));
    let mut squares = BTreeSet::new();
    let square = |pixels: f64| libm::floor(pixels / SQUARE) as i64;
    let apart = shown.map(|place| layout.at(*place)).filter(|(x, y)| squares.insert((square(*x), square(*y))));
    let path = Path::new().set("d", dots(apart)).set("fill", "none");
    path.set("class", "echo").set("stroke-opacity", 0.55).set("stroke-width", 1.6).set("stroke-linecap", "round")
}

/// Draws the path that was driven by each atom of the plan's text. One SVG path contains all passes of an atom.
fn way(layout: &Layout, trail: &Trail) -> Group {
    let data = |way: &[Point]| through(simplified(way.iter().map(|place| layout.at(*place))));
    let ways = &trail.ways;
    let mut before = data(&ways.before);
    let mut atoms = vec![String::new(); ways.atoms.len()];
    for mark in ways.marks.iter().filter(|mark| mark.way.len() > 1) {
        *mark.atom.and_then(|atom| atoms.get_mut(atom)).unwrap_or(&mut before) += &data(&mark.way);
    }
    let path = |data: &str| Path::new().set("d", data).set("fill", "none");
    let group = Group::new().set("stroke-width", 2.5).set("stroke-linejoin", "round").set("stroke-linecap", "round");
    let group = group.add(path(&before).set("class", "faint"));
    let driven = atoms.iter().enumerate().filter(|(_, data)| !data.is_empty());
    driven.fold(group, |group, (atom, data)| group.add(path(data).set("class", class("way", atom))))
}

/// Draws the body as a disc or a rectangle, with a line to its front.
pub(super) fn body(layout: &Layout, pose: &Pose, form: Form, class: &str) -> Group {
    let centre = layout.at(Point::of(pose));
    let front = layout.at(Point::of(&pose.towards(pose.theta, Meters(form.halves().0))));
    let group = Group::new().set("class", class).set("stroke-width", 1.2);
    let group = match form {
        Form::Disc { radius } => group.add(circle(centre, radius * layout.scale).set("fill", "none")),
        Form::Rectangle { .. } => {
            let footprint = Footprint { pose: *pose, form };
            let corners = footprint.sides().map(|side| layout.at(side.from));
            group.add(Path::new().set("d", through(corners) + "z").set("fill", "none"))
        }
    };
    group.add(line(centre, front))
}

/// Draws a cross at each position of a contact with an obstacle.
fn contacts(layout: &Layout, trail: &Trail) -> Group {
    let touched = trail.contacts.iter().map(|(place, _)| cross(layout.at(*place)));
    touched.fold(Group::new(), Group::add)
}

/// Draws a callout for each atom of the plan's text, at the position where the atom first began.
fn marks(layout: &Layout, trail: &Trail) -> Group {
    let atoms = || trail.ways.atoms.iter().take(ROWS_MOST);
    let dots: Vec<Pixel> = atoms().map(|atom| layout.at(atom.place)).collect();
    let mut ways: Vec<Pixel> = Vec::new();
    for pixel in trail.places().map(|place| layout.at(place)) {
        if ways.last().is_none_or(|last| libm::hypot(last.0 - pixel.0, last.1 - pixel.1) >= STEP) {
            ways.push(pixel);
        }
    }
    let room = ((MARGIN + LEFT, layout.chart - MARGIN), (layout.top, layout.bottom()));
    let labels = labels::placed(&dots, &ways, room);
    let mut lines = Group::new().set("class", "ink").set("stroke-width", 1);
    let mut group = Group::new().set("stroke-width", 1.5);
    for ((number, atom), (dot, label)) in atoms().enumerate().zip(dots.iter().zip(&labels)) {
        lines = lines.add(line(*dot, *label));
        let dot = circle(*dot, labels::DOT).set("class", format!("{} halo", class("disc", number)));
        let halo = circle(*label, RADIUS + 0.5).set("fill", "none").set("class", "halo");
        group = group.add(dot).add(badge(*label, &atom.number.to_string(), number)).add(halo);
    }
    Group::new().add(lines).add(group)
}
