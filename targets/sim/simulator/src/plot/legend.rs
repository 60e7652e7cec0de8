//! The legend of a plot. It lists each atom with its number, its law and the time at which it began, and explains the
//! symbols.

use svg::node::element::{Group, Path, Rectangle};

use super::layout::{Layout, round_step};
use super::shapes::RADIUS;
use super::shapes::{badge, circle, cross, dots, polyline, text};
use super::sizes::{LETTERS, MARGIN};
use super::{floor, rows, things};
use crate::trail::Trail;
use crate::world::World;

/// Maximum length of the scale bar, in pixels.
const BAR_MOST: f64 = 100.0;

/// Returns the legend of a run.
pub(super) fn drawn(layout: &Layout, world: &World, trail: &Trail) -> Group {
    let (left, right) = (layout.chart, layout.width() - MARGIN);
    let indented = left + 2.0 * RADIUS + 10.0;
    let before_last = right - rows::last_column(&layout.rows);
    let mut legend = Group::new().set("font-size", LETTERS);
    if let Some(first) = layout.rows.first() {
        let head = |name, x, anchor| text(name, (x, layout.line(0)), anchor).set("class", "quiet").set("font-size", 12);
        legend = legend.add(head(trail.kind, indented, "start")).add(head("total", right, "end"));
        if !first.times.is_empty() {
            legend = legend.add(head("times", before_last, "end"));
        }
    }
    for (atom, row) in layout.rows.iter().enumerate() {
        let y = layout.line_of(atom);
        if !row.number.is_empty() {
            legend = legend.add(badge((left + RADIUS, y), &row.number, atom));
        }
        let figures = [(&row.times, before_last), (&row.total, right)].into_iter().filter(|(text, _)| !text.is_empty());
        legend = legend.add(text(&row.law, (indented, y), "start"));
        legend = figures.fold(legend, |legend, (figure, x)| legend.add(text(figure, (x, y), "end")));
    }
    let signs = signs(layout, left + RADIUS, world, trail);
    // An empty line separates the symbols from the atoms, if there are atoms.
    let first = layout.rows.len() + if layout.rows.is_empty() { 0 } else { 2 };
    for (number, (sign, meaning)) in (first..).zip(signs) {
        let y = layout.line(number);
        let sign = sign.set("transform", format!("translate(0 {y})"));
        legend = legend.add(sign).add(text(meaning, (indented, y), "start"));
    }
    legend.add(scale_bar(layout))
}

/// Returns the symbols that occur in the picture, each drawn around height 0, and their meanings.
fn signs(layout: &Layout, x: f64, world: &World, trail: &Trail) -> Vec<(Group, &'static str)> {
    let body = |class| Group::new().add(circle((x, 0.0), 7.0).set("fill", "none").set("class", class));
    let mut signs = vec![(body("faint"), "start"), (body("ink"), "end")];
    if !trail.echoes.is_empty() {
        let echoes = dots([(x - 6.0, 2.0), (x, -2.0), (x + 6.0, 1.0)]);
        let echoes = Path::new().set("d", echoes).set("class", "echo");
        signs.push((Group::new().add(echoes.set("stroke-width", 2.4).set("stroke-linecap", "round")), "sonar echo"));
    }
    if !trail.contacts.is_empty() {
        signs.push((Group::new().add(cross((x, 0.0))), "contact"));
    }
    if world.goal.is_some_and(|goal| layout.shows_any(goal.zone.corners().into_iter())) {
        let zone = Rectangle::new().set("x", x - 9.0).set("y", -7).set("width", 18).set("height", 14);
        signs.push((Group::new().add(zone.set("class", "goal faint").set("stroke-width", 0.5)), "goal"));
    }
    if world.charger.is_some_and(|charger| layout.shows_any(charger.circle())) {
        signs.push((floor::socket([], (x, 0.0)), "charger"));
    }
    signs.extend(things::signs(layout, world).map(|sign| (sign.drawn(x), sign.meaning())));
    signs
}

/// Draws a scale bar whose length is a round number of metres.
fn scale_bar(layout: &Layout) -> Group {
    let metres = round_step(BAR_MOST / layout.scale * 0.4);
    let (left, y) = (layout.chart, layout.height - MARGIN - 10.0);
    let right = left + metres * layout.scale;
    let bar = polyline([(left, y - 4.0), (left, y + 4.0), (left, y), (right, y), (right, y - 4.0), (right, y + 4.0)]);
    let label = text(&format!("{metres} m"), (right + 8.0, y), "start");
    Group::new().add(bar.set("class", "ink").set("stroke-width", 1.5)).add(label)
}
