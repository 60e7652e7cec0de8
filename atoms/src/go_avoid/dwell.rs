//! Detects that a rectangle that `goAvoid` drives has stayed in one place for long, as in a dead end into which the
//! detour of its obstacle has led. The robot then has to leave the place before it drives to its goal again.

use mdle_runtime::{Meters, Nanos, Pose};

/// Distance within which the robot counts as staying in one place.
const SAME_PLACE: Meters = Meters(0.4);
/// Time after which the robot has to leave. With 10 s, robots that are still turning in a narrow place would leave it.
const LONG: Nanos = Nanos(15_000_000_000);
/// Distance at which the robot has left.
const LEFT: Meters = Meters(1.0);
/// Time since the robot came to the place after which it no longer tries to leave, because nothing on its map leads
/// away.
const GIVES_UP: Nanos = Nanos(45_000_000_000);

/// The place in which the robot is, and the time since which it has been there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dwell {
    at: Pose,
    since: Nanos,
    leaves: bool,
}

impl Dwell {
    /// Begins at a place to which the robot has just come.
    pub(super) fn begin(here: Pose, t: Nanos) -> Self {
        Self { at: here, since: t, leaves: false }
    }

    /// Updates the place of a robot that is at `here` and makes no progress. Returns `true` if the robot has to leave
    /// from this time on.
    pub(super) fn take(&mut self, here: Pose, t: Nanos) -> bool {
        let (within, time) = if self.leaves { (LEFT, GIVES_UP) } else { (SAME_PLACE, LONG) };
        let (is_here, is_over) = (here.distance(&self.at) <= within, t.since(self.since) > time);
        if !is_here || is_over && self.leaves {
            *self = Self::begin(here, t);
        } else if is_over {
            self.leaves = true;
            return true;
        }
        false
    }

    /// Returns `true` if the robot has to leave the place.
    pub(super) fn leaves(&self) -> bool {
        self.leaves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of seconds, of the first `seconds`, in which a robot has to leave; its distance from its
    /// start, in metres, is a function of the time in seconds.
    fn leaves(seconds: u64, distance: impl Fn(u64) -> f64) -> usize {
        let at = |second: u64| Pose { x: Meters(distance(second)), ..Pose::ORIGIN };
        let mut dwell = Dwell::begin(at(0), Nanos::ZERO);
        let mut leaves = |second: &u64| {
            dwell.take(at(*second), Nanos(1_000_000_000 * second));
            dwell.leaves()
        };
        (1..=seconds).filter(|second| leaves(second)).count()
    }

    #[test]
    fn a_robot_that_stays_in_one_place_leaves_it() {
        assert_eq!([15, 16, 45, 46, 61, 62].map(|seconds| leaves(seconds, |_| 0.0)), [0, 1, 30, 30, 30, 31]);
        let moves_at_30 = |second| if second < 30 { 0.3 } else { 1.4 };
        assert_eq!(leaves(40, moves_at_30), 14, "it has left");
        assert_eq!(leaves(70, |second| 0.05 * second as f64), 0, "it moves on");
    }
}
