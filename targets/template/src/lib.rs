//! The robot template as a target of mdlec: `alphabet.mdle` declares its quarks, and `hardware.rs` drives it.
#![forbid(unsafe_code)]

pub mod alphabet;
mod hardware;
pub mod quarks;

pub use hardware::{Fault, Hardware, Target};
/// Output of the robot: the values of its sensors.
pub use mdle_runtime::Sensed as Output;
/// Input of the robot: a forward speed and a turn rate. Zero is the null input.
pub use mdle_runtime::Twist as Input;
