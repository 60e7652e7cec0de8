//! The tangent rule of `goAvoid`. It chooses, among 72 directions, the one that leads best to the goal past the
//! obstacles that the sonars detect. In the paper (section IV-A), the robot drives "to the edge of the obstacle nearest
//! the desired path".

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Nanos, PINGS_KEPT, Ping, Pose, Radians, SONARS, SonarId};

use crate::beside::Beside;
use crate::gains::{Gains, fire_in_turn};
use crate::map::{Cell, Map};
use crate::memory::{Memory, PLACES};

/// Number of directions that are tried around the robot, 5° apart.
const DIRECTIONS: i32 = 72;
/// Range, in metres, beyond which pings are ignored.
const SEEN_WITHIN: f64 = 2.0;
/// Angles, from the axis of a ping, of the points that represent the arc on which its echo lies.
const ARC: [Radians; 3] = [Radians::from_degrees(-8.0), Radians(0.0), Radians::from_degrees(8.0)];
/// Distances, in metres, by which a wall is assumed to continue beyond its last echo.
const EXTENDS: [f64; 3] = [0.25, 0.5, 0.75];
/// Minimum distance, in metres, between the oldest and the newest echo of a wall; echoes of an edge are closer
/// together.
const APART: f64 = 0.15;
/// Cosine of 60°, the minimum angle between a wall and the axis of a sonar that receives its echo.
const ACROSS: f64 = 0.5;
/// Maximum number of points: those of the present echoes, of the assumed continuations of walls, and of earlier echoes.
const POINTS: usize = SONARS * (ARC.len() + EXTENDS.len()) + PLACES;
/// Distance between the body and an obstacle, in metres, at which a way has the cost `CLOSE_COSTS`. At a smaller
/// distance, the cost is higher.
const MARGIN: f64 = 0.06;
/// Distance, in metres, that is assumed between the body and an obstacle that may be nearer than its range. With this
/// distance, the robot steers away from the obstacle, but the obstacle does not block a gap.
const AT_LEAST_RANGE: f64 = 0.08;
/// Cost of a way that is not free over the whole look-ahead, in radians of detour. The cost is in proportion to the
/// missing part of the look-ahead.
const BLOCKED_COSTS: f64 = 6.0;
/// Cost of a way at the distance `MARGIN` from obstacles, in radians of detour. With a cost of 0.6, the robot might
/// leave the middle of a hallway so far that, at the next junction, `atIsection` would detect half-way through a turn
/// the pattern that should end the turn.
const CLOSE_COSTS: f64 = 0.9;
/// Cost of a change of the direction from one turn to the next, in radians of detour for each radian of change.
const CHANGE_COSTS: f64 = 0.15;
/// Cost of a change of the direction during a detour, in radians of detour for each radian of change.
const CHANGE_COSTS_ON_A_DETOUR: f64 = 0.6;
/// Maximum angle between a direction on a detour and the goal's direction; with a larger angle, the robot would drive
/// in circles.
const TURNED_MOST: Radians = Radians::from_degrees(215.0);
/// Difference below which costs are treated as equal, since it may come from the order of additions.
const ROUNDING: f64 = 1e-9;
/// Maximum length of a free way, in metres; a longer free way is no better.
const FREE_MOST: f64 = 3.0;
/// Distance along a way, in metres, at which the room beside it is measured if the way is free for at least `LONG`.
/// Beside a wall, only the room further ahead distinguishes a way that leads away from the wall from a way that stays
/// close to it: if the room were measured beside the robot, the robot would not return to the middle of a hallway.
const ROOM_AT: f64 = 0.6;
/// Free length of a way, in metres, from which no gap that the body can just pass is immediately ahead.
const LONG: f64 = 1.0;
/// Minimum and maximum distance along the way, in metres, of the points that are treated as beside the way; behind the
/// robot, the distance is negative.
const BESIDE: (f64, f64) = (-0.05, 0.9);

