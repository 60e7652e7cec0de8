//! The values that an operand of a condition was read from: reports say them.

use crate::{Nanometers, Nanos, Operator};

/// The values from which an operand has its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// None that can be shown: a quark that only says that it has fired, or several of them.
    Nothing,
    /// Both sides of a comparison, in SI units.
    Compared {
        /// The value of the signal.
        left: f64,
        /// The comparison.
        operator: Operator,
        /// The value that the signal is compared with.
        right: f64,
    },
    /// The time since the scope was entered.
    Elapsed(Nanos),
    /// The length of the path driven since the scope was entered.
    Driven(Nanometers),
}
