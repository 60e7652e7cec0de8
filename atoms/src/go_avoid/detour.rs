//! A detour of `goAvoid`: a way round an obstacle that leads far off the goal's direction. The robot keeps to one side
//! of the obstacle until the detour has helped, or until it circles in one place; otherwise it would turn back and
//! forth in front of the obstacle.

use core::f64::consts::TAU;

use mdle_runtime::{Meters, Nanos, Pose, Radians};

use crate::tangent::Side;

/// Time after which a detour follows its obstacle and no longer aims at the goal, whose direction would lead back to
/// the place where the detour began.
const ALONG_AFTER: Nanos = Nanos(8_000_000_000);
/// Distance by which the robot must have come nearer to the goal before a detour has helped; `LEAST` must have passed
/// as well.
const GAINED: Meters = Meters(0.1);
/// Minimum duration of a detour.
const LEAST: Nanos = Nanos(1_000_000_000);
/// Minimum duration of a detour whose goal has been replaced by another one. The distance of such a goal may be
/// unknown, so it cannot be measured how much nearer the robot has come.
const LEAST_RENEWED: Nanos = Nanos(4_000_000_000);
/// Angle, in radians. A robot that turns towards the obstacle by more than this angle within `SAME_PLACE` drives in
/// circles, because it has lost the obstacle. The angle is larger than a full turn, because a robot turns by up to a
/// full turn within `SAME_PLACE` on the way out of a corner.
const CIRCLES: f64 = 1.5 * TAU;
/// Distance from the pose at which a circle may have begun beyond which the robot has left the place. Circles round
/// nothing or round a post are smaller, and the ends of the walls of a maze are further apart.
const SAME_PLACE: Meters = Meters(1.0);

/// The side of the obstacle, and the distance, time and turns from which the end of the detour is determined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Detour {
    pub(super) side: Side,
    /// Distance from the goal when the detour began.
    from: Meters,
    since: Nanos,
    /// Pose at which a circle may have begun, and the angle turned until then.
    circle: (Pose, Radians),
}

impl Detour {
    /// Begins a detour of a robot at `here` on this side of an obstacle; `turned` is the angle that the robot has
    /// turned since the law began.
    pub(super) fn begin(side: Side, goal: &Pose, here: Pose, turned: Radians, t: Nanos) -> Self {
        Self { side, from: here.distance(goal), since: t, circle: (here, turned) }
    }

    /// Returns the distance from the goal when the detour began.
    pub(super) fn from(&self) -> Meters {
        self.from
    }

    /// Returns `true` if the detour has lasted so long that it now follows its obstacle.
    pub(super) fn goes_along(&self, t: Nanos) -> bool {
        t.since(self.since) > ALONG_AFTER
    }

    /// Returns `true` if a robot at this distance from the goal has come nearer by the detour. `is_renewed` is `true`
    /// if another goal has replaced the first one.
    pub(super) fn has_helped(&self, distance: Meters, t: Nanos, is_renewed: bool) -> bool {
        if is_renewed {
            t.since(self.since) > LEAST_RENEWED
        } else {
            distance.0 < self.from.0 - GAINED.0 && t.since(self.since) > LEAST
        }
    }

    /// Returns `true` if the robot at `here` circles: it has turned by `CIRCLES` towards the obstacle and is still near
    /// the place at which it began to. It has then lost the obstacle. `turned` is the angle turned since the law began.
    /// While the robot follows a way on its map, `is_on_map`, turns do not count, because the way may lead back and
    /// forth beside an obstacle that is not lost.
    pub(super) fn circles(&mut self, here: Pose, turned: Radians, is_on_map: bool) -> bool {
        if is_on_map || here.distance(&self.circle.0) > SAME_PLACE {
            self.circle = (here, turned);
        }
        let turned = turned.0 - self.circle.1.0;
        match self.side {
            Side::Left => turned < -CIRCLES,
            Side::Right => turned > CIRCLES,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of quarters of a circle, of eight, during which a detour on this side does not circle, as the
    /// robot turns towards the obstacle and drives this distance, in metres, in each quarter.
    fn quarters(side: Side, distance: f64, is_on_map: bool) -> usize {
        let goal = Pose { x: Meters(50.0), ..Pose::ORIGIN };
        let mut detour = Detour::begin(side, &goal, Pose::ORIGIN, Radians(0.0), Nanos::ZERO);
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        let mut circles = |quarter: &i32| {
            let here = Pose { x: Meters(distance * f64::from(*quarter)), ..Pose::ORIGIN };
            detour.circles(here, Radians(sign * TAU / 4.0 * f64::from(*quarter)), is_on_map)
        };
        (1..=8).take_while(|quarter| !circles(quarter)).count()
    }

    #[test]
    fn a_detour_ends_where_the_robot_circles() {
        for side in [Side::Left, Side::Right] {
            assert_eq!(quarters(side, 0.1, false), 6, "{side:?}");
            assert_eq!(quarters(side, 0.4, false), 8, "the walls of a maze lead on");
            assert_eq!(quarters(side, 0.1, true), 8, "the way on the map turns the robot");
        }
    }

    #[test]
    fn a_detour_goes_on_where_the_robot_turns_from_its_obstacle() {
        let mut detour = Detour::begin(Side::Left, &Pose::ORIGIN, Pose::ORIGIN, Radians(0.0), Nanos::ZERO);
        assert!(!detour.circles(Pose::ORIGIN, Radians(2.0 * TAU), false));
    }
}
