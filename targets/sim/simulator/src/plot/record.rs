//! Draws the animation of a run. The path grows as the robot drives along it, and a text names the running atom.
//!
//! All animations repeat together, after a pause. A viewer without animations shows the end of the run. A viewer that
//! runs scripts also shows the time, a pause button, and a strip for seeking.

use mdle_runtime::{Pose, Radians};
use svg::node::element::{Group, Path, Rectangle, Script};

use super::colours::class;
use super::drawing::{body, document};
use super::film::Film;
use super::layout::{LINE, Layout};
use super::shapes::{Pixel, circle, cross, dots, line, polyline, simplified, tenths, through};
use super::sizes::MARGIN;
use super::strip::{STRIP, strip};
use super::{floor, legend, things};
use crate::footprint::Form;
use crate::frames::{FilmFrame, Frames};
use crate::point::Point;
use crate::trail::Trail;
use crate::world::World;

/// Script that shows the time, pauses and seeks. It contains no characters that would have to be escaped in XML.
const SCRIPT: &str = include_str!("film.js");

/// Draws the animation of `trail` on the floor of `world`.
pub(crate) fn animated(world: &World, trail: &Trail) -> String {
    let layout = Layout::of(world, trail);
    let frames = trail.frames.as_ref().map(Frames::all).unwrap_or_default();
    let film = Film::of(&frames, trail);
    let document = document(&layout, layout.height + STRIP)
        .add(floor::drawn(&layout, world, layout.height + STRIP))
        .add(floor::clipped().add(things::moving(&layout, world, trail, &film)))
        .add(body(&layout, &trail.start, trail.form, "faint"))
        .add(ways(&layout, trail, &film))
        .add(echoes(&layout, &film))
        .add(contacts(&layout, trail, &film))
        .add(robot(&layout, &film, trail))
        .add(highlight(&layout, trail, &film))
        .add(legend::drawn(&layout, world, trail))
        .add(strip(&layout, trail, &film))
        .add(Script::new(SCRIPT));
    format!("{document}\n")
}

/// Returns the path that each atom has driven. The path grows while the atom runs.
fn ways(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Group {
    let group = Group::new().set("stroke-width", 2.5).set("stroke-linejoin", "round").set("fill", "none");
    film.acts.iter().fold(group, |group, act| {
        let frames = film.of_act(act);
        let moments: Vec<Pixel> = frames.iter().map(|frame| layout.at(Point::of(&frame.pose))).collect();
        let at_moments = lengths(&moments);
        // The recorded path has more positions than the frames.
        let driven: Option<Vec<Pixel>> =
            film.way(act, trail).map(|places| places.into_iter().map(|place| layout.at(place)).collect());
        let driven = simplified(driven.unwrap_or(moments));
        let Some(length) = lengths(&driven).last().copied().filter(|length| *length >= 0.5) else { return group };
        // A dash longer than the path, shifted in from before its beginning, and a gap of the same length after it.
        let dash = libm::ceil(length) + 1.0;
        let left = |part: f64| format!("{}", tenths(dash - length * part));
        let grows = match at_moments.last().filter(|all| **all > 0.0) {
            Some(all) => {
                let times = frames.iter().map(|frame| frame.t);
                film.animate("stroke-dashoffset", times.zip(at_moments.iter().map(|driven| left(driven / all))))
            }
            None => film.animate("stroke-dashoffset", [(act.from, left(0.0)), (act.to, left(1.0))].into_iter()),
        };
        let way =
            polyline(driven).set("class", Film::atom(act, trail).map_or("faint".into(), |atom| class("way", atom)));
        group.add(way.set("stroke-dasharray", dash).add(grows))
    })
}

/// Returns the length of a line up to each of its points.
fn lengths(pixels: &[Pixel]) -> Vec<f64> {
    let steps = pixels.iter().zip(pixels.iter().skip(1));
    let steps = steps.scan(0.0, |length, (one, other)| {
        *length += libm::hypot(one.0 - other.0, one.1 - other.1);
        Some(*length)
    });
    [0.0].into_iter().take(pixels.len()).chain(steps).collect()
}

/// Draws the echoes of each frame.
fn echoes(layout: &Layout, film: &Film<'_>) -> Path {
    let heard = |frame: &FilmFrame| {
        let shown = frame.echoes.iter().flatten().filter(|place| layout.shows_any([**place].into_iter()));
        let data = dots(shown.map(|place| layout.at(*place)));
        if data.is_empty() { "m0 0".to_owned() } else { data }
    };
    let values = film.frames.iter().map(|frame| (frame.t, heard(frame)));
    let path = Path::new().set("class", "ink").set("stroke-width", 4).set("stroke-linecap", "round");
    let path = path
        .set("stroke-opacity", 0.6)
        .set("fill", "none")
        .set("d", film.frames.last().map_or_else(String::new, heard));
    path.add(film.switch("d", values))
}

fn contacts(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Group {
    trail.contacts.iter().fold(Group::new(), |group, (place, t)| {
        let cross = cross(layout.at(*place));
        group.add(cross.add(film.visible(*t, None)))
    })
}

/// Draws the body, with animations of its position and heading.
fn robot(layout: &Layout, film: &Film<'_>, trail: &Trail) -> Group {
    let at = |pose: &Pose| {
        let (x, y) = layout.at(Point::of(pose));
        format!("{} {}", tenths(x), tenths(y))
    };
    let places = film.frames.iter().map(|frame| (frame.t, at(&frame.pose)));
    // Headings are unwrapped beyond a full turn, so that the animation turns the shorter way.
    let mut heading: Option<Radians> = None;
    let headings = film.frames.iter().map(|frame| {
        let before = heading.unwrap_or(frame.pose.theta);
        let now = Radians(before.0 + Radians(frame.pose.theta.0 - before.0).wrapped().0);
        heading = Some(now);
        // In a picture, the vertical axis points down, which inverts angles.
        (frame.t, format!("{}", tenths(-now.degrees())))
    });
    let turns = film.transform("rotate", headings);
    let drives = film.transform("translate", places);
    let (x, y) = trail.form.halves();
    let (x, y) = (x * layout.scale, y * layout.scale);
    let front = line((0.0, 0.0), (x, 0.0));
    let turned = Group::new().set("transform", format!("rotate({})", tenths(-trail.here.theta.degrees())));
    let turned = match trail.form {
        Form::Disc { .. } => turned.add(circle((0.0, 0.0), x).set("class", "paper").set("fill-opacity", 0.75)),
        Form::Rectangle { .. } => {
            let data = through([(x, y), (-x, y), (-x, -y), (x, -y)]) + "z";
            turned.add(Path::new().set("d", data).set("class", "paper").set("fill-opacity", 0.75))
        }
    };
    let turned = turned.add(front).add(turns);
    let moved = Group::new().set("transform", format!("translate({})", at(&trail.here))).set("class", "ink");
    moved.set("stroke-width", 1.8).add(turned).add(drives)
}

/// Draws the highlight of the running atom's line in the legend.
fn highlight(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Rectangle {
    let y = |atom: Option<usize>| format!("{}", tenths(layout.line_of(atom.unwrap_or(0)) - LINE / 2.0));
    let values = film.acts.iter().map(|act| (act.from, y(Film::atom(act, trail))));
    let bar = Rectangle::new().set("x", layout.chart - 6.0).set("width", layout.legend - MARGIN + 12.0);
    let bar = bar.set("height", LINE).set("rx", 4).set("class", "shade");
    bar.set("y", y(film.acts.last().and_then(|act| Film::atom(act, trail)))).add(film.switch("y", values))
}
