//! A robot that consists only of a script: its output contains the report about each quark, and its input contains the
//! law that was applied.
//!
//! Emitted Rust is compiled for it as for any target, so that its behavior can be compared with other machines.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod alphabet;
mod drive;
pub mod quarks;
mod reports;

pub use drive::drive;
pub use reports::{INTERRUPTS, Input, LAWS, Output, SIGNALS};
