//! `goAvoid ψ r v`: drives round obstacles to a point that is given by its bearing and range (paper, section IV-A). The
//! robot gives way to a person who approaches it, and waits for a person who is about to cross its way.

use mdle_runtime::capability::{DiffDrive, Odometry, SonarRing};
use mdle_runtime::{
    Begin, Completes, Control, Law, Meters, MetersPerSecond, Nanos, Pose, Radians, RadiansPerSecond, Twist,
};

use crate::beside::Beside;
use crate::gains::Gains;
use crate::memory::Memory;
use crate::narrow::Narrow;
use crate::passers::Passers;
use crate::stuck::Progress;
use crate::tangent::{Obstacles, Side, Wish};
use crate::way::Ahead;
use crate::winding::Winding;
use detour::Detour;
use dwell::Dwell;

mod detour;
mod dwell;

/// Distance between the robot and the goal below which the goal is reached.
const ARRIVED: Meters = Meters(0.12);
/// Distance between the body and the goal, in metres, below which the robot is near enough if an obstacle prevents it
/// from coming nearer. Odometry drifts, so a goal near a wall may seem to be inside the wall.
const NEAR: f64 = 0.1;
/// Time for which an obstacle must prevent the robot from coming nearer to the nearby goal before the law is done.
const KEPT_OFF: Nanos = Nanos(1_000_000_000);
/// Maximum turn rate, in rad/s.
const FASTEST: f64 = 0.9;
/// Angle between the heading and the chosen direction from which the robot turns on the spot.
const ON_THE_SPOT: Radians = Radians::from_degrees(50.0);
/// Angle between the chosen direction and the goal's direction above which a detour begins.
const DETOUR: Radians = Radians::from_degrees(60.0);
/// Angle between the robot's heading and the direction at which the robot aims while a detour follows its obstacle.
/// This direction is on the side of the obstacle.
const ALONG: Radians = Radians::from_degrees(40.0);
/// Angle from the goal's direction at which the robot gives way to an approaching person.
const ASIDE: Radians = Radians::from_degrees(60.0);
/// Durations of two phases that alternate while the robot makes no progress. For the duration `SQUEEZES`, it follows
/// ways on its map. Then, for the duration `GOES_ROUND`, it goes round obstacles without the map, because the map is
/// too small to show a way out of a large corner. With 30 s on the map, 269 of 1000 Scouts found the doorway in a thick
/// wall across a room; with 45 s, 378 did. With 60 s, fewer ATRV-minis left U-shaped walls, 962 of 1000 instead of 973.
const SQUEEZES: Nanos = Nanos(45_000_000_000);
const GOES_ROUND: Nanos = Nanos(60_000_000_000);
/// Time without progress after which the robot follows ways on its map.
const HELD_UP: Nanos = Nanos(1_200_000_000);
/// Time without progress after which a rectangle that has driven less than [`BEGINS`] follows ways on its map. Its map
/// does not show all walls around it yet, and a way on the map may lead through a wall beside a doorway.
const HELD_UP_AT_FIRST: Nanos = Nanos(2_000_000_000);
/// Distance driven since the law began, in metres, up to which [`HELD_UP_AT_FIRST`] applies.
const BEGINS: f64 = 0.5;
/// Time without progress after which the law assumes that something prevents the robot from coming nearer, even if the
/// sonars detect no obstacle. From then on, the possible drift of odometry is added to the distance at which the robot
/// is near enough.
const DRIFTS_AFTER: Nanos = Nanos(10_000_000_000);
/// Possible drift of odometry, as a fraction of the distance driven, and its maximum, `DRIFTS_MOST`, in metres. Without
/// a maximum, the law of a robot that drives about in search of a way would eventually be done at any distance from the
/// goal.
const DRIFTS: f64 = 0.02;
const DRIFTS_MOST: f64 = 0.2;

/// The control `goAvoid`, which drives to the point at a bearing and range from the pose at which the atom begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoAvoid {
    bearing: Radians,
    range: Meters,
    speed: MetersPerSecond,
}

impl GoAvoid {
    /// Creates the quark `goAvoid bearing range speed`: the bearing in the frame in which the atom begins, the range
    /// from the robot's position at that time, and the speed at which the robot drives where the way is free.
    #[must_use]
    pub const fn new(bearing: Radians, range: Meters, speed: MetersPerSecond) -> Self {
        Self { bearing, range, speed }
    }
}

