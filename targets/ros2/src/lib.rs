//! A robot that speaks ROS 2 as a target: its topics, its driver, and its alphabet.
//!
//! For generated code: [`Target`], which the host runs a plan on, and [`alphabet`], the quarks that this robot has. The
//! messages of topics become the output of a turn in [`sensing`], without input and output; the middleware is behind
//! [`Link`].
#![forbid(unsafe_code)]

pub mod alphabet;
pub mod battery;
pub mod capabilities;
pub mod cdr;
pub mod choices;
pub mod config;
pub mod contact;
mod dds_link;
mod driver;
mod fault;
mod graph;
mod link;
pub mod messages;
pub mod names;
pub mod odometer;
mod pacing;
mod participant;
mod payload_adapter;
pub mod quarks;
pub mod report;
pub mod scan;
pub mod sensing;
pub mod source;
mod stamp;
mod target;

pub use dds_link::DdsLink;
pub use driver::Ros2;
pub use fault::Fault;
pub use graph::{Endpoint, Graph};
pub use link::Link;
/// The robot's output.
pub use mdle_runtime::Sensed as Output;
/// The robot's input.
pub use mdle_runtime::Twist as Input;
pub use pacing::Pacing;
pub use target::Target;
