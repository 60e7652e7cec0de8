//! The robot template as a target of mdlec. `alphabet.mdle` lists its quarks, and `hardware.rs` drives it.
#![forbid(unsafe_code)]

pub mod alphabet;
mod hardware;
pub mod quarks;

pub use hardware::{Fault, Hardware, Target};
/// The robot's output: what its sensors say.
pub use mdle_runtime::Sensed as Output;
/// The robot's input: a forward speed and a turn rate. Zero is the null input.
pub use mdle_runtime::Twist as Input;
