//! The simulated robot as a target: a differential drive with bumper, odometry and sixteen sonars in a flat world.
//!
//! For generated code: [`Target`], which the host runs a plan on, and [`alphabet`], the quarks this robot has.
//! For tests and tools: [`World`], [`Simulated`], [`Make`], [`Observed`] and [`Sensed`].
//!
//! Nothing here depends on the machine it runs on: no wall clock, no platform trigonometry, no unordered maps. Two
//! runs with the same options give the same bytes.
#![forbid(unsafe_code)]

pub mod alphabet;
mod battery;
mod body;
mod charger;
mod disc;
mod frames;
mod goal;
mod grid;
mod model;
mod moving;
mod noise;
mod observed;
mod options;
mod plot;
pub mod quarks;
mod robot;
mod ros_map;
mod setup;
mod sonar;
mod start;
mod start_noise;
mod surfaces;
mod target;
mod trail;
mod walls;
mod watch;
mod whole_file;
mod world;
mod world_file;

pub use charger::Charger;
pub use disc::Disc;
pub use goal::{Goal, Zone};
pub use mdle_runtime::Sensed;
/// The robot's output.
pub use mdle_runtime::Sensed as Output;
/// The robot's input.
pub use mdle_runtime::Twist as Input;
pub use model::{Body, Part};
pub use moving::{Schedule, Stop, Thing};
pub use observed::Observed;
pub use robot::{Fault, Make, Simulated};
pub use sonar::Heard;
pub use start::{Start, StartError};
pub use target::Sim;
/// The target that the host runs a plan on.
pub use target::Sim as Target;
pub use walls::Walls;
pub use world::{Outline, Place, World};
pub use world_file::WorldError;
