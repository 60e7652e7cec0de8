//! Source of real time.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

use crate::scheduling;

/// Source of real time; tests use a source that they control.
pub(crate) trait Instants {
    /// Returns the time since a fixed point in time before the first turn; it never decreases.
    fn now(&mut self) -> Duration;
    /// Sleeps for approximately `time`.
    fn sleep(&mut self, time: Duration);
    /// Asks the system to wake this thread on time.
    ///
    /// # Errors
    /// Returns a message if the system does not permit this.
    fn keep_time(&mut self) -> Result<(), String> {
        Ok(())
    }
}

/// Clock of the time since the computer was started, including the time for which it was suspended.
#[derive(Debug)]
pub(crate) struct SinceBoot;

impl Instants for SinceBoot {
    fn now(&mut self) -> Duration {
        let now = clock_gettime(ClockId::Boottime);
        Duration::new(now.tv_sec.try_into().unwrap_or(0), now.tv_nsec.try_into().unwrap_or(0))
    }

    fn sleep(&mut self, time: Duration) {
        std::thread::sleep(time);
    }

    fn keep_time(&mut self) -> Result<(), String> {
        scheduling::claim()
    }
}

/// Converts a duration to nanoseconds; longer durations than 584 years become `u64::MAX`.
pub(crate) fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