/// The law of [`GoAvoid`], which is done when the robot is within 0.12 m of the goal, or its body is within 0.1 m of
/// the goal and something prevents it from coming nearer (docs/src/reference/language.md, 4).
///
/// Wheels that slip in turns make the heading by odometry wrong, and therefore the position of the goal too. A robot
/// that measures the drift of its heading at walls ([`Odometry::drift`]) therefore rotates the goal by each change of
/// the drift, around the position at which the drift changed before. The law assumes that walls run along the axes of
/// the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GoingRound {
    goal: Pose,
    /// `true` if another goal has replaced the first one.
    is_renewed: bool,
    progress: Progress,
    /// Direction of the frame's x axis.
    axis: Radians,
    /// The drift of the heading by which the goal has been rotated so far, and the pose at which the drift last
    /// changed.
    drift: (Radians, Pose),
    speed: MetersPerSecond,
    look_ahead: Meters,
    /// Distance from the goal at which the robot is near enough.
    near: Meters,
    /// Distance driven so far, in metres, and the pose in the last turn.
    driven: (f64, Pose),
    winding: Winding,
    previous: Option<Radians>,
    /// Time at which the robot first faced the direction that the law had chosen, after it had turned to this
    /// direction; `None` before that time.
    headed: Option<Nanos>,
    detour: Option<Detour>,
    /// Time from which something has prevented the robot, already near the goal, from coming nearer; `None` if nothing
    /// prevents it.
    kept_off: Option<Nanos>,
    passers: Passers,
    memory: Memory,
    narrow: Narrow,
    dwell: Dwell,
    /// `true` while the robot may drive away from a wall beside the place where its law began.
    departs: bool,
}

impl GoingRound {
    /// Returns this law with the goal of `other`, a law that has just been created at `here`.
    pub(crate) fn with_goal_of(self, other: &Self, here: Pose) -> Self {
        // If the goal moves away, the progress made towards it still counts.
        let progress = self.progress.moved(Meters(here.distance(&other.goal).0 - here.distance(&self.goal).0));
        Self { goal: other.goal, is_renewed: true, progress, axis: other.axis, drift: other.drift, ..self }
    }

    /// Rotates the goal by the change of the drift, around the position at which the drift last changed.
    fn turn_goal(&mut self, drift: Radians, here: Pose) {
        let (before, at) = self.drift;
        if drift == before {
            return;
        }
        let (sin, cos) = libm::sincos(drift.0 - before.0);
        let (x, y) = (self.goal.x.0 - at.x.0, self.goal.y.0 - at.y.0);
        self.goal.x = Meters(at.x.0 + x * cos - y * sin);
        self.goal.y = Meters(at.y.0 + x * sin + y * cos);
        self.drift = (drift, here);
    }

    /// Returns the direction of the goal.
    fn direction(&self, here: Pose) -> Radians {
        Radians(libm::atan2(self.goal.y.0 - here.y.0, self.goal.x.0 - here.x.0))
    }

    /// Returns `true` if the robot has made no progress towards the goal for so long that its odometry is in doubt.
    fn is_lost(&self, here: Pose, t: Nanos) -> bool {
        self.progress.stalled(here, &self.goal, t) > DRIFTS_AFTER
    }

    /// Returns the distance from the goal at which the robot is near enough if something prevents it from coming
    /// nearer.
    fn near(&self, here: Pose, t: Nanos) -> Meters {
        let drifted = if self.is_lost(here, t) { (DRIFTS * self.driven.0).min(DRIFTS_MOST) } else { 0.0 };
        Meters(self.near.0 + drifted)
    }

    /// Updates `kept_off`, which depends on whether the robot is near the goal and something prevents it from coming
    /// nearer.
    fn notice(&mut self, obstacles: &Obstacles, here: Pose, t: Nanos) {
        let Meters(distance) = here.distance(&self.goal);
        let is_in_the_way = obstacles.free(self.direction(here)).0 < distance - ARRIVED.0 || self.narrow.stands();
        // A rectangle without room to turn moves back and forth beside a way that is free for a disc.
        let is_kept_off = distance <= self.near(here, t).0 && (is_in_the_way || self.is_lost(here, t));
        self.kept_off = self.kept_off.or(Some(t)).filter(|_| is_kept_off);
    }

    /// Returns `true` if the detour has lasted so long that it now follows its obstacle.
    fn goes_along(&self, t: Nanos) -> bool {
        self.detour.is_some_and(|detour| detour.goes_along(t))
    }

