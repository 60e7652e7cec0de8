//! The target for the Nomadic Super Scout II: the serial protocol, the driver, and the alphabet.
//!
//! Generated code uses [`Target`], on which the host runs a plan, and [`alphabet`], which contains the quarks of this
//! robot. Tests and tools use the protocol ([`Command`], [`Frame`], [`State`]) and the driver, [`Scout`].
#![forbid(unsafe_code)]

pub mod alphabet;
mod command;
mod config;
mod driver;
mod fault;
mod frame;
mod freshness;
mod line;
mod number;
mod odometer;
pub mod quarks;
mod reader;
mod ring;
mod state;
mod target;
mod wheels;

pub use command::Command;
pub use config::{Config, Configured};
pub use driver::Scout;
pub use fault::Fault;
pub use frame::{Arguments, Frame, Garbled};
pub use mdle_runtime::Sensed;
/// Output of the robot.
pub use mdle_runtime::Sensed as Output;
/// Input of the robot.
pub use mdle_runtime::Twist as Input;
pub use mdle_serial::{Clock, LineFault};
pub use reader::Reader;
pub use state::State;

/// The target `scout`, on which the host runs a plan.
pub type Target = mdle_serial::SerialTarget<Scout>;
