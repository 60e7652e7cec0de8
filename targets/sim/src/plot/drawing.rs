//! The picture of a run that is over: the floor, the way coloured by atom, what was heard and touched, and the legend.

use mdle_runtime::{Meters, Pose};
use svg::Document;
use svg::node::element::{Group, Path, Title};

use super::colours::{self, ECHO, FAINT, INK};
use super::layout::{Layout, MARKS_MOST};
use super::shapes::{Pixel, badge, circle, cross, dots, line, polyline, tenths};
use super::{floor, labels, legend, things};
use crate::trail::Trail;
use crate::world::{Place, World};

/// The plot of a trail on the floor of `world`.
pub(crate) fn svg(world: &World, trail: &Trail) -> String {
    let layout = Layout::of(world, trail);
    let dots = began(&layout, trail);
    let document = document(&layout, layout.height, "The way of the robot on its floor")
        .add(floor::drawn(&layout, world, layout.height))
        .add(things::drawn(&layout, world, trail))
        .add(echoes(&layout, trail))
        .add(body(&layout, &trail.start, trail.radius, FAINT))
        .add(way(&layout, trail))
        .add(contacts(&layout, trail))
        .add(body(&layout, &trail.here, trail.radius, INK))
        .add(marks(&layout, &dots))
        .add(legend::drawn(&layout, world, trail));
    format!("{document}\n")
}

/// An empty picture of this height.
pub(super) fn document(layout: &Layout, height: f64, title: &str) -> Document {
    let size = (0, 0, tenths(layout.width()), tenths(height));
    let document = Document::new().set("viewBox", size).set("width", size.2).set("height", size.3);
    document.set("font-family", "sans-serif").set("font-size", 14).add(Title::new(title))
}

fn echoes(layout: &Layout, trail: &Trail) -> Path {
    let places = trail.echoes.iter().filter(|place| layout.shows(**place)).map(|place| layout.at(*place));
    let path = Path::new().set("d", dots(places)).set("fill", "none").set("stroke", ECHO).set("stroke-opacity", 0.55);
    path.set("stroke-width", 1.6).set("stroke-linecap", "round")
}

/// The way of each atom, on white so that it stays apart from what it crosses.
fn way(layout: &Layout, trail: &Trail) -> Group {
    let line = |way: &[Place]| polyline(way.iter().map(|place| layout.at(*place)));
    let group = Group::new().set("stroke-width", 2.5).set("stroke-linejoin", "round").set("stroke-linecap", "round");
    let group = group.add(line(&trail.before).set("stroke", FAINT));
    let ways = trail.marks.iter().enumerate().filter(|(_, mark)| mark.way.len() > 1);
    ways.fold(group, |group, (number, mark)| group.add(line(&mark.way).set("stroke", colours::of(number))))
}

/// The body: a disc with a line to its front.
pub(super) fn body(layout: &Layout, pose: &Pose, radius: f64, colour: &str) -> Group {
    let centre = layout.at(Place::of(pose));
    let front = layout.at(Place::of(&pose.towards(pose.theta, Meters(radius))));
    let disc = circle(centre, radius * layout.scale).set("fill", "none");
    Group::new().set("stroke", colour).set("stroke-width", 1.2).add(disc).add(line(centre, front))
}

/// A cross where the body touched something.
fn contacts(layout: &Layout, trail: &Trail) -> Group {
    let touched = trail.contacts.iter().map(|(place, _)| cross(layout.at(*place)));
    touched.fold(Group::new(), Group::add)
}

/// Where each of the atoms that are marked began.
fn began(layout: &Layout, trail: &Trail) -> Vec<Pixel> {
    let begins = trail.marks.iter().take(MARKS_MOST).filter_map(|mark| mark.way.first());
    begins.map(|place| layout.at(*place)).collect()
}

fn marks(layout: &Layout, dots: &[Pixel]) -> Group {
    let labels = labels::placed(dots, (layout.chart, layout.bottom()));
    let mut lines = Group::new().set("stroke", FAINT);
    let mut group = Group::new();
    for (number, (dot, label)) in dots.iter().zip(&labels).enumerate() {
        let state = layout.lines.get(number).map_or("", |(state, _, _)| state);
        lines = lines.add(line(*dot, *label));
        let dot = circle(*dot, labels::DOT).set("fill", colours::of(number));
        group = group.add(dot).add(badge(*label, state, number));
    }
    Group::new().add(lines).add(group)
}
