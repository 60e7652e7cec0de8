//! The robot of the workload T(N), with one measurement, one switch and two numbers to write, and the machines that are
//! compared on it.
#![forbid(unsafe_code)]

// Emitted code refers to this crate by name, as from any other package.
extern crate self as mdle_workload;

pub mod alphabet;
pub mod cases;
pub mod machines;
pub mod quarks;

/// Output that a turn reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// Measurement that the atoms' conditions read.
    pub measured: f64,
    /// `true` if the plan should end.
    pub halt: bool,
}

impl mdle_runtime::Output for Output {}

/// Input that a turn writes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// First number that the law of an atom writes.
    pub left: f64,
    /// Second number that the law of an atom writes.
    pub right: f64,
}
