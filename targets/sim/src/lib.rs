//! The simulated robot as a target: a differential drive with bumper, odometry and sixteen sonars in a flat world.
//!
//! For generated code: [`Sim`], which the host runs a plan on, and [`alphabet`], the quarks this robot has.
//! For tests and tools: [`World`], [`Simulated`] and [`Sensed`].
//!
//! Nothing here depends on the machine it runs on: no wall clock, no platform trigonometry, no unordered maps. Two
//! runs with the same options give the same bytes.
#![forbid(unsafe_code)]

pub mod alphabet;
mod body;
mod options;
mod output;
mod plot;
mod robot;
mod sonar;
mod start;
mod target;
mod trail;
mod walls;
mod whole_file;
mod world;
mod world_file;

pub use output::Sensed;
pub use robot::{Fault, Simulated};
pub use start::{Start, StartError};
pub use target::Sim;
pub use world::{Outline, Place, World};
pub use world_file::WorldError;
