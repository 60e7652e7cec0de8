//! `goAvoid ψ r v`: drives to a point given by bearing and range, round obstacles (paper, section IV-A), out of the way
//! of a person who approaches the robot, and not before a person who is about to cross its way.

use mdle_runtime::capability::{DiffDrive, Odometry, SonarRing};
use mdle_runtime::{
    Begin, Completes, Control, Law, Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Twist,
};

use crate::approach::Approach;
use crate::crossing::crosses;
use crate::gains::{Gains, fire_in_turn};
use crate::memory::Memory;
use crate::narrow::Narrow;
use crate::stuck::Progress;
use crate::tangent::{Obstacles, Side, Wish};
use crate::way::Ahead;

/// Distance from the goal below which it is reached.
const ARRIVED: Meters = Meters(0.12);
/// Distance between the body and the goal, in metres, below which the robot is near enough if something keeps it from
/// coming nearer: odometry drifts, so a goal near a wall comes to lie in the wall.
const NEAR: f64 = 0.1;
/// Time for which something must have kept the robot from coming nearer.
const KEPT_OFF: Nanos = Nanos(1_000_000_000);
/// Maximum turn rate, in rad/s.
const FASTEST: f64 = 0.9;
/// Angle off the chosen direction from which the robot turns on the spot.
const ON_THE_SPOT: Radians = Radians::from_degrees(50.0);
/// A detour further than this from the goal's direction is kept up.
const DETOUR: Radians = Radians::from_degrees(60.0);
/// A detour that has lasted this long goes along its obstacle: the goal's direction would lead back to where it began.
const ALONG_AFTER: Nanos = Nanos(8_000_000_000);
/// Angle by which a detour is turned towards the obstacle along which it goes.
const ALONG: Radians = Radians::from_degrees(40.0);
/// A detour is over only when it has brought the robot nearer to the goal by this much...
const GAINED: Meters = Meters(0.1);
/// ... and has lasted this long.
const DETOUR_LEAST: Nanos = Nanos(1_000_000_000);
/// Angle from the goal's direction in which the robot gives way to a person who approaches.
const ASIDE: Radians = Radians::from_degrees(60.0);
/// Room on its right with which the robot gives way to the right, as people do; with less it gives way to the side with
/// more room.
const ROOM: Meters = Meters(0.4);
/// Time, in seconds, for which the robot keeps out of the way after somebody should have passed.
const PASSES: f64 = 1.0;
/// Maximum time, in seconds, for which the robot avoids a person who no longer approaches.
const PASSES_MOST: f64 = 8.0;
/// Number of turns in a row in which somebody must be heard: the edge of a cone that touches a wall is heard in fewer.
const SURE: u32 = 5;
/// Time without progress for which the robot follows ways on its map, which is too small to show a way out of a large
/// corner, and for which it then goes round obstacles without the map, in turns.
const SQUEEZES: Nanos = Nanos(30_000_000_000);
const GOES_ROUND: Nanos = Nanos(60_000_000_000);
/// Time without progress after which the robot follows ways on its map.
const HELD_UP: Nanos = Nanos(1_200_000_000);
/// Time for which the robot stands after it has heard somebody come who is about to cross its way.
const STANDS: Nanos = Nanos(2_500_000_000);

/// Drives to the point at a bearing and range from where the atom begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoAvoid {
    bearing: Radians,
    range: Meters,
    speed: MetersPerSecond,
}

impl GoAvoid {
    /// The quark `goAvoid bearing range speed`: the bearing in the frame in which the atom begins, the range from
    /// where the robot then is, the speed where the way is free.
    #[must_use]
    pub const fn new(bearing: Radians, range: Meters, speed: MetersPerSecond) -> Self {
        Self { bearing, range, speed }
    }
}

/// The law of [`GoAvoid`]: done within 0.12 m of the goal, or within 0.3 m where something is in the way of the rest.
///
/// Wheels that slip when they turn leave odometry a heading that is off, and the goal off with it. A robot that knows
/// the drift of its heading by walls ([`Odometry::drift`]) therefore turns the goal by it, around the place where the
/// atom began: walls are taken to run along the axes of the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoingRound {
    goal: Pose,
    progress: Progress,
    /// The pose where the atom began, the direction of the goal from there, and its distance.
    from: (Pose, Radians, Meters),
    /// The direction of the frame's first axis.
    axis: Radians,
    speed: MetersPerSecond,
    look_ahead: Meters,
    /// Distance from the goal at which the robot is near enough.
    near: Meters,
    previous: Option<Radians>,
    detour: Option<Detour>,
    approach: Approach,
    gives_way: Option<GivesWay>,
    /// Time since when something has kept the robot, which is near the goal, from coming nearer.
    kept_off: Option<Nanos>,
    /// Number of turns in a row in which somebody was about to cross the way.
    crossed: u32,
    /// Time until which the robot stands, since somebody crosses its way.
    stands_until: Nanos,
    memory: Memory,
    narrow: Narrow,
}

