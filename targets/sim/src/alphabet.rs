//! What emitted code needs of this robot: its quarks by their names, and the types of its input and output.

pub use mdle_atoms::{Align, AtIsection, Bumper, Go, GoAvoid, Rotate, Stop, Turn};

/// The robot's output, `y`.
pub type Output = crate::Sensed;
/// Its input, `u`.
pub type Input = mdle_runtime::Twist;
/// What the host runs a plan on.
pub type Target = crate::Sim;
