//! Quarks that this robot's alphabet declares itself because their ranges differ; their laws are the shared ones.

pub use mdle_atoms::{Advance, Go, GoAvoid};
