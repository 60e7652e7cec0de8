//! The robot of workload T(N): one measurement, one switch, two numbers to write.
#![no_std]
#![forbid(unsafe_code)]

pub mod alphabet;
pub mod quarks;

/// What a turn reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// What the atoms' conditions look at.
    pub measured: f64,
    /// Whether the plan is to end.
    pub halt: bool,
}

impl mdle_runtime::Output for Output {}

/// What a turn writes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Input {
    /// The first number.
    pub left: f64,
    /// The second.
    pub right: f64,
}
