//! The layout of a plot: sizes and positions of its parts, in pixels. Both axes of the floor have the same scale.

use super::rows::{self, LegendRow};
use super::shapes::Pixel;
use super::sizes::{LEFT, LETTER, LETTERS, MARGIN};
use super::title::Title;
use super::view::{FloorView, range};
use crate::point::Point;
use crate::trail::Trail;
use crate::world::World;

/// Maximum width and height of the floor in a plot, in pixels.
const FLOOR_MOST: (f64, f64) = (1080.0, 860.0);
/// Minimum width and height of the floor in a plot, in pixels. It leaves enough space for the labels of the axes.
const FLOOR_LEAST: f64 = 160.0;
/// Maximum scale of a plot, in pixels per metre.
const SCALE_MOST: f64 = 220.0;
/// Height of the labels below the floor, in pixels.
pub(super) const BELOW: f64 = 44.0;
/// Height of a line of the legend, in pixels.
pub(super) const LINE: f64 = 22.0;
/// Number of lines in the legend in addition to the atoms: the column heads, an empty line, the symbols, and the scale.
pub(super) const KEY: usize = 9;
/// Maximum number of symbols of moving objects.
const SIGNS: usize = 2;
/// Minimum width of a legend, in pixels. The symbols need this width.
const LEGEND_LEAST: f64 = 170.0;

/// The sizes of a plot.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// Part of the floor that is shown.
    pub(super) view: FloorView,
    /// Scale, in pixels per metre.
    pub(super) scale: f64,
    pub(super) title: Title,
    /// Height of the title, including the margin above it, in pixels.
    pub(super) top: f64,
    /// Width of the part that contains the floor and its axes, in pixels.
    pub(super) chart: f64,
    /// Width of the legend, in pixels.
    pub(super) legend: f64,
    pub(super) height: f64,
    /// Rows of the legend, one for each atom.
    pub(super) rows: Vec<LegendRow>,
}

impl Layout {
    /// Returns the layout that shows the whole driven path, and the floor around it.
    pub(super) fn of(world: &World, trail: &Trail) -> Self {
        let FloorView { x, y } = FloorView::of(world, trail);
        let scale = (FLOOR_MOST.0 / (x.1 - x.0)).min(FLOOR_MOST.1 / (y.1 - y.0)).min(SCALE_MOST);
        let (x, wide) = shown(x, scale);
        let (y, high) = shown(y, scale);
        let rows = rows::of(trail);
        let letters = rows.iter().map(|row| row.law.chars().count()).max().unwrap_or(0);
        let law = letters as f64 * f64::from(LETTERS) * LETTER;
        let legend = libm::ceil((law + rows::columns(&rows) + 44.0).max(LEGEND_LEAST));
        let chart = wide + 2.0 * MARGIN + LEFT;
        let title = Title::of(&trail.about, chart + legend - 2.0 * MARGIN - LEFT);
        let top = MARGIN + title.height();
        let listed = (rows.len() + KEY + SIGNS.min(world.things.len())) as f64;
        let height = (top + high + MARGIN + BELOW).max(top + MARGIN + (listed + 1.0) * LINE);
        // If the legend is higher than the floor, the plot shows more of the floor above and below instead of
        // stretching it.
        let more = ((height - top - MARGIN - BELOW) / scale - (y.1 - y.0)) / 2.0;
        let y = (y.0 - more, y.1 + more);
        Self { view: FloorView { x, y }, scale, title, top, chart, legend, height, rows }
    }

    /// Returns the pixel of a position on the floor.
    pub(super) fn at(&self, place: Point) -> Pixel {
        let FloorView { x, y } = self.view;
        (MARGIN + LEFT + (place.x - x.0) * self.scale, self.top + (y.1 - place.y) * self.scale)
    }

    /// Returns `true` if an object between these positions may be visible.
    pub(super) fn shows_any(&self, places: impl Iterator<Item = Point>) -> bool {
        let overlaps = |one: (f64, f64), other: (f64, f64)| one.0 <= other.1 && other.0 <= one.1;
        let (x, y): (Vec<f64>, Vec<f64>) = places.map(|place| (place.x, place.y)).unzip();
        overlaps(range(x.into_iter()), self.view.x) && overlaps(range(y.into_iter()), self.view.y)
    }

