//! A robot whose controller is a microcontroller, without an operating system and without an allocator.
//!
//! The test runs the lab tour twice. `desk` drives the simulated robot and records what it senses; `board` runs on the
//! microcontroller, reads this record, and must print the same text.
#![no_std]

pub mod alphabet;
pub mod record;
mod turns;

pub use mdle_runtime::{Sensed as Output, Twist as Input};
pub use turns::{Robot, at_rest, run};
