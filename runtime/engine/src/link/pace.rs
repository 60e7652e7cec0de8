//! The rate at which another robot may send plans. It is limited because each plan is compiled and recorded.

use mdle_runtime::Nanos;

/// Average time between two plans at the maximum rate, in nanoseconds.
const SPACING: u64 = 1_000_000_000;
/// Maximum burst: the time, in nanoseconds, that its plans would take at this average.
const BURST: u64 = 4 * SPACING;

/// The pace of one robot.
#[derive(Debug, Default)]
pub(super) struct Pace {
    /// Time after which a full burst is permitted again.
    rested: Nanos,
    /// `true` if the last plan came too fast.
    is_too_fast: bool,
}

/// Decision about a plan, depending on the time at which it arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Admission {
    /// The plan is taken.
    Taken,
    /// The plan comes too fast after one that was taken.
    TooFast,
    /// The plan comes too fast, as did the plan before it.
    StillTooFast,
}

impl Pace {
    /// Decides about a plan that comes at time `now`.
    pub(super) fn admits(&mut self, now: Nanos) -> Admission {
        // A clock that jumps back makes nobody wait longer than a burst does.
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
        let mut pace = Pace::default();
        let mut at = |millis: u64| pace.admits(Nanos(millis * 1_000_000));
        use Admission::{StillTooFast, Taken, TooFast};
        assert_eq!([5_000; 6].map(&mut at), [Taken, Taken, Taken, Taken, TooFast, StillTooFast]);
        assert_eq!([5_999, 6_000, 6_001, 7_000].map(&mut at), [StillTooFast, Taken, TooFast, Taken]);
        // The clock jumps back by an hour and more.
        assert_eq!([0, 999, 1_000, 9_000].map(&mut at), [TooFast, StillTooFast, Taken, Taken]);
    }
}
