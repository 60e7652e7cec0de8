//! Operators of comparisons.

use crate::Radians;

/// Operator that compares two values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Operator {
    /// The values differ by at most this tolerance.
    Equal(f64),
    /// Two directions differ by at most this tolerance, measured along the shorter arc.
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
