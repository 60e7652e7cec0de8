//! The quarks that this robot's alphabet declares itself, for their ranges: their laws are the shared ones.

pub use mdle_atoms::{Advance, Go, GoAvoid};
