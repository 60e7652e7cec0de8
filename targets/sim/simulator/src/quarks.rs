//! Quarks that this robot's alphabet declares itself, because the ranges of their arguments differ from other robots.
//! The laws of these quarks are shared with other robots.

pub use mdle_atoms::{Advance, Go, GoAvoid};
