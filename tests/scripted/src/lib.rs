//! A robot whose turns are defined by a script: its output contains the reported state of each quark, and its input
//! identifies the law that was applied.
//!
//! Emitted Rust is compiled for this robot as for any target, to compare its behavior with that of other machines.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod alphabet;
mod drive;
pub mod quarks;
mod reports;

pub use drive::drive;
pub use reports::{INTERRUPTS, Input, LAWS, Output, SIGNALS};