/// Position of an echo relative to the centre of the body, along the axes of the odometry coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    x: f64,
    y: f64,
}

/// The positions of the sonars' last echoes around the robot, and the width that its way must have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Obstacles {
    points: [Point; POINTS],
    /// The number of points in use, from the first one on.
    count: usize,
    hard: f64,
    close: f64,
    soft: f64,
    /// Distance by which the body reaches further ahead than to its sides, in metres.
    nose: f64,
    /// The echoes beside the body.
    pub(crate) beside: Beside,
    gains: &'static Gains,
}

/// The direction in which a law wants to drive, and the conditions for the choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wish {
    /// Direction of the goal.
    pub(crate) goal: Radians,
    /// Length of the way ahead that should be free.
    pub(crate) look_ahead: Meters,
    /// Direction chosen in the previous turn; `None` if there is none.
    pub(crate) previous: Option<Radians>,
    /// Side on which the robot passes the obstacle during a detour; `None` if it is free to choose.
    pub(crate) side: Option<Side>,
    /// `true` if the law follows an obstacle instead of driving to the goal.
    pub(crate) along: bool,
    /// `true` if being close to walls has no cost.
    pub(crate) close: bool,
}

impl Wish {
    /// Returns the cost of changing the direction since the previous turn. This cost prevents the robot from
    /// alternating between two equally good directions.
    fn turns(&self, offset: f64) -> f64 {
        let costs = if self.along { CHANGE_COSTS_ON_A_DETOUR } else { CHANGE_COSTS };
        let change = |previous: Radians| Radians(self.goal.0 + offset - previous.0).wrapped().0.abs();
        self.previous.map_or(0.0, |previous| costs * change(previous))
    }
}

/// A side on which the robot passes an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    /// Counter-clockwise from the goal's direction.
    Left,
    /// Clockwise from the goal's direction.
    Right,
}

impl Side {
    /// Returns the opposite side.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Converts an angle from the goal's direction to the equal angle that is measured towards this side: from 0 to 2π
    /// for the left, and from -2π to 0 for the right.
    fn counted(self, offset: f64) -> f64 {
        match self {
            Self::Left if offset < 0.0 => offset + core::f64::consts::TAU,
            Self::Right if offset > 0.0 => offset - core::f64::consts::TAU,
            Self::Left | Self::Right => offset,
        }
    }
}

impl Obstacles {
    /// Returns the obstacles whose echoes the sonars of `y` have received, around the body at `here`.
    #[inline(never)]
    pub(crate) fn seen<Y: DiffDrive + SonarRing>(y: &Y, here: Pose) -> Self {
        let (half_length, half_width) = (y.half_length().0, y.half_width().0);
        let gains = Gains::of(y);
        let Gains { hard_margin, least_range, saturates, soft_margin, .. } = *gains;
        let half_width = (half_width + y.body_radius().0) / 2.0;
        let (hard, close, soft) = (half_width + hard_margin, half_width + MARGIN, half_width + soft_margin);
        let ring = y.ring_radius();
        let nose = half_length - half_width;
        let (points, beside) = ([Point { x: 0.0, y: 0.0 }; POINTS], Beside::default());
        let mut seen = Self { points, count: 0, hard, close, soft, nose, beside, gains };
        for sonar in (0..SONARS as u8).map(SonarId::new) {
            if let Some((ping, range)) = heard(y, sonar) {
                seen.beside.take(sonar, range, saturates);
                let may_be_nearer = range.0 < least_range;
                let range = if may_be_nearer { Meters(half_width + AT_LEAST_RANGE - ring.0) } else { range };
                on_arc(&ping, range, sonar, ring, here, ARC).into_iter().for_each(|point| seen.push(point));
            }
        }
        if fire_in_turn(y) {
            for sonar in (0..SONARS as u8).map(SonarId::new) {
                extended(y, sonar, here).into_iter().flatten().for_each(|point| seen.push(point));
            }
        }
        seen
    }

