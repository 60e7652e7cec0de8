//! The simulator of the target `sim`, without a host: worlds, the robot in them, and pictures of runs as SVG text.
//!
//! This crate does no I/O and needs no operating system. Its results do not depend on the machine: it uses no wall
//! clock, no trigonometry of the platform and no unordered maps. Two runs with the same options produce the same bytes.
#![forbid(unsafe_code)]

/// The alphabet of the target `sim`. `mdlec bind` writes this module into the folder of `alphabet.mdle`.
pub mod alphabet;
mod battery;
mod body;
mod charger;
mod crowd;
mod drawing;
mod fleet_drawing;
mod footprint;
mod frames;
mod goal;
mod grid;
mod model;
mod moving;
mod noise;
mod outline;
mod plot;
mod point;
pub mod quarks;
mod robot;
mod robot_ears;
mod ros_map;
mod sonar;
mod start;
mod start_noise;
mod surfaces;
mod trail;
mod wall_ends;
mod walls;
mod world;
mod world_error;
mod world_file;
mod worlds;

pub use charger::Charger;
pub use crowd::{Crowd, Groups};
pub use drawing::Drawing;
pub use fleet_drawing::FleetDrawing;
pub use footprint::{Footprint, Form};
pub use goal::{Goal, Zone, edge};
pub use mdle_runtime::Sensed;
/// Output of the robot.
pub use mdle_runtime::Sensed as Output;
/// Input of the robot.
pub use mdle_runtime::Twist as Input;
pub use model::{Body, ModelPart, PARTS};
pub use moving::{Schedule, Thing, Waypoint};
pub use outline::Outline;
pub use plot::{SignalCurve, TimeChart, TripDrawing};
pub use point::Point;
pub use robot::{Fault, Make, Simulated};
pub use robot_ears::RobotEars;
pub use ros_map::Header as MapHeader;
pub use sonar::Heard;
pub use start::{Start, StartError, check};
pub use start_noise::StartNoise;
pub use trail::echoes;
pub use walls::{Others, Walls};
pub use world::World;
pub use world_error::WorldError;