    /// Returns the direction in which the robot drives to give way to this side. When the robot has reached the wall on
    /// that side, this is the direction along the wall.
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

    /// Returns the direction in which to drive, in odometry coordinates.
    fn choose(&mut self, obstacles: &Obstacles, here: Pose, t: Nanos) -> Radians {
        let Meters(distance) = here.distance(&self.goal);
        let goal = self.direction(here);
        let look_ahead = Meters(self.look_ahead.0.min(distance).max(ARRIVED.0));
        let is_free = obstacles.free(goal) >= look_ahead;
        let (turned, is_on_map, is_renewed) = (self.winding.turned(), self.narrow.follows(), self.is_renewed);
        self.detour = self.detour.and_then(|mut detour| {
            let is_over = is_free && detour.has_helped(Meters(distance), t, is_renewed);
            (!detour.circles(here, turned, is_on_map) && !is_over).then_some(detour)
        });
        if let Some(side) = self.passers.gives_way() {
            return self.aside(side, goal, obstacles, look_ahead);
        }
        let side = self.detour.map(|detour| detour.side);
        // A detour that follows its obstacle aims towards the obstacle as far as there is room, starting from the
        // robot's heading.
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
            self.detour = Some(Detour::begin(side, &self.goal, here, turned, t));
        }
        let chosen = Radians(towards.0 + offset.0).wrapped();
        self.previous = Some(chosen);
        chosen
    }
}

/// The direction that the tangent rule has chosen, and the free lengths of the ways ahead and to the goal.
struct Chosen {
    direction: Radians,
    /// Free length of the way in the robot's heading.
    ahead: Meters,
    /// Free length of the way to the goal; `None` on a detour.
    to_goal: Option<Meters>,
}

impl GoingRound {
    /// Chooses a direction from the pings of the sonars. While the robot keeps clear of a person who crosses its way,
    /// or of a wall beside its start, returns the input as an error instead.
    ///
    /// The function is not inlined, so that its obstacles are no longer on the stack when [`Self::squeeze`] puts a map
    /// there.
    #[inline(never)]
    fn look<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose, t: Nanos) -> Result<Chosen, Twist> {
        let mut obstacles = Obstacles::seen(y, here);
        self.passers.take(y, &obstacles, here, (self.direction(here), self.speed), t);
        self.notice(&obstacles, here, t);
        if self.passers.stops(t) {
            let v = self.passers.waits(&obstacles, here, self.speed);
            return Err(Twist { v, omega: RadiansPerSecond(0.0) });
        }
        self.departs &= Beside::is_on_arc(self.driven.0, self.winding.turned());
        let departs =
            obstacles.beside.departs(self.speed).filter(|_| self.departs && self.passers.gives_way().is_none());
        if let Some(twist) = departs {
            return Err(twist);
        }
        let direction = if self.goes_along(t) {
            let seen = obstacles.remember(&self.memory, self.narrow.map(), here, t);
            let direction = self.choose(&obstacles, here, t);
            obstacles.forget(seen);
            direction
        } else {
            self.choose(&obstacles, here, t)
        };
        let to_goal = self.detour.is_none().then(|| obstacles.free(self.direction(here)));
        Ok(Chosen { direction, ahead: obstacles.free(here.theta), to_goal })
    }

    /// Returns the input of a robot that has to leave the place where it has stayed; `None` if it does not have to. Its
    /// detour then passes the obstacle on the opposite side, because the present side has led to this place.
    fn leave<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose, t: Nanos, chosen: &Chosen) -> Option<Twist> {
        if self.dwell.take(here, t) {
            let turned = self.winding.turned();
            let begin = |detour: Detour| Detour::begin(detour.side.other(), &self.goal, here, turned, t);
            self.detour = self.detour.map(begin);
            self.narrow.leave();
        }
        if !self.dwell.leaves() || self.passers.gives_way().is_some() {
            return None;
        }
        let (near, from, chosen) = (Meters(0.0), Meters(f64::INFINITY), chosen.direction);
        let (goal, speed, winding) = (self.goal, self.speed, self.winding);
        let ahead = Ahead { goal, near, from, chosen, free: None, speed, winding, before: None, doubts: false };
        self.narrow.input(y, here, t, ahead)
    }

    /// Returns the time without progress after which the robot, a disc or a rectangle, follows ways on its map.
    fn held_up(&self, is_disc: bool) -> Nanos {
        if is_disc || self.driven.0 > BEGINS { HELD_UP } else { HELD_UP_AT_FIRST }
    }

    /// Returns the input in or before a narrow place; `None` elsewhere.
    fn squeeze<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose, t: Nanos, chosen: &Chosen) -> Option<Twist> {
        let off = Radians(chosen.direction.0 - here.theta.0).wrapped().0.abs();
        self.headed = self.headed.or((off < ON_THE_SPOT.0).then_some(t));
        let since = self.headed.map_or(Nanos::ZERO, |headed| t.since(headed));
        let stalled = self.progress.stalled(here, &self.goal, t).min(since);
        if stalled < self.held_up(y.is_disc()) && !self.narrow.follows() {
            // Of the corners of a rectangle, of what sonars that fire in turn heard up to a second ago, and of what
            // lies between two sonars, the tangent rule knows nothing.
            return self.narrow.round(y, here, chosen.direction, self.speed, self.winding);
        }
        // A disc can turn in every place that it can reach. With this rule, fewer Scouts found their way in a maze.
        if !y.is_disc()
            && let Some(leaves) = self.leave(y, here, t, chosen)
        {
            return Some(leaves);
        }
        let goes_round = stalled.0 % (SQUEEZES.0 + GOES_ROUND.0) >= SQUEEZES.0;
        if self.passers.gives_way().is_some() || goes_round {
            self.narrow.leave();
            let keeps_off = goes_round.then(|| self.narrow.round(y, here, chosen.direction, self.speed, self.winding));
            return keeps_off.flatten();
        }
        let distance = here.distance(&self.goal);
        let asked = Meters(self.look_ahead.0.min(distance.0));
        let from = self.detour.map_or(distance, |detour| Meters(detour.from().0.min(distance.0)));
        let free = chosen.to_goal.map(|free| (free, asked));
        let chosen = chosen.direction;
        let near = self.near(here, t);
        let (goal, speed, winding) = (self.goal, self.speed, self.winding);
        let doubts = !self.passers.has_just_met(t);
        let ahead = Ahead { goal, near, from, chosen, free, speed, winding, before: None, doubts };
        self.narrow.input(y, here, t, ahead)
    }
}

