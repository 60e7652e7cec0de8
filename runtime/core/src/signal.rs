//! Signals, and comparisons of them as interrupt quarks (paper, Definition 1: an interrupt is a function of `y`).

use crate::{Interrupt, Measured, Operator};

/// A numeric value of the output that comparisons read, in SI units.
pub trait Signal<Y: ?Sized> {
    /// Returns the current value, in SI units; infinite where the sensor had no echo.
    fn value(&self, y: &Y) -> f64;
}

/// Right-hand side of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand<S> {
    /// Another signal, with which the first signal is compared.
    Signal(S),
    /// A constant, in SI units.
    Value(f64),
}

impl<Y: ?Sized, S: Signal<Y>> Signal<Y> for Operand<S> {
    fn value(&self, y: &Y) -> f64 {
        match self {
            Self::Signal(signal) => signal.value(y),
            Self::Value(value) => *value,
        }
    }
}

/// A comparison of a signal: an interrupt that fires while the comparison is true.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison<S, O> {
    signal: S,
    operator: Operator,
    with: Operand<O>,
}

impl<S, O> Comparison<S, O> {
    /// Creates a comparison of `signal` with `with`.
    #[must_use]
    pub const fn new(signal: S, operator: Operator, with: Operand<O>) -> Self {
        Self { signal, operator, with }
    }
}

impl<Y: ?Sized, S: Signal<Y>, O: Signal<Y>> Interrupt<Y> for Comparison<S, O> {
    fn fired(&self, y: &Y) -> bool {
        self.operator.holds(self.signal.value(y), self.with.value(y))
    }

    fn measured(&self, y: &Y) -> Measured {
        Measured::Compared { left: self.signal.value(y), operator: self.operator, right: self.with.value(y) }
    }
}

/// Signal type of a robot without signals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoSignal {}

impl<Y: ?Sized> Signal<Y> for NoSignal {
    fn value(&self, _: &Y) -> f64 {
        match *self {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A signal: the first of the two numbers of an output.
    struct First;
    struct Second;

    impl Signal<(f64, f64)> for First {
        fn value(&self, y: &(f64, f64)) -> f64 {
            y.0
        }
    }

    impl Signal<(f64, f64)> for Second {
        fn value(&self, y: &(f64, f64)) -> f64 {
            y.1
        }
    }

    #[test]
    fn a_comparison_reads_both_of_its_sides() {
        let signals = Comparison::new(First, Operator::Less, Operand::Signal(Second));
        assert_eq!([(1.0, 2.0), (2.0, 1.0)].map(|y| signals.fired(&y)), [true, false]);
        let value = Comparison::<_, Second>::new(First, Operator::Greater, Operand::Value(1.5));
        assert_eq!([(1.0, 2.0), (2.0, 1.0)].map(|y| value.fired(&y)), [false, true]);
    }
}
