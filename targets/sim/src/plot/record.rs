//! The picture that moves: the way is drawn as it was driven, the robot drives it, and the running atom is told.
//!
//! Everything repeats together, after a moment of rest. A viewer that moves nothing shows the end of the run.

use mdle_runtime::{Pose, Radians};
use svg::node::element::{Group, Path, Rectangle};

use super::colours::{self, FAINT, GRID, INK};
use super::drawing::{body, document};
use super::film::Film;
use super::layout::{LEFT, LETTERS, LINE, Layout, MARGIN, MARKS_MOST, shortened};
use super::shapes::{Pixel, badge, circle, cross, dots, line, polyline, tenths, text};
use super::{floor, labels, legend, things};
use crate::frames::{Frame, Frames};
use crate::trail::Trail;
use crate::world::{Place, World};

/// The height of what is below the floor: the running atom, and the time.
const STRIP: f64 = 62.0;

/// The moving picture of a trail on the floor of `world`.
pub(crate) fn animated(world: &World, trail: &Trail) -> String {
    let layout = Layout::of(world, trail);
    let frames = trail.frames.as_ref().map(Frames::all).unwrap_or_default();
    let film = Film::of(&frames, trail);
    let document = document(&layout, layout.height + STRIP, "The robot drives on its floor")
        .add(floor::drawn(&layout, world, layout.height + STRIP))
        .add(things::moving(&layout, world, trail, &film))
        .add(body(&layout, &trail.start, trail.radius, FAINT))
        .add(ways(&layout, trail, &film))
        .add(echoes(&layout, &film))
        .add(contacts(&layout, trail, &film))
        .add(robot(&layout, &film, trail))
        .add(highlight(&layout, &film))
        .add(legend::drawn(&layout, world, trail))
        .add(strip(&layout, trail, &film));
    format!("{document}\n")
}

