//! Decides how a robot reacts to people on its way whom its sonars detect: it gives way to a person who approaches, and
//! stops, or backs off, for a person who crosses the way.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians};

use crate::approach::Approach;
use crate::crossing::{Driving, crosses};
use crate::gains::fire_in_turn;
use crate::missed::BeforeMissed;
use crate::tangent::{Obstacles, Side};

/// Minimum room on the robot's right at which the robot gives way to the right, as people do. With less room, it gives
/// way to the side with more room.
const ROOM: Meters = Meters(0.4);
/// Time, in seconds, for which the robot keeps out of the way after a person should have passed.
const PASSES: f64 = 1.0;
/// Maximum time, in seconds, for which the robot keeps out of the way of a person whose approach it no longer detects.
const PASSES_MOST: f64 = 8.0;
/// Number of consecutive turns in which the robot must detect a crossing person before it reacts. A wall that the edge
/// of a cone touches is mistaken for a person in fewer turns.
const SURE: u32 = 5;
/// Time after a person made the robot stop, in seconds, in which it does not mind doubtful cells of its map: a person
/// leaves such cells, and a robot that hesitates where people walk is met more often.
const JUST: f64 = 20.0;
/// Minimum time, in seconds, for which the robot stands still for a person who is about to cross its way; it stands
/// still at least until the person should have passed.
const STANDS: f64 = 2.5;
/// Distance, in metres, from the place where the robot last backed off, within which it does not back off again: a wall
/// that it mistook for a person whenever it passed would hold it there for ever.
const ONCE: f64 = 0.5;
/// Maximum angle between the heading of a robot that backs off and the direction to its goal. Behind a robot that has
/// turned further, the person may walk.
const ASTRAY: Radians = Radians::from_degrees(30.0);
/// Minimum free length of the way behind a robot that backs off.
const BEHIND: Meters = Meters(0.25);

/// The people on the way to a goal, and the robot's reaction to them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passers {
    approach: Approach,
    gives_way: Option<GivesWay>,
    before_missed: BeforeMissed,
    /// Number of consecutive turns up to now in which a person was about to cross the way.
    crossed: u32,
    /// Time until which the robot stands still, because a person crosses its way.
    stands_until: Nanos,
    /// Pose at which the robot last detected the crossing person, and the distance, in metres, by which the robot backs
    /// off from there.
    back: (Pose, f64),
    /// Pose at which the robot last began to back off.
    backed: Option<Pose>,
    /// `true` if the robot may back off from the person for whom it stops.
    may_back: bool,
}

/// The side to which the robot gives way to an approaching person, and the time until which it does so.
#[derive(Debug, Clone, Copy, PartialEq)]
struct GivesWay {
    side: Side,
    until: Nanos,
}

impl Default for Passers {
    fn default() -> Self {
        Self {
            approach: Approach::default(),
            gives_way: None,
            before_missed: BeforeMissed::default(),
            crossed: 0,
            stands_until: Nanos::ZERO,
            back: (Pose::ORIGIN, 0.0),
            backed: None,
            may_back: true,
        }
    }
}

impl Passers {
    /// Updates the state with the pings of a turn, for a robot that drives in the direction `goal` at this speed.
    pub(crate) fn take<Y: DiffDrive + SonarRing>(
        &mut self,
        y: &Y,
        obstacles: &Obstacles,
        here: Pose,
        (goal, speed): (Radians, MetersPerSecond),
        t: Nanos,
    ) {
        self.look_ahead(y, obstacles, here, goal, t);
        self.before_missed.take(y);
        if self.gives_way.is_some() {
            (self.crossed, self.stands_until) = (0, Nanos::ZERO);
            return;
        }
        let person = crosses(y, &self.before_missed, here, Driving { speed: speed.0, waits: self.stops(t) });
        self.crossed = if person.is_some() { self.crossed.saturating_add(1) } else { 0 };
        if let Some(person) = person.filter(|_| self.crossed >= SURE) {
            let begins = !self.stops(t);
            if begins {
                self.may_back = self.backed.is_none_or(|place| here.distance(&place).0 > ONCE);
            }
            self.stands_until = self.stands_until.max(after(t, person.passed.max(STANDS)));
            let is_astray = Radians(here.theta.0 - goal.0).wrapped().0.abs() > ASTRAY.0;
            let back = if self.may_back && !is_astray { person.back } else { 0.0 };
            // A robot that backs off from a person goes on while the person comes nearer.
            if begins || back > 0.0 {
                self.back = (here, back);
            }
            if back > 0.0 {
                self.backed = Some(here);
            }
        }
    }

    /// Detects a person who approaches along the way to the goal, and makes the robot give way.
    fn look_ahead<Y: SonarRing>(&mut self, y: &Y, obstacles: &Obstacles, here: Pose, goal: Radians, t: Nanos) {
        self.approach.take(y, here, goal);
        let gives_way = self.gives_way.filter(|gives_way| t < gives_way.until);
        self.gives_way = match self.approach.seconds(here, goal, fire_in_turn(y)) {
            Some(seconds) => {
                let until = after(t, (seconds + PASSES).min(PASSES_MOST));
                let side = gives_way.map_or_else(|| freer(obstacles, goal), |gives_way| gives_way.side);
                Some(GivesWay { side, until })
            }
            None => gives_way,
        };
    }

    /// Returns the side to which the robot gives way; `None` if it gives way to nobody.
    pub(crate) fn gives_way(&self) -> Option<Side> {
        self.gives_way.map(|gives_way| gives_way.side)
    }

    /// Returns `true` if the robot does not drive on at this time, because a person crosses its way.
    pub(crate) fn stops(&self, t: Nanos) -> bool {
        t < self.stands_until
    }

    /// Returns `true` if a person made the robot stop within the last [`JUST`] seconds.
    pub(crate) fn has_just_met(&self, t: Nanos) -> bool {
        self.stands_until > Nanos::ZERO && t < after(self.stands_until, JUST)
    }

    /// Returns the speed at which the robot, at `here`, keeps out of the way of the person for whom it stops: it backs
    /// off at most at `speed`, or stands still.
    pub(crate) fn waits(&self, obstacles: &Obstacles, here: Pose, speed: MetersPerSecond) -> MetersPerSecond {
        let (from, back) = self.back;
        let behind = obstacles.free(Radians(here.theta.0 + core::f64::consts::PI));
        let backs_off = here.distance(&from).0 < back && behind >= BEHIND;
        MetersPerSecond(if backs_off { -speed.0 } else { 0.0 })
    }
}

/// Returns the time this many seconds after `t`.
fn after(t: Nanos, seconds: f64) -> Nanos {
    Nanos(t.0.saturating_add((seconds * 1e9) as u64))
}

/// Returns the side to which the robot gives way, which depends on the room on both sides.
fn freer(obstacles: &Obstacles, goal: Radians) -> Side {
    let [left, right] = [90.0, -90.0].map(|side| obstacles.free(Radians(goal.0 + Radians::from_degrees(side).0)));
    if right >= ROOM || right >= left { Side::Right } else { Side::Left }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_has_just_been_met_for_twenty_seconds() {
        let second = |number: u64| Nanos(number * 1_000_000_000);
        let met = Passers { stands_until: second(30), ..Passers::default() };
        assert_eq!([29, 49, 50].map(|number| met.has_just_met(second(number))), [true, true, false]);
        assert!(!Passers::default().has_just_met(second(1)));
    }
}
