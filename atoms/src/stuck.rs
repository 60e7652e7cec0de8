//! `stuck T`: fires when the law that runs makes no progress towards its goal. The interrupt is not in the paper; this
//! project has added it beside the paper's `goAvoid` (docs/src/reference/semantics.md, 3.5).

use mdle_runtime::capability::Odometry;
use mdle_runtime::{Interrupt, Meters, Nanos, Pose};

/// Distance, in metres, by which the robot must come nearer to the goal of its law to have made progress.
const NEARER: f64 = 0.1;

/// The interrupt `stuck`, which fires when the law of the previous turn has made no progress for `duration`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stuck {
    duration: Nanos,
}

impl Stuck {
    /// Creates the quark `stuck duration`.
    #[must_use]
    pub const fn new(duration: Nanos) -> Self {
        Self { duration }
    }
}

impl<Y: Odometry> Interrupt<Y> for Stuck {
    /// Returns `false`, because the output alone does not show progress towards a goal.
    fn fired(&self, _: &Y) -> bool {
        false
    }

    fn fired_during(&self, _: &Y, stalled: Option<Nanos>) -> bool {
        stalled.is_some_and(|stalled| stalled >= self.duration)
    }
}

/// The progress of a law towards a place, by odometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Progress {
    /// Distance from the goal when the law last made progress; initially, the distance at which the law began.
    from: Meters,
    /// Time at which the law last made progress; initially, the time at which it began.
    at: Nanos,
}

impl Progress {
    /// Returns the progress of a law that begins at the time `now` and the pose `here`.
    pub(crate) fn begin(here: Pose, goal: &Pose, now: Nanos) -> Self {
        Self { from: here.distance(goal), at: now }
    }

    /// Returns the progress towards another goal, which is further away than the previous goal by this distance.
    pub(crate) fn moved(self, further: Meters) -> Self {
        Self { from: Meters(self.from.0 + further.0), ..self }
    }

    /// Updates the progress with the robot's pose in a turn.
    pub(crate) fn take(&mut self, here: Pose, goal: &Pose, now: Nanos) {
        let distance = here.distance(goal);
        if self.is_made(distance) {
            *self = Self { from: distance, at: now };
        }
    }

    /// Returns the time for which the robot, now at `here`, has made no progress.
    pub(crate) fn stalled(&self, here: Pose, goal: &Pose, now: Nanos) -> Nanos {
        if self.is_made(here.distance(goal)) { Nanos::ZERO } else { now.since(self.at) }
    }

    fn is_made(&self, distance: Meters) -> bool {
        distance.0 <= self.from.0 - NEARER
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    const GOAL: Pose = Pose { x: Meters(5.0), ..Pose::ORIGIN };

    fn at(x: f64) -> Pose {
        Pose { x: Meters(x), ..Pose::ORIGIN }
    }

    #[test]
    fn ten_centimetres_towards_the_goal_are_progress() {
        let mut progress = Progress::begin(at(0.0), &GOAL, Nanos(7));
        for (x, now, stalled) in [(0.05, 10, 3), (0.09, 20, 13), (-1.0, 30, 23), (0.11, 40, 0), (0.2, 50, 10)] {
            assert_eq!(progress.stalled(at(x), &GOAL, Nanos(now)), Nanos(stalled), "at {x}");
            progress.take(at(x), &GOAL, Nanos(now));
        }
        assert_eq!(progress.stalled(at(0.22), &GOAL, Nanos(60)), Nanos(0));
    }

    #[test]
    fn a_goal_that_moves_off_leaves_the_progress() {
        let mut progress = Progress::begin(at(0.0), &GOAL, Nanos(0));
        for step in 1..=12_i32 {
            // The goal stays 5 m ahead of a robot that drives at it by 1/64 m, without rounding, in each step.
            let here = at(f64::from(step) / 64.0);
            progress = progress.moved(Meters(1.0 / 64.0));
            progress.take(here, &at(here.x.0 + 5.0), Nanos(u64::from(step.unsigned_abs())));
        }
        // Seven steps are the first 10 cm; five more are less than that.
        assert_eq!(progress.at, Nanos(7));
    }

    #[test]
    fn fires_by_what_the_law_reports() {
        let (stuck, y) = (Stuck::new(Nanos(5)), Sensed::default());
        let fired = [None, Some(Nanos(4)), Some(Nanos(5))].map(|stalled| stuck.fired_during(&y, stalled));
        assert_eq!(fired, [false, false, true]);
        assert!(!stuck.fired(&y));
    }
}
