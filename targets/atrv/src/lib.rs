//! The iRobot ATRV-mini as a target: the language of its rFLEX controller, its driver, and its alphabet.
//!
//! For generated code: [`Target`], which the host runs a plan on, and [`alphabet`], the quarks this robot has. For
//! tests and tools: the language ([`Command`], [`Packet`], [`Report`]) and the driver, [`Atrv`].
#![forbid(unsafe_code)]

pub mod alphabet;
mod avoid;
mod command;
mod config;
mod driver;
mod fault;
mod frame;
mod layout;
mod motion;
pub mod quarks;
mod receiver;
mod report;
mod ring;
mod sender;
mod target;

pub use avoid::avoided;
pub use command::{Axis, Command, Escape, Motion};
pub use config::{Bumpers, Config, Configured};
pub use driver::Atrv;
pub use fault::Fault;
pub use frame::{FrameBytes, Garbled, Packet, Reader};
pub use mdle_runtime::Sensed;
/// The robot's output.
pub use mdle_runtime::Sensed as Output;
/// The robot's input.
pub use mdle_runtime::Twist as Input;
pub use mdle_serial::{Clock, LineFault};
pub use report::{Echoes, Report, Unreadable};

/// The target that the host runs a plan on.
pub type Target = mdle_serial::SerialTarget<Atrv>;
