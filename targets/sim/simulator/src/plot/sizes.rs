//! The sizes that all parts of a plot have in common, in pixels.

/// Around the whole plot.
pub(super) const MARGIN: f64 = 18.0;
/// Width of the numbers to the left of the floor, in pixels.
pub(super) const LEFT: f64 = 52.0;
/// The size of letters in the legend.
pub(super) const LETTERS: u32 = 14;
/// The average width of a sans-serif letter, as a part of its height.
pub(super) const LETTER: f64 = 0.56;
