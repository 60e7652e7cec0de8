//! Pictures of a run. For `--plot`, they show the floor with the driven path and the positions where atoms began; for
//! `--record`, they are animated.

mod chart;
mod colours;
mod drawing;
mod film;
mod floor;
mod labels;
mod layout;
mod legend;
mod record;
mod rows;
mod shapes;
mod sizes;
mod strip;
#[cfg(test)]
mod tests;
mod things;
mod title;
mod trips;
mod view;

pub use chart::{SignalCurve, TimeChart};
pub(crate) use drawing::svg;
pub(crate) use record::animated;
pub use trips::TripDrawing;
