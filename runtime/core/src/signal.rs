//! Signals, and comparisons of them as interrupt quarks (paper, Definition 1: an interrupt is a function of `y`).

use crate::{Interrupt, Measured, Radians};

/// A number of the output that comparisons read, in SI units.
pub trait Signal<Y: ?Sized> {
    /// Returns the current value; infinite where the sensor saw nothing.
    fn value(&self, y: &Y) -> f64;
}

/// Operator of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operator {
    /// The values differ by at most this tolerance.
    Equal(f64),
    /// Two directions not further apart than this, the shortest way round.
    SameDirection(f64),
    /// The first value is less than the second.
    Less,
    /// The first value is at most the second.
    LessOrEqual,
    /// The first value is greater than the second.
    Greater,
    /// The first value is at least the second.
    GreaterOrEqual,
}

impl Operator {
    /// Returns `true` if the comparison holds; it never holds for NaN.
    #[must_use]
    pub fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Equal(tolerance) => (left - right).abs() <= tolerance,
            Self::SameDirection(tolerance) => Radians(left - right).wrapped().0.abs() <= tolerance,
            Self::Less => left < right,
            Self::LessOrEqual => left <= right,
            Self::Greater => left > right,
            Self::GreaterOrEqual => left >= right,
        }
    }
}

/// Right side of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operand<S> {
    /// Another signal.
    Signal(S),
    /// A value.
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

/// A comparison of a signal: an interrupt that has fired while it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison<S, O> {
    signal: S,
    operator: Operator,
    with: Operand<O>,
}

impl<S, O> Comparison<S, O> {
    /// Returns the comparison of `signal` with `with`.
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

/// The signals of a robot without signals.
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

    /// A robot whose output is two numbers.
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
    fn operators_hold_where_they_say() {
        let holding = |left: f64, right: f64| {
            [Operator::Equal(0.5), Operator::Less, Operator::LessOrEqual, Operator::Greater, Operator::GreaterOrEqual]
                .map(|operator| operator.holds(left, right))
        };
        assert_eq!(holding(1.0, 1.5), [true, true, true, false, false]);
        assert_eq!(holding(2.0, 1.0), [false, false, false, true, true]);
        assert_eq!(holding(1.0, 2.0), [false, true, true, false, false]);
        assert_eq!(holding(1.0, 1.0), [true, false, true, false, true]);
        assert_eq!(holding(f64::INFINITY, f64::INFINITY), [false, false, true, false, true]);
        assert_eq!(holding(f64::NAN, 1.0), [false; 5]);
    }

    #[test]
    fn directions_are_compared_the_shortest_way_round() {
        let degrees = |angle: f64| Radians::from_degrees(angle).0;
        let same = Operator::SameDirection(degrees(1.0));
        assert!(same.holds(degrees(179.5), degrees(-179.8)) && same.holds(degrees(-360.0), 0.0));
        assert!(same.holds(degrees(90.0), degrees(90.5)) && Operator::SameDirection(0.5).holds(1.0, 0.5));
        assert!(!same.holds(degrees(178.5), degrees(-179.8)) && !same.holds(degrees(180.0), 0.0));
    }

    #[test]
    fn a_comparison_reads_both_of_its_sides() {
        let signals = Comparison::new(First, Operator::Less, Operand::Signal(Second));
        assert_eq!([(1.0, 2.0), (2.0, 1.0)].map(|y| signals.fired(&y)), [true, false]);
        let value = Comparison::<_, Second>::new(First, Operator::Greater, Operand::Value(1.5));
        assert_eq!([(1.0, 2.0), (2.0, 1.0)].map(|y| value.fired(&y)), [false, true]);
    }
}
