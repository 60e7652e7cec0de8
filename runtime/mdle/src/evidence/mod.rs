//! Evidence grids of landmarks, and the search for the pose of a robot in such a grid. The search uses the pings that
//! the robot took while it turned on the spot (docs/src/navigation.md).

mod grid;
mod map_files;
mod map_maker;
mod matching;
mod pings;
mod ros_image;
mod saved_map;

pub(crate) use grid::GridPing;
pub(crate) use map_files::MapFiles;
pub(crate) use map_maker::MapMaker;
pub(crate) use matching::{Fit, fit};
pub(crate) use pings::PingOrder;
pub(crate) use saved_map::{SavedMap, USUAL_POSE, pose};
