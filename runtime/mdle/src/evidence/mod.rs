//! Evidence grids of landmarks, and the pose of a robot in one by the pings of a turn (docs/src/navigation.md).

mod grid;
mod matching;
mod pings;
mod png;
mod ros_image;
mod saved_map;

pub(crate) use grid::{CELL, EvidenceGrid, GridPing, HALF};
pub(crate) use matching::{Fit, fit, own_score};
pub(crate) use pings::PingOrder;
pub(crate) use ros_image::{image, pixels, png_pixels};
pub(crate) use saved_map::{SavedMap, USUAL_POSE};
