//! Time as the plan sees it: nanoseconds since the plan started (docs/src/reference/semantics.md, 3.1).

/// A time since the plan started, or a duration, in nanoseconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Hash)]
pub struct Nanos(pub u64);

impl Nanos {
    /// Time at which the plan started.
    pub const ZERO: Self = Self(0);
    /// The latest time: 584 years, which no plan reaches.
    pub const MAX: Self = Self(u64::MAX);

    /// Returns the time from `earlier` to this time; zero if `earlier` is later.
    #[must_use]
    pub const fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }

    /// Returns this time in seconds.
    #[must_use]
    pub const fn seconds(self) -> f64 {
        // Exact up to 2^53 nanoseconds, a run of three months; longer times are rounded to microseconds.
        self.0 as f64 / 1e9
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_time_has_passed_since_what_is_still_to_come() {
        assert_eq!(Nanos(7).since(Nanos(3)), Nanos(4));
        assert_eq!(Nanos(3).since(Nanos(7)), Nanos::ZERO);
        assert_eq!(Nanos::MAX.since(Nanos::ZERO), Nanos::MAX);
    }
}