/// The way of each atom, which grows while it runs.
fn ways(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Group {
    let group = Group::new().set("stroke-width", 2.5).set("stroke-linejoin", "round").set("fill", "none");
    film.acts.iter().fold(group, |group, act| {
        let frames = film.of_act(act);
        let pixels: Vec<Pixel> = frames.iter().map(|frame| layout.at(Place::of(&frame.pose))).collect();
        let lengths: Vec<f64> = pixels
            .iter()
            .zip(pixels.iter().skip(1))
            .scan(0.0, |length, (one, other)| {
                *length += libm::hypot(one.0 - other.0, one.1 - other.1);
                Some(*length)
            })
            .collect();
        let Some(length) = lengths.last().copied().filter(|length| *length >= 0.5) else { return group };
        // A dash longer than the way, which comes in from before its beginning, and a gap as long behind it.
        let dash = libm::ceil(length) + 1.0;
        let left = [0.0].iter().chain(&lengths).map(|driven| format!("{}", tenths(dash - driven)));
        let times = frames.iter().map(|frame| frame.t);
        let grows = film.animate("stroke-dashoffset", times.zip(left));
        // The way itself is smoother than its moments. Its length is counted as theirs is.
        let driven = film.way(act, trail).map(|places| places.into_iter().map(|place| layout.at(place)).collect());
        let way = polyline::<Vec<Pixel>>(driven.unwrap_or(pixels)).set("pathLength", tenths(length));
        let way = way.set("stroke", act.mark.map_or(FAINT, colours::of));
        group.add(way.set("stroke-dasharray", dash).add(grows))
    })
}

/// What the sonars hear just now.
fn echoes(layout: &Layout, film: &Film<'_>) -> Path {
    let heard = |frame: &Frame| {
        let shown = frame.echoes.iter().flatten().filter(|place| layout.shows(**place));
        let data = dots(shown.map(|place| layout.at(*place)));
        if data.is_empty() { "m0 0".to_owned() } else { data }
    };
    let values = film.frames.iter().map(|frame| (frame.t, heard(frame)));
    let path = Path::new().set("stroke", INK).set("stroke-width", 4).set("stroke-linecap", "round");
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

/// The body, which drives and turns.
fn robot(layout: &Layout, film: &Film<'_>, trail: &Trail) -> Group {
    let at = |pose: &Pose| {
        let (x, y) = layout.at(Place::of(pose));
        format!("{} {}", tenths(x), tenths(y))
    };
    let places = film.frames.iter().map(|frame| (frame.t, at(&frame.pose)));
    // Headings go on beyond a full turn, so that what is between two of them is the shorter way.
    let mut heading: Option<Radians> = None;
    let headings = film.frames.iter().map(|frame| {
        let before = heading.unwrap_or(frame.pose.theta);
        let now = Radians(before.0 + Radians(frame.pose.theta.0 - before.0).wrapped().0);
        heading = Some(now);
        // Heights count downwards in a picture, and so do angles.
        (frame.t, format!("{}", tenths(-now.degrees())))
    });
    let turns = film.transform("rotate", headings);
    let drives = film.transform("translate", places);
    let radius = trail.radius * layout.scale;
    let disc = circle((0.0, 0.0), radius).set("fill", "#ffffff").set("fill-opacity", 0.75);
    let front = line((0.0, 0.0), (radius, 0.0));
    let turned = Group::new().set("transform", format!("rotate({})", tenths(-trail.here.theta.degrees())));
    let turned = turned.add(disc).add(front).add(turns);
    let moved = Group::new().set("transform", format!("translate({})", at(&trail.here))).set("stroke", INK);
    moved.set("stroke-width", 1.8).add(turned).add(drives)
}

/// The line of the legend whose atom runs.
fn highlight(layout: &Layout, film: &Film<'_>) -> Rectangle {
    let y = |mark: Option<usize>| format!("{}", layout.line(mark.unwrap_or(0).min(MARKS_MOST)) - LINE / 2.0);
    let values = film.acts.iter().map(|act| (act.from, y(act.mark)));
    let bar = Rectangle::new().set("x", layout.chart - 6.0).set("width", layout.legend - MARGIN + 12.0);
    let bar = bar.set("height", LINE).set("rx", 4).set("fill", GRID);
    bar.set("y", y(film.acts.last().and_then(|act| act.mark))).add(film.switch("y", values))
}

/// The running atom, and the time as a line of the colours of the atoms.
fn strip(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Group {
    let (left, right) = (MARGIN + LEFT, layout.width() - MARGIN);
    let (above, below) = (layout.height + 4.0, layout.height + 34.0);
    let at = |t| left + (right - left) * film.part(t);
    let mut group = Group::new().set("font-size", LETTERS).set("fill", INK);
    for act in &film.acts {
        let Some(mark) = act.mark.and_then(|number| trail.marks.get(number)) else { continue };
        let number = act.mark.unwrap_or_default();
        let (from, to) = (at(act.from), at(act.to));
        let part = Rectangle::new().set("x", tenths(from)).set("width", tenths((to - from).max(0.5)));
        group = group.add(part.set("y", below - 4.0).set("height", 8).set("fill", colours::of(number)));
        let ends = (act.to < film.end()).then_some(act.to);
        let told = Group::new()
            .set("visibility", if ends.is_none() { "visible" } else { "hidden" })
            .add(badge((left + labels::RADIUS, above), &mark.state.to_string(), number))
            .add(text(&shortened(&mark.law), (left + 2.0 * labels::RADIUS + 10.0, above), "start"))
            .add(film.visible(act.from, ends));
        group = group.add(told);
    }
    let values = film.frames.iter().map(|frame| (frame.t, format!("{} 0", tenths(at(frame.t)))));
    let cursor = polyline([(0.0, below - 9.0), (0.0, below + 9.0)]).set("stroke", INK).set("stroke-width", 2.5);
    let cursor = cursor.set("transform", format!("translate({} 0)", tenths(right)));
    let ends = format!("{:.1} s", film.end().seconds());
    let fast = if film.times > 1.0 { format!("{} times as fast", film.times) } else { "as fast as it was".into() };
    group.add(cursor.add(film.transform("translate", values))).add(text("0 s", (left - 8.0, below), "end")).add(text(
        &format!("{ends}, shown {fast}"),
        (right, above),
        "end",
    ))
}
