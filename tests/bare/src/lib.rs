//! A robot without std and without an allocator, for plans whose executables link only if no code path can panic.
//!
//! The robot's output is read from standard input, and the input that the plan computes is printed, so that the
//! optimizer cannot remove any code of the plan.
#![no_std]

pub mod alphabet;
mod run;
mod sensed;
mod system;

pub use mdle_runtime::Twist as Input;
pub use run::run;
pub use sensed::Sensed as Output;
pub use system::byte;
