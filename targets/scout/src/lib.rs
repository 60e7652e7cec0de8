//! The Nomadic Super Scout II as a target: its serial language, its driver, and its alphabet.
//!
//! For generated code: [`Target`], which the host runs a plan on, and [`alphabet`], the quarks this robot has. For
//! tests and tools: the language ([`Command`], [`Frame`], [`State`]) and the driver, [`Scout`].
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
/// The robot's output.
pub use mdle_runtime::Sensed as Output;
/// The robot's input.
pub use mdle_runtime::Twist as Input;
pub use mdle_serial::{Clock, LineFault};
pub use reader::Reader;
pub use state::State;

/// The target that the host runs a plan on.
pub type Target = mdle_serial::SerialTarget<Scout>;
