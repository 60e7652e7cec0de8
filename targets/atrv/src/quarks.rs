//! Quarks that this robot's alphabet declares itself because their argument ranges differ; their laws are shared with
//! other robots.

pub use mdle_atoms::{Advance, Go, GoAvoid};
