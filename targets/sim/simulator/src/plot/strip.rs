//! Draws the strip below an animation: the running atom, and the timeline in the colours of the atoms.

use mdle_runtime::Nanos;
use svg::node::element::{Group, Path, Rectangle, TSpan, Text};

use super::colours::class;
use super::film::{Act, Film};
use super::layout::{Layout, round_step};
use super::rows::shortened;
use super::shapes::RADIUS;
use super::shapes::{badge, line, polyline, tenths, text};
use super::sizes::{LEFT, LETTERS, MARGIN};
use crate::trail::Trail;

/// Height of the strip below the floor, in pixels. The strip contains the running atom and the time.
pub(super) const STRIP: f64 = 84.0;
/// Half the height of the timeline, in pixels.
const HALF: f64 = 5.0;
/// Minimum distance between two labels of the timeline, in pixels.
const APART: f64 = 70.0;
/// Half the height of the button's symbols, in pixels.
const BUTTON: f64 = 9.0;

/// Draws the strip of a film.
pub(super) fn strip(layout: &Layout, trail: &Trail, film: &Film<'_>) -> Group {
    let (left, right) = (MARGIN + LEFT, layout.width() - MARGIN);
    let (above, middle) = (layout.height + 4.0, layout.height + 36.0);
    let at = |t: Nanos| left + (right - left) * film.part(t);
    let values = film.frames.iter().map(|frame| (frame.t, format!("{} 0", tenths(at(frame.t)))));
    let cursor = polyline([(0.0, middle - 10.0), (0.0, middle + 10.0)]).set("class", "ink").set("stroke-width", 2.5);
    let cursor = cursor.set("transform", format!("translate({} 0)", tenths(right)));
    // The script uses these attributes to convert pixels to times; the area that accepts a pointer is higher than the
    // line.
    let area = Rectangle::new().set("x", left).set("y", middle - 14.0).set("width", tenths(right - left));
    let line = Group::new()
        .set("class", "strip")
        .set("data-left", left)
        .set("data-right", tenths(right))
        .set("data-end", film.end().seconds())
        .set("data-times", film.times)
        .set("data-round", film.duration())
        .add(area.set("height", 28).set("fill-opacity", 0))
        .add(times(trail, film, middle, at))
        .add(ticks(film, middle + HALF, at))
        .add(cursor.add(film.transform("translate", values)));
    let running = running(trail, film, (left + RADIUS, above));
    Group::new()
        .set("font-size", LETTERS)
        .add(running)
        .add(speed(film, (right, above)))
        .add(line)
        .add(button((left - 22.0, middle)))
}

/// Draws the timeline. Each run of an atom has the atom's colour.
fn times(trail: &Trail, film: &Film<'_>, middle: f64, at: impl Fn(Nanos) -> f64) -> Group {
    let mut data = vec![String::new(); trail.ways.atoms.len()];
    for act in &film.acts {
        if let Some(data) = Film::atom(act, trail).and_then(|atom| data.get_mut(atom)) {
            let (from, to) = (at(act.from), at(act.to));
            *data += &format!("M{} {}h{}", tenths(from), tenths(middle), tenths((to - from).max(0.5)));
        }
    }
    let paths = data.iter().enumerate().filter(|(_, data)| !data.is_empty());
    let group = Group::new().set("stroke-width", 2.0 * HALF).set("fill", "none");
    paths.fold(group, |group, (atom, data)| {
        group.add(Path::new().set("d", data.as_str()).set("class", class("way", atom)))
    })
}

/// Draws labels for round times below the timeline.
fn ticks(film: &Film<'_>, below: f64, at: impl Fn(Nanos) -> f64) -> Group {
    let end = film.end().seconds();
    let step = round_step((end * APART / (at(film.end()) - at(Nanos::ZERO))).max(0.1));
    let ticks = (0..=(end / step) as u32).map(|tick| f64::from(tick) * step);
    let group = Group::new().set("class", "faint").set("font-size", 12);
    ticks.fold(group, |group, seconds| {
        let x = at(Nanos((seconds * 1e9) as u64));
        let label = format!("{} s", libm::round(seconds * 10.0) / 10.0);
        let label = text(&label, (x, below + 14.0), "middle").set("class", "quiet").set("stroke", "none");
        group.add(line((x, below), (x, below + 5.0))).add(label)
    })
}

/// Draws the number and the law of the running atom.
fn running(trail: &Trail, film: &Film<'_>, (x, y): (f64, f64)) -> Group {
    trail.ways.atoms.iter().enumerate().fold(Group::new(), |group, (number, atom)| {
        let acts: Vec<&Act> = film.acts.iter().filter(|act| Film::atom(act, trail) == Some(number)).collect();
        if acts.is_empty() {
            return group;
        }
        let values = film.acts.iter().map(|act| {
            let runs = Film::atom(act, trail) == Some(number);
            (act.from, if runs { "visible" } else { "hidden" }.to_owned())
        });
        let last = film.acts.last().is_some_and(|act| Film::atom(act, trail) == Some(number));
        let shown = Group::new()
            .set("visibility", if last { "visible" } else { "hidden" })
            .add(badge((x, y), &atom.number.to_string(), number))
            .add(text(&shortened(&atom.law), (x + RADIUS + 10.0, y), "start"))
            .add(film.switch("visibility", super::film::changes(values)));
        group.add(shown)
    })
}

/// Returns the text with the duration of the run and the speed of the film. A script inserts the current time before
/// it.
fn speed(film: &Film<'_>, (x, y): (f64, f64)) -> Text {
    let end = format!("{:.1} s", film.end().seconds());
    let fast = match film.times {
        times if times > 1.0 => format!(", shown {times} times as fast"),
        _ => String::new(),
    };
    text("", (x, y), "end").add(TSpan::new("").set("class", "now")).add(TSpan::new(format!("{end}{fast}")))
}

/// Draws the symbols for pause and resume. Both are hidden if the viewer runs no scripts.
fn button((x, y): (f64, f64)) -> Group {
    let area = Rectangle::new().set("x", x - 14.0).set("y", y - 14.0).set("width", 28).set("height", 28);
    let bars = format!("M{} {}v{}m{} 0v-{}", x - 4.0, y - BUTTON, 2.0 * BUTTON, 8.0, 2.0 * BUTTON);
    let bars = Path::new().set("d", bars).set("class", "ink playing").set("stroke-width", 4);
    let arrow = format!("M{} {}l{} {}l-{} {}z", x - 6.0, y - BUTTON, 14.0, BUTTON, 14.0, BUTTON);
    let arrow = Path::new().set("d", arrow).set("class", "ink paused").set("stroke-width", 2).set("fill", "none");
    let button = Group::new().set("class", "button").set("visibility", "hidden").set("cursor", "pointer");
    button.add(area.set("fill-opacity", 0)).add(bars).add(arrow.set("visibility", "hidden"))
}
