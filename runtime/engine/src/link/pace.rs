//! Limits the rate at which another robot may send plans, because each plan is compiled and recorded.

use mdle_runtime::Nanos;

/// Minimum average time between two plans, in nanoseconds.
const SPACING: u64 = 1_000_000_000;
/// Maximum size of a burst of plans, expressed in nanoseconds: the time that the burst's plans take at the maximum
/// average rate.
const BURST: u64 = 4 * SPACING;

/// Rate limiter for the plans of one robot.
#[derive(Debug, Default)]
pub(super) struct RateLimiter {
    /// Time at or after which a full burst of plans is permitted again.
    rested: Nanos,
    /// `true` if the last plan came too early.
    is_too_fast: bool,
}

/// Decision about a plan, based on its arrival time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Admission {
    /// The plan is accepted.
    Taken,
    /// The plan comes too soon after the previous accepted plan.
    TooFast,
    /// The plan comes too soon, as the previous plan did.
    StillTooFast,
}

impl RateLimiter {
    /// Decides whether to accept a plan that arrives at time `now`.
    pub(super) fn admits(&mut self, now: Nanos) -> Admission {
        // After the clock jumps back, no robot waits longer than after a full burst.
        let debt = self.rested.since(now).0.min(BURST);
        let was_too_fast = std::mem::replace(&mut self.is_too_fast, debt + SPACING > BURST);
        let spent = if self.is_too_fast { debt } else { debt + SPACING };
        self.rested = Nanos(now.0.saturating_add(spent));
        match (self.is_too_fast, was_too_fast) {
            (false, _) => Admission::Taken,
            (true, false) => Admission::TooFast,
            (true, true) => Admission::StillTooFast,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_plans_come_at_once_and_then_one_a_second() {
        let mut pace = RateLimiter::default();
        let mut at = |millis: u64| pace.admits(Nanos(millis * 1_000_000));
        use Admission::{StillTooFast, Taken, TooFast};
        assert_eq!([5_000; 6].map(&mut at), [Taken, Taken, Taken, Taken, TooFast, StillTooFast]);
        assert_eq!([5_999, 6_000, 6_001, 7_000].map(&mut at), [StillTooFast, Taken, TooFast, Taken]);
        // The clock jumps back by more than an hour.
        assert_eq!([0, 999, 1_000, 9_000].map(&mut at), [TooFast, StillTooFast, Taken, Taken]);
    }
}
