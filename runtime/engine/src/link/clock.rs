//! The clock of the link, by which robots measure how long a frame was on its way.

use mdle_runtime::Nanos;
use rustix::time::{ClockId, Timespec, clock_gettime};

/// Returns the time since the computer was started, including suspensions.
///
/// The seconds of this clock are those of the computer's quartz. NTP lets the clock of [`std::time::Instant`] run
/// faster or slower until the time of day is right, so that the frames of a good peer would seem to arrive later and
/// later.
pub(super) fn now() -> Nanos {
    let [raw, slewed, slewed_with_suspensions] =
        [ClockId::MonotonicRaw, ClockId::Monotonic, ClockId::Boottime].map(|clock| nanos(clock_gettime(clock)));
    Nanos(raw.saturating_add(slewed_with_suspensions.saturating_sub(slewed)))
}

fn nanos(Timespec { tv_sec, tv_nsec }: Timespec) -> u64 {
    // Since the computer was started, so neither is negative.
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
        // The other clocks drift from this one while the computer runs.
        let raw = time - suspended;
        assert!((before.saturating_sub(500_000)..=after + 500_000).contains(&raw), "{before} {raw} {after}");
    }
}