    /// Returns the width of the picture, in pixels.
    pub(super) fn width(&self) -> f64 {
        self.chart + self.legend
    }

    /// Returns the vertical position of the floor's lower edge, where the axis is, in pixels.
    pub(super) fn bottom(&self) -> f64 {
        self.height - MARGIN - BELOW
    }

    /// Returns the vertical middle of a line of the legend; lines are counted from 0.
    pub(super) fn line(&self, number: usize) -> f64 {
        self.top + LINE * (number as f64 + 0.5)
    }

    /// Returns the vertical middle of an atom's line in the legend. `atom` is the index of the atom, ordered by the
    /// times at which atoms first began.
    pub(super) fn line_of(&self, atom: usize) -> f64 {
        // The first line has the column heads; atoms that are not listed share the last line.
        self.line(1 + atom.min(self.rows.len().saturating_sub(1)))
    }
}

/// Returns the range that is shown, and its size in pixels. It is larger than the given range if the minimum size
/// requires it.
fn shown((least, most): (f64, f64), scale: f64) -> ((f64, f64), f64) {
    let pixels = libm::ceil(((most - least) * scale).max(FLOOR_LEAST));
    let more = (pixels / scale - (most - least)) / 2.0;
    ((least - more, most + more), pixels)
}

/// Returns the step between the labels of an axis. It is one, two or five times a power of ten, and at least `least`.
pub(super) fn round_step(least: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(least)));
    let step = [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power).find(|step| *step >= least * (1.0 - 1e-9));
    step.unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::footprint::{Footprint, Form};
    use mdle_runtime::{Nanos, Pose};

    fn layout(world: &str, marks: usize) -> Layout {
        let mut trail = Trail::from(&Footprint { pose: Pose::ORIGIN, form: Form::SCOUT });
        trail.about.setup = "a long name of a world ".repeat(marks.min(9));
        for number in 0..marks {
            trail.began(number as u64 + 1, &"goAvoid 90 40 20 ".repeat(number % 5 + 1), Nanos(number as u64));
        }
        Layout::of(&World::parse("a world", world).expect("a good world"), &trail)
    }

    #[test]
    fn steps_are_round_and_never_too_small() {
        for (least, step) in [(0.07, 0.1), (0.1, 0.1), (0.11, 0.2), (0.3, 0.5), (0.6, 1.0), (1.0, 1.0), (30.0, 50.0)] {
            assert!((round_step(least) - step).abs() < 1e-9 * step, "{least}: {}", round_step(least));
        }
        assert!(round_step(1e9) >= 1e9 && round_step(1e-9) >= 1e-9);
    }

    #[test]
    fn everything_lies_inside_whatever_the_size() {
        for (world, marks) in [
            ("", 0),
            ("", 100),
            ("[[wall]]\npoints = [[-1000000, 0], [1000000, 1]]", 3),
            ("[[wall]]\npoints = [[0, -1000], [0.001, 1000]]", 60),
            ("[[box]]\ncentre = [0.5, 0.5]\nsize = [0.1, 0.1]", 13),
        ] {
            let layout = layout(world, marks);
            assert!(layout.height.is_finite() && layout.height < 1250.0, "{layout:?}");
            assert!(layout.width() < 1700.0, "{layout:?}");
            for place in
                [Point { x: layout.view.x.0, y: layout.view.y.0 }, Point { x: layout.view.x.1, y: layout.view.y.1 }]
            {
                let (x, y) = layout.at(place);
                assert!((MARGIN + LEFT - 0.1..=layout.chart - MARGIN + 0.1).contains(&x), "{x} in {layout:?}");
                assert!((layout.top - 0.1..=layout.bottom() + 0.1).contains(&y), "{y} in {layout:?}");
            }
            let last = layout.line(layout.rows.len() + KEY - 1);
            assert!(last + LINE / 2.0 <= layout.height, "{last} in {layout:?}");
        }
    }
}
