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
mod line;
mod number;
mod odometer;
mod output;
pub mod quarks;
mod ring;
mod state;
mod target;
mod wheels;

pub use command::Command;
pub use config::{Config, Configured};
pub use driver::{Clock, Scout};
pub use fault::Fault;
pub use frame::{Frame, Garbled};
/// The robot's input.
pub use mdle_runtime::Twist as Input;
pub use output::Sensed;
/// Its output.
pub use output::Sensed as Output;
pub use state::{Battery, State};
pub use target::SuperScout;
/// What the host runs a plan on.
pub use target::SuperScout as Target;
