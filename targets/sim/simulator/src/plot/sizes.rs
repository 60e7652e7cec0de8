//! Sizes that all parts of a plot share, in pixels.

/// Margin around the whole plot, in pixels.
pub(super) const MARGIN: f64 = 18.0;
/// Width of the labels to the left of the floor, in pixels.
pub(super) const LEFT: f64 = 52.0;
/// Font size in the legend, in pixels.
pub(super) const LETTERS: u32 = 14;
/// Average width of a character in a sans-serif font, as a fraction of the font size.
pub(super) const LETTER: f64 = 0.56;
