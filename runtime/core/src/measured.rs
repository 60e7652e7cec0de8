//! Values from which an operand of a condition was evaluated, for reports.

use crate::{Nanometers, Nanos, Operator};

/// The values from which an operand was evaluated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measured {
    /// No value can be shown: a quark only reports that it has fired, or the operand consists of several conditions.
    Nothing,
    /// Both sides of a comparison, in SI units.
    Compared {
        /// Value of the signal, on the left.
        left: f64,
        /// Operator of the comparison.
        operator: Operator,
        /// Value with which the signal is compared, on the right.
        right: f64,
    },
    /// The time since the scope was entered.
    Elapsed(Nanos),
    /// The length of the path driven since the scope was entered.
    Driven(Nanometers),
}
