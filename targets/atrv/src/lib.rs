//! The target for the iRobot ATRV-mini: the protocol of its rFLEX controller, the driver, and the alphabet.
//!
//! Generated code uses [`Target`], on which the host runs a plan, and [`alphabet`], which contains the quarks of this
//! robot. Tests and tools use the protocol ([`Command`], [`Packet`], [`Report`]) and the driver, [`Atrv`].
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
pub use command::{Axis, AxisMotion, Command, Escape};
pub use config::{Bumpers, Config, Configured};
pub use driver::Atrv;
pub use fault::Fault;
pub use frame::{FrameBytes, Garbled, Packet, Reader};
pub use mdle_runtime::Sensed;
/// Output of the robot.
pub use mdle_runtime::Sensed as Output;
/// Input of the robot.
pub use mdle_runtime::Twist as Input;
pub use mdle_serial::{Clock, LineFault};
pub use report::{Echoes, Report, Unreadable};

/// The target `atrv`, on which the host runs a plan.
pub type Target = mdle_serial::SerialTarget<Atrv>;
