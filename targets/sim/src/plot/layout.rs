//! How large a plot is and where its parts lie, in pixels; both axes have one scale.

use mdle_runtime::Printable;

use super::shapes::Pixel;
use super::things;
use crate::trail::Trail;
use crate::world::{Place, World};

/// The most that the floor may take up, in pixels.
const FLOOR_MOST: (f64, f64) = (1080.0, 860.0);
/// The least, so that axes have room for their numbers.
const FLOOR_LEAST: f64 = 160.0;
/// The most pixels a metre may take up.
const SCALE_MOST: f64 = 220.0;
/// Kept free around what is drawn, in metres.
const AROUND: f64 = 0.4;
/// Around the whole plot.
pub(super) const MARGIN: f64 = 18.0;
/// For the numbers below the floor.
pub(super) const BELOW: f64 = 44.0;
/// For the numbers to the left of the floor.
pub(super) const LEFT: f64 = 52.0;
/// The height of a line of the legend.
pub(super) const LINE: f64 = 22.0;
/// The size of letters in the legend.
pub(super) const LETTERS: u32 = 14;
/// The lines below the atoms of the legend: a free one, what the signs mean, and the scale.
pub(super) const KEY: usize = 7;
/// The least width of a legend: that of its signs.
const LEGEND_LEAST: f64 = 170.0;
/// The most atoms that are marked and listed.
pub(super) const MARKS_MOST: usize = 40;
/// The most letters of a law that are shown.
const LAW_MOST: usize = 44;

/// The sizes of a plot.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    /// What is shown, in metres.
    pub(super) x: (f64, f64),
    /// What is shown, in metres.
    pub(super) y: (f64, f64),
    /// The pixels of a metre.
    pub(super) scale: f64,
    /// The width of the part that holds the floor, axes included.
    pub(super) chart: f64,
    /// The width of the legend.
    pub(super) legend: f64,
    pub(super) height: f64,
    /// Each atom that began, as the legend tells it: its number, its law and when.
    pub(super) lines: Vec<(String, String, String)>,
}

impl Layout {
    /// The layout that shows all walls and the whole way.
    pub(super) fn of(world: &World, trail: &Trail) -> Self {
        let places = || world.places().chain(trail.places());
        let x = range(places().map(|place| place.x));
        let y = range(places().map(|place| place.y));
        let scale = (FLOOR_MOST.0 / (x.1 - x.0)).min(FLOOR_MOST.1 / (y.1 - y.0)).min(SCALE_MOST);
        let (x, wide) = shown(x, scale);
        let (y, high) = shown(y, scale);
        let lines = lines(trail);
        let letters = lines.iter().map(|(_, law, t)| law.chars().count() + t.len()).max().unwrap_or(0);
        // Sans-serif letters are less than six tenths as wide as they are high, on the whole.
        let legend = (84.0 + letters as f64 * f64::from(LETTERS) * 0.56).max(LEGEND_LEAST);
        let listed = (lines.len() + KEY + things::signs(world).count()) as f64;
        let height = (high + 2.0 * MARGIN + BELOW).max(2.0 * MARGIN + (listed + 1.0) * LINE);
        // A legend that is higher than the floor must not stretch it: there is more of the floor above and below.
        let more = ((height - 2.0 * MARGIN - BELOW) / scale - (y.1 - y.0)) / 2.0;
        let y = (y.0 - more, y.1 + more);
        Self { x, y, scale, chart: wide + 2.0 * MARGIN + LEFT, legend: libm::ceil(legend), height, lines }
    }

    /// Where a place of the floor is in the drawing.
    pub(super) fn at(&self, place: Place) -> Pixel {
        (MARGIN + LEFT + (place.x - self.x.0) * self.scale, MARGIN + (self.y.1 - place.y) * self.scale)
    }

    /// Whether a place lies on what is shown of the floor.
    pub(super) fn shows(&self, place: Place) -> bool {
        (self.x.0..=self.x.1).contains(&place.x) && (self.y.0..=self.y.1).contains(&place.y)
    }

    /// The whole width.
    pub(super) fn width(&self) -> f64 {
        self.chart + self.legend
    }

    /// Where the floor ends below, and the axis is.
    pub(super) fn bottom(&self) -> f64 {
        self.height - MARGIN - BELOW
    }

    /// The middle of a line of the legend, from 0.
    pub(super) fn line(&self, number: usize) -> f64 {
        MARGIN + LINE * (number as f64 + 1.0)
    }
}

/// The least and greatest of some coordinates, with room around them.
fn range(coordinates: impl Iterator<Item = f64>) -> (f64, f64) {
    let (least, most) = coordinates.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), coordinate| {
        (least.min(coordinate), most.max(coordinate))
    });
    (least - AROUND, most + AROUND)
}

/// What is shown of a range, and in how many pixels: at least the least, then more of the floor around it.
fn shown((least, most): (f64, f64), scale: f64) -> ((f64, f64), f64) {
    let pixels = libm::ceil(((most - least) * scale).max(FLOOR_LEAST));
    let more = (pixels / scale - (most - least)) / 2.0;
    ((least - more, most + more), pixels)
}

fn lines(trail: &Trail) -> Vec<(String, String, String)> {
    let listed = trail
        .marks
        .iter()
        .take(MARKS_MOST)
        .map(|mark| (mark.state.to_string(), shortened(&mark.law), format!("{:.1} s", mark.t.seconds())));
    let left = trail.marks.len().saturating_sub(MARKS_MOST).saturating_add(trail.unmarked);
    let more = (left > 0).then(|| (String::new(), format!("and {left} more"), String::new()));
    listed.chain(more).collect()
}

/// A law as long as there is room for.
pub(super) fn shortened(law: &str) -> String {
    let law = Printable(law).to_string();
    if law.chars().count() <= LAW_MOST { law } else { law.chars().take(LAW_MOST - 1).chain(['…']).collect() }
}

/// The step between the numbers of an axis: one, two or five times a power of ten, at least `least`.
pub(super) fn round_step(least: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(least)));
    let step = [1.0, 2.0, 5.0].into_iter().map(|digit| digit * power).find(|step| *step >= least * (1.0 - 1e-9));
    step.unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mdle_runtime::{Nanos, Pose};

    fn layout(world: &str, marks: usize) -> Layout {
        let mut trail = Trail::from(&Pose::ORIGIN, 0.205);
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
            assert!(layout.height.is_finite() && layout.height < 1150.0, "{layout:?}");
            assert!(layout.width() < 1700.0, "{layout:?}");
            for place in [Place { x: layout.x.0, y: layout.y.0 }, Place { x: layout.x.1, y: layout.y.1 }] {
                let (x, y) = layout.at(place);
                assert!((MARGIN + LEFT - 0.1..=layout.chart - MARGIN + 0.1).contains(&x), "{x} in {layout:?}");
                assert!((MARGIN - 0.1..=layout.bottom() + 0.1).contains(&y), "{y} in {layout:?}");
            }
            let last = layout.line(layout.lines.len() + KEY - 1);
            assert!(last + LINE / 2.0 <= layout.height, "{last} in {layout:?}");
        }
    }
}