    fn push(&mut self, point: Point) {
        if let Some(place) = self.points.get_mut(self.count) {
            *place = point;
            self.count += 1;
        }
    }

    /// Adds the positions that `memory` stores. For a wide body, adds only positions near which `map` has an occupied
    /// cell. Returns the number of points before the first of these positions.
    pub(crate) fn remember(&mut self, memory: &Memory, map: &Map, here: Pose, now: Nanos) -> usize {
        let (seen, is_all) = (self.count, !self.gains.confirms_memory);
        let counts = |(x, y): &(f64, f64)| is_all || map.is_occupied_near(Cell::of(here.x.0 + x, here.y.0 + y));
        memory.around(here, now).filter(counts).for_each(|(x, y)| self.push(Point { x, y }));
        seen
    }

    /// Removes all points except the first `seen`.
    pub(crate) fn forget(&mut self, seen: usize) {
        self.count = self.count.min(seen);
    }

    /// Returns the distance, in metres and at most 3, that the body, extended by its margin, can drive in this
    /// direction before it reaches a point; negative if a point is already inside the margin.
    pub(crate) fn free(&self, direction: Radians) -> Meters {
        self.free_along(Axis::of(direction))
    }

    fn free_along(&self, axis: Axis) -> Meters {
        let mut free = FREE_MOST;
        for (along, across) in self.along(axis) {
            // A quick check skips points whose whole margin lies further away.
            if along > 0.0 && across.abs() < self.hard && along - self.nose - self.hard < free {
                free = free.min(along - self.nose - libm::sqrt(self.hard * self.hard - across * across));
            }
        }
        Meters(free)
    }

    /// Returns the distance, in metres, from the place `room_at` metres along the way in this direction, or from the
    /// end of the way, to the nearest point beside the way; infinite if there is no such point.
    ///
    /// A point at which the way ends, after its `free` length, is not treated as beside it, except for a wide body.
    fn beside(&self, axis: Axis, free: Meters, room_at: f64) -> f64 {
        let (back, ahead) = (BESIDE.0, BESIDE.1.min(free.0 + self.gains.beyond));
        let place = room_at.min(free.0).max(0.0);
        let mut least = f64::INFINITY;
        for (along, across) in self.along(axis) {
            // A quick check skips most points, which lie further away along one axis alone.
            if back < along && along < ahead && (along - place).abs() < least && across.abs() < least {
                least = least.min(libm::hypot(along - place, across));
            }
        }
        least
    }

    /// Returns the direction with the lowest cost, as an angle from the goal's direction, measured towards the side of
    /// the current detour.
    pub(crate) fn best(&self, wish: &Wish) -> Radians {
        let mut best = (f64::INFINITY, 0, 0.0);
        for number in 0..DIRECTIONS {
            // From the goal's direction outwards, so that most other directions are skipped before any point is
            // examined.
            let step = if number % 2 == 0 { number / 2 } else { -(number + 1) / 2 };
            let offset = Radians::from_degrees(f64::from(step) * (360.0 / f64::from(DIRECTIONS))).0;
            let counted = wish.side.map_or(offset, |side| side.counted(offset));
            let turns = wish.turns(counted);
            if wish.along && counted.abs() > TURNED_MOST.0 || counted.abs() + turns > best.0 + ROUNDING {
                continue;
            }
            let Some(cost) = self.cost(counted, turns, wish, best.0) else { continue };
            // Of two equally good directions, the one further clockwise.
            if cost < best.0 || cost == best.0 && step < best.1 {
                best = (cost, step, counted);
            }
        }
        Radians(best.2)
    }

