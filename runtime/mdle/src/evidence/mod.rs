//! Evidence grids of landmarks, and the pose of a robot in one by the pings of a turn (docs/src/navigation.md).

mod grid;
mod matching;
mod pings;
mod png;
mod ros_image;

pub(crate) use grid::{CELL, EvidenceGrid, GridPing, HALF};
pub(crate) use matching::{Fit, fit};
pub(crate) use pings::PingOrder;
pub(crate) use ros_image::{image, pixels, png_pixels, read_map};