/// A way round something that leads far off the goal's direction: kept on one side until it has helped, or the robot
/// would turn to and fro in front of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Detour {
    side: Side,
    /// Distance of the goal when the detour began.
    from: Meters,
    since: Nanos,
}

/// The side and the end of giving way to a person who approaches the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
struct GivesWay {
    side: Side,
    until: Nanos,
}

impl GoingRound {
    /// Returns this law on its way to the goal of another.
    pub(crate) fn with_goal_of(self, other: &Self) -> Self {
        Self { goal: other.goal, from: other.from, axis: other.axis, ..self }
    }

    /// Detects a person who approaches along the way to the goal, so that the robot gives way.
    fn look_out<Y: SonarRing>(&mut self, y: &Y, obstacles: &Obstacles, here: Pose, t: Nanos) {
        let goal = self.direction(here);
        self.approach.take(y, here, goal);
        let gives_way = self.gives_way.filter(|gives_way| t < gives_way.until);
        self.gives_way = match self.approach.seconds(here, goal, fire_in_turn(y)) {
            Some(seconds) => {
                let seconds = (seconds + PASSES).min(PASSES_MOST);
                let until = Nanos(t.0.saturating_add((seconds * 1e9) as u64));
                let side = gives_way.map_or_else(|| freer(obstacles, goal), |gives_way| gives_way.side);
                Some(GivesWay { side, until })
            }
            None => gives_way,
        };
    }

    /// The direction of the goal.
    fn direction(&self, here: Pose) -> Radians {
        Radians(libm::atan2(self.goal.y.0 - here.y.0, self.goal.x.0 - here.x.0))
    }

    /// Notes whether something keeps the robot, which is near the goal, from coming nearer.
    fn notice(&mut self, obstacles: &Obstacles, here: Pose, t: Nanos) {
        let Meters(distance) = here.distance(&self.goal);
        let is_in_the_way = obstacles.free(self.direction(here)).0 < distance - ARRIVED.0 || self.narrow.stands();
        let is_kept_off = distance <= self.near.0 && is_in_the_way;
        self.kept_off = self.kept_off.or(Some(t)).filter(|_| is_kept_off);
    }

    /// Returns `true` if the detour has lasted long enough to go along its obstacle.
    fn goes_along(&self, t: Nanos) -> bool {
        self.detour.is_some_and(|detour| t.since(detour.since) > ALONG_AFTER)
    }

    /// The direction in which to give way, along the wall on that side once it is reached.
    fn aside(&mut self, side: Side, goal: Radians, obstacles: &Obstacles, look_ahead: Meters) -> Radians {
        let aside = match side {
            Side::Left => Radians(goal.0 + ASIDE.0),
            Side::Right => Radians(goal.0 - ASIDE.0),
        };
        let wish = Wish { goal: aside, look_ahead, previous: self.previous, side: None, along: false, close: true };
        let chosen = Radians(aside.0 + obstacles.best(&wish).0).wrapped();
        self.previous = Some(chosen);
        chosen
    }

    /// The direction to drive in, in the odometry's axes.
    fn choose(&mut self, obstacles: &Obstacles, here: Pose, t: Nanos) -> Radians {
        let Meters(distance) = here.distance(&self.goal);
        let goal = self.direction(here);
        let look_ahead = Meters(self.look_ahead.0.min(distance).max(ARRIVED.0));
        let over = |detour: Detour| {
            distance < detour.from.0 - GAINED.0
                && obstacles.free(goal) >= look_ahead
                && t.since(detour.since) > DETOUR_LEAST
        };
        self.detour = self.detour.filter(|detour| !over(*detour));
        if let Some(gives_way) = self.gives_way {
            return self.aside(gives_way.side, goal, obstacles, look_ahead);
        }
        let side = self.detour.map(|detour| detour.side);
        // On a detour along the obstacle: as far towards it as there is room, from where the robot heads.
        let along = self.goes_along(t);
        let towards = match side.filter(|_| along) {
            Some(Side::Left) => Radians(here.theta.0 - ALONG.0),
            Some(Side::Right) => Radians(here.theta.0 + ALONG.0),
            None => goal,
        };
        let wish = Wish { goal: towards, look_ahead, previous: self.previous, side, along, close: false };
        let offset = obstacles.best(&wish);
        if self.detour.is_none() && offset.0.abs() > DETOUR.0 {
            let side = if offset.0 > 0.0 { Side::Left } else { Side::Right };
            self.detour = Some(Detour { side, from: Meters(distance), since: t });
        }
        let chosen = Radians(towards.0 + offset.0).wrapped();
        self.previous = Some(chosen);
        chosen
    }
}

