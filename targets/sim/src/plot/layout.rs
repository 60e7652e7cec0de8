//! How large a plot is and where its parts lie, in pixels; both axes have one scale.

use crate::trail::Trail;
use crate::world::World;

/// The most that the floor may take up, in pixels.
const FLOOR_MOST: (f64, f64) = (1080.0, 860.0);
/// The least, so that axes have room for their numbers.
const FLOOR_LEAST: f64 = 160.0;
/// The most pixels a metre may take up.
const SCALE_MOST: f64 = 220.0;
/// Kept free around what is drawn, in metres.
const AROUND: f64 = 0.4;
/// Around the whole plot.
pub(crate) const MARGIN: u32 = 18;
/// For the numbers below the floor.
pub(crate) const BELOW: u32 = 44;
/// For the numbers to the left of the floor.
pub(crate) const LEFT: u32 = 52;
/// The height of a line of the legend.
pub(crate) const LINE: u32 = 22;
/// The size of letters in the legend.
pub(crate) const LETTERS: u32 = 14;
/// The most atoms that are marked and listed.
pub(crate) const MARKS_MOST: usize = 40;
/// The most letters of a law that are shown.
const LAW_MOST: usize = 44;

/// The sizes of a plot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// What is shown, in metres.
    pub(crate) x: (f64, f64),
    /// What is shown, in metres.
    pub(crate) y: (f64, f64),
    /// The pixels of a metre.
    pub(crate) scale: f64,
    /// The width of the part that holds the floor, axes included.
    pub(crate) chart: u32,
    /// The width of the legend.
    pub(crate) legend: u32,
    pub(crate) height: u32,
    /// Each atom that began, as the legend tells it: its number, its law and when.
    pub(crate) lines: Vec<(String, String, String)>,
}

impl Layout {
    /// The layout that shows all walls and the whole way.
    pub(crate) fn of(world: &World, trail: &Trail) -> Self {
        let places = || world.outlines.iter().flat_map(|outline| outline.points.iter().copied()).chain(trail.places());
        let x = range(places().map(|place| place.x));
        let y = range(places().map(|place| place.y));
        let scale = (FLOOR_MOST.0 / (x.1 - x.0)).min(FLOOR_MOST.1 / (y.1 - y.0)).min(SCALE_MOST);
        let (x, wide) = shown(x, scale);
        let (y, high) = shown(y, scale);
        let lines = lines(trail);
        let letters = lines.iter().map(|(_, law, t)| law.chars().count() + t.len()).max().unwrap_or(0);
        // Sans-serif letters are about half as wide as they are high.
        let legend = if lines.is_empty() { 0 } else { 84 + u32::try_from(letters).unwrap_or(0) * (LETTERS * 11 / 20) };
        let listed = u32::try_from(lines.len()).unwrap_or(0);
        let height = (high + 2 * MARGIN + BELOW).max(2 * MARGIN + (listed + 2) * LINE);
        // A legend that is higher than the floor must not stretch it.
        let y = (y.0, y.0 + f64::from(height - 2 * MARGIN - BELOW) / scale);
        Self { x, y, scale, chart: wide + 2 * MARGIN + LEFT, legend, height, lines }
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
fn shown((least, most): (f64, f64), scale: f64) -> ((f64, f64), u32) {
    let pixels = libm::ceil(((most - least) * scale).max(FLOOR_LEAST));
    let more = (pixels / scale - (most - least)) / 2.0;
    ((least - more, most + more), pixels as u32)
}

fn lines(trail: &Trail) -> Vec<(String, String, String)> {
    let listed = trail.marks.iter().take(MARKS_MOST).map(|mark| {
        let law: String = if mark.law.chars().count() <= LAW_MOST {
            mark.law.clone()
        } else {
            mark.law.chars().take(LAW_MOST - 1).chain(['…']).collect()
        };
        (mark.state.to_string(), law, format!("{:.1} s", mark.t.seconds()))
    });
    let left = trail.marks.len().saturating_sub(MARKS_MOST);
    let more = (left > 0).then(|| (String::new(), format!("and {left} more"), String::new()));
    listed.chain(more).collect()
}
