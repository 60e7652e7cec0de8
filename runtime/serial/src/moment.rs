//! Points in time, measured by a clock that continues while the computer is suspended.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// A point in time. Unlike [`std::time::Instant`], it is measured by a clock that does not stop while the computer is
/// suspended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moment(Duration);

impl Moment {
    /// Returns the current time.
    #[must_use]
    pub fn now() -> Self {
        let time = clock_gettime(ClockId::Boottime);
        // Counted from the start of the computer, so neither number is negative.
        Self(Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0)))
    }

    /// Returns the time since this point in time, including the time for which the computer was suspended.
    #[must_use]
    pub fn elapsed(self) -> Duration {
        Self::now().0.saturating_sub(self.0)
    }
}
