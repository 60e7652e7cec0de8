//! The target for robots that speak ROS 2: topics, driver and alphabet.
//!
//! Generated code uses [`Target`], on which the host runs a plan, and [`alphabet`], which contains the quarks of this
//! robot. The module [`sensing`] combines the messages of all topics into the output of a turn and performs no I/O.
//! [`Link`] abstracts the middleware.

pub mod alphabet;
pub mod battery;
pub mod capabilities;
pub mod cdr;
pub mod choices;
mod command_graph;
mod commands;
pub mod config;
pub mod contact;
mod dds_link;
mod driver;
#[cfg(target_os = "linux")]
mod epoll;
mod fault;
mod graph;
mod link;
mod local_addresses;
pub mod messages;
pub mod names;
pub mod odometer;
mod pacing;
mod participant;
mod payload_adapter;
mod proposals;
mod publishers;
pub mod quarks;
pub mod report;
pub mod scan;
mod search;
pub mod sensing;
pub mod source;
mod stamp;
mod target;

pub use dds_link::DdsLink;
pub use driver::Ros2;
pub use fault::Fault;
pub use graph::{Endpoint, Graph};
pub use link::Link;
/// Output of the robot.
pub use mdle_runtime::Sensed as Output;
/// Input of the robot.
pub use mdle_runtime::Twist as Input;
pub use pacing::Pacing;
pub use target::Target;
