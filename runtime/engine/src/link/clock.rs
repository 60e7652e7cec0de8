//! The clock of the link. Robots use it to measure the transmission time of frames.

use mdle_runtime::Nanos;
use rustix::time::{ClockId, Timespec, clock_gettime};

/// Returns the time since the computer was started, including the time for which it was suspended.
///
/// This clock runs at the rate of the computer's quartz. [`std::time::Instant`] does not: NTP adjusts its rate until
/// the time of day is correct, and meanwhile the frames of a good peer would seem to arrive later and later.
pub(super) fn now() -> Nanos {
    let [raw, slewed, slewed_with_suspensions] =
        [ClockId::MonotonicRaw, ClockId::Monotonic, ClockId::Boottime].map(|clock| nanos(clock_gettime(clock)));
    Nanos(raw.saturating_add(slewed_with_suspensions.saturating_sub(slewed)))
}

fn nanos(Timespec { tv_sec, tv_nsec }: Timespec) -> u64 {
    // Both values count from the start of the computer, so they are not negative.
    let [seconds, nanos] = [tv_sec, tv_nsec].map(|number| u64::try_from(number).unwrap_or(0));
    seconds.saturating_mul(1_000_000_000).saturating_add(nanos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ntp_does_not_slew_the_clock() {
        let now = |clock| nanos(clock_gettime(clock));
        let suspension = |_| [ClockId::Monotonic, ClockId::Boottime].map(now);
        let suspended = (0..100).map(suspension).map(|[slewed, time]| time - slewed).min().unwrap();
        let (before, time, after) = (now(ClockId::MonotonicRaw), super::now().0, now(ClockId::MonotonicRaw));
        // The other clocks drift relative to this clock while the computer runs.
        let raw = time - suspended;
        assert!((before.saturating_sub(500_000)..=after + 500_000).contains(&raw), "{before} {raw} {after}");
    }
}