    /// Returns the cost of a direction, including `turns`, the cost of the change since the previous turn; `None` if
    /// the cost exceeds `best`.
    fn cost(&self, offset: f64, turns: f64, wish: &Wish, best: f64) -> Option<f64> {
        let axis = Axis::of(Radians(wish.goal.0 + offset));
        let mut cost = offset.abs();
        let Meters(look_ahead) = wish.look_ahead;
        let free = self.free_along(axis);
        if free.0 < look_ahead {
            cost += BLOCKED_COSTS * (look_ahead - free.0) / look_ahead;
        }
        if cost + turns > best + ROUNDING {
            return None;
        }
        let room_at = if free.0 >= LONG { ROOM_AT } else { self.gains.room_at };
        let beside = self.beside(axis, free, room_at);
        let soft = if wish.close { 0.0 } else { self.soft };
        if beside < soft {
            cost += CLOSE_COSTS * (soft - beside) / (soft - self.close);
        }
        Some(cost + turns)
    }

    /// Returns every point as its distance along an axis and its distance to the left of the axis.
    fn along(&self, Axis { sin, cos }: Axis) -> impl Iterator<Item = (f64, f64)> {
        let points = self.points.get(..self.count).unwrap_or(&self.points);
        points.iter().map(move |point| (point.x * cos + point.y * sin, point.y * cos - point.x * sin))
    }
}

/// The sine and the cosine of a direction.
#[derive(Debug, Clone, Copy)]
struct Axis {
    sin: f64,
    cos: f64,
}

impl Axis {
    fn of(direction: Radians) -> Self {
        let (sin, cos) = libm::sincos(direction.0);
        Self { sin, cos }
    }
}

/// Returns points on the assumed continuation of a wall that all pings of the sonar show; `None` if the pings do not
/// show a wall. The continuation itself returns no echo, because it does not face the sonars.
fn extended<Y: DiffDrive + SonarRing>(y: &Y, sonar: SonarId, here: Pose) -> Option<[Point; EXTENDS.len()]> {
    let mut echoes = y.pings(sonar).newest_first().map(|ping| {
        let range = ping.range.filter(|range| range.0 < SEEN_WITHIN)?;
        Some((ping, range))
    });
    let (new, _, old) = (echoes.next()??, echoes.next()??, echoes.next()??);
    let [[new], [old]] =
        [new, old].map(|(ping, range)| on_arc(ping, range, sonar, y.ring_radius(), here, [Radians(0.0)]));
    let (along, up) = (new.x - old.x, new.y - old.y);
    let length = libm::hypot(along, up);
    if length < APART {
        return None;
    }
    let (sin, cos) = libm::sincos(here.theta.0 + sonar.bearing().0);
    if (along * cos + up * sin).abs() > ACROSS * length {
        return None;
    }
    Some(EXTENDS.map(|further| Point { x: new.x + further * along / length, y: new.y + further * up / length }))
}

/// Returns the newest ping of a sonar, or the previous ping if the newest had no echo, together with its range. Returns
/// `None` if neither had an echo, or if the echo is further away than `SEEN_WITHIN`.
fn heard<Y: SonarRing>(y: &Y, sonar: SonarId) -> Option<(Ping, Meters)> {
    const { assert!(PINGS_KEPT >= 2) };
    let (ping, range) = y.pings(sonar).newest_first().take(2).find_map(|ping| Some((*ping, ping.range?)))?;
    (range.0 < SEEN_WITHIN).then_some((ping, range))
}

/// Returns points of the arc on which a ping's echo lies, at these angles from its axis, relative to `here`. The centre
/// of the arc is the position of the transducer at the time of the ping.
fn on_arc<const N: usize>(
    ping: &Ping,
    range: Meters,
    sonar: SonarId,
    ring: Meters,
    here: Pose,
    off_axis: [Radians; N],
) -> [Point; N] {
    let from = ping.axis(sonar);
    let (sin, cos) = libm::sincos(from.theta.0);
    let (x, y) = (from.x.0 + ring.0 * cos, from.y.0 + ring.0 * sin);
    off_axis.map(|Radians(off_axis)| {
        let (sin, cos) = if off_axis == 0.0 { (sin, cos) } else { libm::sincos(from.theta.0 + off_axis) };
        Point { x: x + range.0 * cos - here.x.0, y: y + range.0 * sin - here.y.0 }
    })
}

#[cfg(test)]
mod tests;
