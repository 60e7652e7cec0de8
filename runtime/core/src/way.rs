//! Lengths of the path driven, as plans compare them: in whole nanometres, so that every computer gets the same
//! sum (docs/src/reference/semantics.md, 3.3).

use crate::Meters;

/// Length of a driven path, in nanometres: a reading of an odometer, or the difference of two readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Hash)]
pub struct Nanometers(pub u64);

impl Nanometers {
    /// A path of length zero.
    pub const ZERO: Self = Self(0);

    /// Returns the length rounded to the nearest nanometre; zero for a negative length or NaN.
    #[must_use]
    pub fn round(length: Meters) -> Self {
        // The conversion to an integer saturates, and converts NaN to 0.
        Self(libm::round(length.0 * 1e9) as u64)
    }

    /// Returns the length of the path since an `earlier` reading; zero if `earlier` is larger.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }

    /// Returns the reading after a further path of this `length`.
    #[must_use]
    pub const fn plus(self, length: Self) -> Self {
        Self(self.0.saturating_add(length.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_to_whole_nanometres() {
        let rounded = |length: f64| Nanometers::round(Meters(length)).0;
        assert_eq!([0.0, 0.04, 1.0, 4e-10, 6e-10].map(rounded), [0, 40_000_000, 1_000_000_000, 0, 1]);
        assert_eq!([-1.0, f64::NAN, f64::INFINITY].map(rounded), [0, 0, u64::MAX]);
    }

    #[test]
    fn readings_neither_go_below_zero_nor_overflow() {
        assert_eq!(Nanometers(7).since(Nanometers(3)), Nanometers(4));
        assert_eq!(Nanometers(3).since(Nanometers(7)), Nanometers::ZERO);
        assert_eq!(Nanometers(u64::MAX).plus(Nanometers(1)), Nanometers(u64::MAX));
    }
}
