//! A robot without std and without an allocator, for plans whose executable links only if no path of it panics.
//!
//! Its output is read, and the input that the plan computes is printed, so that the optimiser can leave nothing out.
#![no_std]

pub mod alphabet;
mod run;
mod sensed;
mod system;

pub use mdle_runtime::Twist as Input;
pub use run::run;
pub use sensed::Sensed as Output;
pub use system::byte;
