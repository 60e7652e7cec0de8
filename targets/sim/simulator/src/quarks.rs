//! The quarks that this robot's alphabet declares itself, because their ranges differ. Their laws are the
//! shared laws.

pub use mdle_atoms::{Advance, Go, GoAvoid};