/// The direction that the tangent rule has chosen, and the ways that are free.
struct Chosen {
    direction: Radians,
    /// Length of the way that is free where the robot heads.
    ahead: Meters,
    /// Length of the way to the goal that is free; `None` on a detour.
    to_goal: Option<Meters>,
}

impl GoingRound {
    /// Looks at what the sonars see, and chooses a direction; `None` while the robot stands, since somebody crosses its
    /// way.
    ///
    /// Not inlined: the obstacles have left the stack before [`Self::squeeze`] puts a map there.
    #[inline(never)]
    fn look<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose, t: Nanos) -> Option<Chosen> {
        let mut obstacles = Obstacles::seen(y, here);
        self.look_out(y, &obstacles, here, t);
        self.notice(&obstacles, here, t);
        let crosses = self.gives_way.is_none() && crosses(y, here, self.speed.0);
        self.crossed = if crosses { self.crossed.saturating_add(1) } else { 0 };
        if self.gives_way.is_some() {
            self.stands_until = Nanos::ZERO;
        } else if self.crossed >= SURE {
            self.stands_until = Nanos(t.0.saturating_add(STANDS.0));
        }
        if t < self.stands_until {
            return None;
        }
        let direction = if self.goes_along(t) {
            let seen = obstacles.remember(&self.memory, here, t);
            let direction = self.choose(&obstacles, here, t);
            obstacles.forget(seen);
            direction
        } else {
            self.choose(&obstacles, here, t)
        };
        let to_goal = self.detour.is_none().then(|| obstacles.free(self.direction(here)));
        Some(Chosen { direction, ahead: obstacles.free(here.theta), to_goal })
    }

    /// The input in a narrow place, or before one; `None` elsewhere.
    fn squeeze<Y: DiffDrive>(&mut self, y: &Y, here: Pose, t: Nanos, chosen: &Chosen) -> Option<Twist> {
        let stalled = self.progress.stalled(here, &self.goal, t);
        if stalled < HELD_UP && !self.narrow.follows() {
            return None;
        }
        let goes_round = stalled.0 % (SQUEEZES.0 + GOES_ROUND.0) >= SQUEEZES.0;
        if self.gives_way.is_some() || goes_round {
            self.narrow.leave();
            let keeps_off = goes_round.then(|| self.narrow.round(y, here, chosen.direction, self.speed));
            return keeps_off.flatten();
        }
        let distance = here.distance(&self.goal);
        let asked = Meters(self.look_ahead.0.min(distance.0));
        let from = self.detour.map_or(distance, |detour| Meters(detour.from.0.min(distance.0)));
        let free = chosen.to_goal.map(|free| (free, asked));
        let chosen = chosen.direction;
        let ahead = Ahead { goal: self.goal, from, chosen, free, speed: self.speed, before: None };
        self.narrow.input(y, here, t, ahead)
    }
}

/// The side to which to give way.
fn freer(obstacles: &Obstacles, goal: Radians) -> Side {
    let [left, right] = [90.0, -90.0].map(|side| obstacles.free(Radians(goal.0 + Radians::from_degrees(side).0)));
    if right >= ROOM || right >= left { Side::Right } else { Side::Left }
}

impl<Y: DiffDrive + Odometry + SonarRing> Control<Y> for GoAvoid {
    type Law = GoingRound;