impl<Y: DiffDrive + Odometry + SonarRing> Control<Y> for GoAvoid {
    type Law = GoingRound;

    // Not inlined, so that the law is constructed only once, in its final place.
    #[inline(never)]
    fn begin(&self, y: &Y, begin: Begin) -> GoingRound {
        let (here, bearing) = (y.pose(), begin.frame.outward(self.bearing));
        let goal = here.towards(bearing, self.range);
        let axis = begin.frame.outward(Radians(0.0));
        GoingRound {
            goal,
            is_renewed: false,
            progress: Progress::begin(here, &goal, begin.now),
            axis,
            drift: (Radians(0.0), here),
            speed: self.speed,
            look_ahead: Gains::of(y).look_ahead,
            near: Meters(y.body_radius().0 + NEAR),
            driven: (0.0, here),
            winding: Winding::begin(y),
            previous: None,
            headed: None,
            detour: None,
            kept_off: None,
            passers: Passers::default(),
            memory: Memory::EMPTY,
            narrow: Narrow::EMPTY,
            dwell: Dwell::begin(here, begin.now),
            departs: Beside::is_along_walls(Radians(here.theta.0 - axis.0 - y.drift(axis).0)),
        }
    }
}

impl<Y: DiffDrive + Odometry + SonarRing> Law<Y> for GoingRound {
    type Input = Twist;

    fn input(&mut self, y: &Y, t: Nanos) -> Twist {
        let here = y.pose();
        self.winding.take(&self.driven.1, &here);
        self.driven = (self.driven.0 + here.distance(&self.driven.1).0, here);
        self.turn_goal(y.drift(self.axis), here);
        self.progress.take(here, &self.goal, t);
        self.memory.take(y);
        self.narrow.take(y, here);
        let chosen = match self.look(y, here, t) {
            Ok(chosen) => chosen,
            Err(waits) => return waits,
        };
        if let Some(twist) = self.squeeze(y, here, t, &chosen) {
            return twist;
        }
        let off = Radians(chosen.direction.0 - here.theta.0).wrapped();
        // While the robot follows an obstacle, the direction is relative to its heading. Turning the longer way round
        // would lead away from the obstacle.
        let Radians(off) = if self.goes_along(t) { off } else { self.winding.turn_to(off) };
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
mod tests;