    // Not inlined, so that the law is written once, where it is to be.
    #[inline(never)]
    fn begin(&self, y: &Y, begin: Begin) -> GoingRound {
        let (here, bearing) = (y.pose(), begin.frame.outward(self.bearing));
        let goal = here.towards(bearing, self.range);
        GoingRound {
            goal,
            progress: Progress::begin(here, &goal, begin.now),
            from: (here, bearing, self.range),
            axis: begin.frame.outward(Radians(0.0)),
            speed: self.speed,
            look_ahead: Gains::of(y).look_ahead,
            near: Meters(y.body_radius().0 + NEAR),
            previous: None,
            detour: None,
            approach: Approach::default(),
            gives_way: None,
            kept_off: None,
            crossed: 0,
            stands_until: Nanos::ZERO,
            memory: Memory::EMPTY,
            narrow: Narrow::EMPTY,
        }
    }
}

impl<Y: DiffDrive + Odometry + SonarRing> Law<Y> for GoingRound {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let here = y.pose();
        // Beside obstacles that the robot passes closely, walls are no hallway.
        if !self.narrow.follows() {
            let (begun, bearing, range) = self.from;
            self.goal = begun.towards(Radians(bearing.0 + y.drift(self.axis).0), range);
        }
        self.progress.take(here, &self.goal, t);
        self.memory.take(y);
        self.narrow.take(y, here);
        let Some(chosen) = self.look(y, here, t) else { return Twist::default() };
        if let Some(twist) = self.squeeze(y, here, t, &chosen) {
            return twist;
        }
        let Radians(off) = Radians(chosen.direction.0 - here.theta.0).wrapped();
        let Meters(ahead) = chosen.ahead;
        let Meters(distance) = here.distance(&self.goal);
        let v = (self.speed.0 * (1.0 - off.abs() / ON_THE_SPOT.0)).min(0.9 * (ahead - 0.03)).min(0.8 * distance + 0.03);
        let omega = (y.steering().avoid * off).clamp(-FASTEST, FASTEST);
        Twist { v: MetersPerSecond(v.max(0.0)), omega: RadiansPerSecond(omega) }
    }

    fn stalled(&self, y: &Y, t: Nanos) -> Option<Nanos> {
        Some(self.progress.stalled(y.pose(), &self.goal, t))
    }
}

impl<Y: DiffDrive + Odometry + SonarRing> Completes<Y> for GoingRound {
    fn completed(&self, y: &Y, t: Nanos) -> bool {
        y.pose().distance(&self.goal) <= ARRIVED || self.kept_off.is_some_and(|since| t.since(since) > KEPT_OFF)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, begun, framed, until_completed};

    fn quark(bearing: f64, range: f64) -> GoAvoid {
        GoAvoid::new(Radians::from_degrees(bearing), Meters(range), MetersPerSecond(0.2))
    }

    #[test]
    fn arrives_at_a_point_given_from_where_the_atom_begins() {
        let mut y = Sensed::heading(30.0);
        y.pose.x = Meters(5.0);
        let mut law = quark(90.0, 2.0).begin(&y, framed(180.0));
        until_completed(&mut law, &mut y);
        let goal = Pose { x: Meters(5.0), y: Meters(-2.0), theta: Radians(0.0) };
        assert!(y.pose.distance(&goal) <= ARRIVED, "{:?}", y.pose);
    }

    #[test]
    fn a_range_of_nothing_is_done_at_once() {
        let y = Sensed::default();
        assert!(quark(90.0, 0.0).begin(&y, begun()).completed(&y, Nanos::ZERO));
    }

    #[test]
    fn arrives_by_one_sonar_that_still_works() {
        for number in 0..16 {
            for confirmation in [2, 3] {
                let mut y = Sensed { confirmation, ..Sensed::default() };
                for _ in 0..3 {
                    y.ping(mdle_runtime::SonarId::new(number), Some(0.8));
                }
                let mut law = quark(0.0, 2.0).begin(&y, begun());
                until_completed(&mut law, &mut y);
                let goal = Pose { x: Meters(2.0), ..Pose::ORIGIN };
                assert!(y.pose.distance(&goal) <= ARRIVED, "sonar {number}: {:?}", y.pose);
            }
        }
    }

    #[test]
    fn never_drives_backwards_nor_into_what_is_close_ahead() {
        let mut y = Sensed::default();
        for number in 0..16 {
            y.ping(mdle_runtime::SonarId::new(number), Some(0.02));
        }
        let mut law = quark(0.0, 40.0).begin(&y, begun());
        for turn in 0..50 {
            assert_eq!(law.input(&y, Nanos(turn * 100_000_000)).v.0, 0.0);
        }
    }
}
