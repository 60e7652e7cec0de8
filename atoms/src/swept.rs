//! Chooses the speed and turn rate that bring a body nearest to a place without touching an obstacle on the map
//! (dynamic window approach). For each pair of a speed and a turn rate, the motion of the body, a disc or a rectangle,
//! is simulated along the arc.

use core::f64::consts::TAU;

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians, RadiansPerSecond, Twist};

use crate::gains::Gains;
use crate::map::Map;
use crate::too_near::TooNear;
use crate::winding::Winding;

/// Maximum number of occupied cells that are considered; these are the nearest ones.
const POINTS: usize = 96;
/// Maximum number of doubtful cells that are considered; these are the nearest ones.
const DOUBTS: usize = 32;
/// Margin around the body's smallest enclosing circle, in metres. Occupied cells farther away are ignored.
const WITHIN: f64 = 0.18;
/// Turn rates to try, in rad/s.
const RATES: [f64; 7] = [0.0, 0.15, -0.15, 0.35, -0.35, 0.7, -0.7];
/// Factors by which the given speed is multiplied to obtain the speeds to try.
const SPEEDS: [f64; 4] = [1.0, 0.5, 0.0, -0.5];
/// Times, in seconds, at which the position of the body is checked.
const TIMES: [f64; 3] = [0.3, 0.6, 1.0];
/// Distance, in metres, by which an obstacle may be further away than the centre of its cell.
const COARSE: f64 = 0.015;
/// Distance, in metres, that a rectangle keeps from the centres of occupied cells in arcs with at least the turn rate
/// `SWINGS_AT`; at lower rates, the distance is in proportion. In an arc, a corner may swing into a wall that is half a
/// cell, 2.5 cm, nearer than the centres of its cells, and the map may show a wall a few centimetres too far away. With
/// 3 cm, 38 of 4000 ATRV-minis touched a jamb of a doorway 15 cm wider than they are; with 4.5 cm, 22 did. A body that
/// drives straight through a doorway, however, needs all its width, and comes no nearer to the jambs.
const SWINGS: f64 = 0.045;
/// Turn rate, in rad/s, from which a rectangle keeps the whole distance `SWINGS`.
const SWINGS_AT: f64 = 0.35;
/// Radius, in metres, of the rounded corners of a rectangle. The depth of an overlap is measured up to this radius.
const ROUNDED: f64 = 0.03;
/// Distance, in metres, from which an obstacle has no cost.
const ROOM: f64 = 0.12;
/// Distance, in metres, below which an obstacle costs five times as much.
const CLOSE: f64 = 0.08;
/// Cost, in metres, of turning on the spot or driving backwards. Such a movement must bring the robot nearer to the
/// place by more than this.
const STANDING_COSTS: f64 = 0.06;
/// Cost, in metres, per radian between the body's heading and the direction of the place.
const OFF_COSTS: f64 = 0.15;
/// Cost, in metres, per radian between the body's heading and the direction of the place, if the body cannot turn on
/// the way to the place.
const OFF_COSTS_STRAIGHT: f64 = 1.0;

/// The place to which a body is to move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Aim {
    /// Distance of the place ahead of the body, in metres; `left` is the distance to the body's left.
    pub(crate) ahead: f64,
    pub(crate) left: f64,
    /// `true` if the body cannot turn on the way to the place, and therefore has to face the place first.
    pub(crate) is_straight: bool,
    /// Angle by which the robot has turned so far. It determines the direction in which the robot turns to face the
    /// place.
    pub(crate) winding: Winding,
}

/// Outline of a body, and the occupied and the doubtful cells around it.
pub(crate) struct Surroundings {
    points: [(f64, f64); POINTS],
    count: usize,
    doubts: [(f64, f64); DOUBTS],
    /// Number of doubtful cells; 0 before [`Surroundings::doubt`].
    doubtful: usize,
    /// Cost, in metres, per metre by which a doubtful cell is nearer than `CLOSE`.
    doubt_costs: f64,
    too_near: TooNear,
    /// Cost, in metres, per metre by which an obstacle of `too_near` is nearer than `CLOSE`.
    too_near_costs: f64,
    /// Half-length of the rectangle that, extended by `radius` on all sides, is the body's outline; 0 for a disc.
    half_length: f64,
    /// Half-width of the rectangle that, extended by `radius` on all sides, is the body's outline; 0 for a disc.
    half_width: f64,
    radius: f64,
}

impl Surroundings {
    /// Returns the surroundings of the body at `here`.
    pub(crate) fn of<Y: DiffDrive + SonarRing>(y: &Y, map: &Map, here: Pose) -> Self {
        let (half_length, half_width) = (y.half_length().0, y.half_width().0);
        let radius = if y.is_disc() { half_length } else { ROUNDED };
        let mut near = Self {
            points: [(0.0, 0.0); POINTS],
            count: 0,
            doubts: [(0.0, 0.0); DOUBTS],
            doubtful: 0,
            doubt_costs: Gains::of(y).doubt_costs,
            too_near: TooNear::of(y, here),
            too_near_costs: Gains::of(y).too_near_costs,
            half_length: half_length - radius,
            half_width: half_width - radius,
            radius,
        };
        let within = y.body_radius().0 + WITHIN;
        near.count = placed(&mut near.points, map.around(here, Meters(within)), here.theta, within);
        near
    }

    /// Makes movements near the doubtful cells around the body of `y` at `here` cost more.
    pub(crate) fn doubt<Y: DiffDrive>(mut self, y: &Y, map: &Map, here: Pose) -> Self {
        if self.doubt_costs > 0.0 {
            let within = y.body_radius().0 + WITHIN;
            let cells = map.doubtful_around(here, Meters(within));
            self.doubtful = placed(&mut self.doubts, cells, here.theta, within);
        }
        self
    }

    /// Returns the distance, in metres, between the body and the nearest occupied cell.
    pub(crate) fn now(&self) -> f64 {
        self.room(self.cells(), (0.0, 0.0, 0.0))
    }

    /// Returns the occupied cells.
    fn cells(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.points.iter().take(self.count)
    }

    /// Returns the distance, in metres, between the body and the nearest of these points if the body were at this pose.
    /// The pose is relative to the body's present pose.
    fn room<'p>(&self, points: impl Iterator<Item = &'p (f64, f64)>, (x, y, theta): (f64, f64, f64)) -> f64 {
        let (sin, cos) = libm::sincos(theta);
        let square = points.fold(f64::INFINITY, |least, (px, py)| {
            let (px, py) = (px - x, py - y);
            let along = ((px * cos + py * sin).abs() - self.half_length).max(0.0);
            let across = ((py * cos - px * sin).abs() - self.half_width).max(0.0);
            least.min(along * along + across * across)
        });
        libm::sqrt(square) - self.radius
    }

    /// Returns the input that brings the body nearest to a place; its speed is at most `speed`; `None` if every
    /// movement would touch something. If `is_bold` is `true`, the body may also drive where there is little room.
    pub(crate) fn towards(&self, aim: &Aim, speed: MetersPerSecond, is_bold: bool) -> Option<Twist> {
        let now = self.now();
        let off = Radians(libm::atan2(aim.left, aim.ahead));
        let back = Some(aim.winding.turn_to(off).0).filter(|turn| *turn != off.0);
        let mut best = (f64::INFINITY, None);
        for part in SPEEDS {
            for omega in RATES {
                let v = speed.0 * part;
                // A disc can turn on the spot, so it need not drive back.
                if v == 0.0 && omega == 0.0 || v < 0.0 && self.half_length == 0.0 {
                    continue;
                }
                let kept = if is_bold { -COARSE } else { self.swings(omega) };
                if let Some(cost) = self.cost(v, omega, now, kept, aim, back)
                    && cost < best.0
                {
                    best = (cost, Some(Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) }));
                }
            }
        }
        best.1
    }

    /// Returns the distance, in metres, that the body keeps from occupied cells in a movement with this turn rate.
    fn swings(&self, omega: f64) -> f64 {
        if self.half_length > 0.0 { SWINGS * (omega.abs() / SWINGS_AT).min(1.0) } else { 0.0 }
    }

    /// Returns the input that moves the body straight back at `speed`; `None` if it would touch something.
    pub(crate) fn back(&self, speed: MetersPerSecond) -> Option<Twist> {
        let twist = Twist { v: MetersPerSecond(-speed.0), omega: RadiansPerSecond(0.0) };
        self.moves(twist.v.0, 0.0, self.now(), 0.0).map(|_| twist)
    }

    /// Returns the pose at the end of a movement, relative to the body's present pose, and the minimum distance, in
    /// metres, between the body and an occupied cell on the way; `None` if the body would come nearer to an obstacle
    /// than `kept` metres and does not move away from it. `now` is the present distance.
    fn moves(&self, v: f64, omega: f64, now: f64, kept: f64) -> Option<((f64, f64, f64), f64)> {
        let (mut least, mut end, mut before) = (f64::INFINITY, (0.0, 0.0, 0.0), now);
        for t in TIMES {
            let theta = omega * t;
            let (x, y) = if omega == 0.0 {
                (v * t, 0.0)
            } else {
                let (sin, cos) = libm::sincos(theta);
                (v / omega * sin, v / omega * (1.0 - cos))
            };
            let room = self.room(self.cells(), (x, y, theta));
            if room < kept && room <= before {
                return None;
            }
            least = least.min(room);
            (end, before) = ((x, y, theta), room);
        }
        Some((end, least))
    }

    /// Returns the cost of a movement, in metres; `None` if the body cannot make it, as in [`Self::moves`]. `back` is
    /// the angle to the place by the longer turn; `None` if the robot may turn the shorter way.
    fn cost(&self, v: f64, omega: f64, now: f64, kept: f64, aim: &Aim, back: Option<f64>) -> Option<f64> {
        let (end, least) = self.moves(v, omega, now, kept)?;
        let (x, y, theta) = end;
        let (dx, dy) = (aim.ahead - x, aim.left - y);
        let Radians(off) = Radians(libm::atan2(dy, dx) - theta).wrapped();
        let off = if back.is_some_and(|back| back * off < 0.0) { TAU - off.abs() } else { off.abs() };
        let stands = if v <= 0.0 { STANDING_COSTS } else { 0.0 };
        let doubts = self.room(self.doubts.iter().take(self.doubtful), end);
        let doubtful = if kept < 0.0 { 0.0 } else { self.doubt_costs } * (CLOSE - doubts).max(0.0);
        let too_near = self.too_near_costs * (CLOSE - self.room(self.too_near.places(), end)).max(0.0);
        let tight = too_near
            + doubtful
            + if kept < 0.0 { 0.0 } else { 1.0 } * (ROOM - least).max(0.0)
            + 4.0 * (CLOSE - least).max(0.0);
        Some(libm::hypot(dx, dy) + if aim.is_straight { OFF_COSTS_STRAIGHT } else { OFF_COSTS } * off + tight + stands)
    }
}

/// Puts the centres of cells, relative to a body with this heading, into `places`, as many as there is room for, except
/// those that are at least `within` metres away. Returns their number.
fn placed(
    places: &mut [(f64, f64)],
    cells: impl Iterator<Item = (f64, f64)>,
    Radians(heading): Radians,
    within: f64,
) -> usize {
    let (sin, cos) = libm::sincos(heading);
    let near = cells.filter(|(x, y)| libm::hypot(*x, *y) < within);
    let pairs = places.iter_mut().zip(near);
    pairs.map(|(place, (x, y))| *place = (x * cos + y * sin, y * cos - x * sin)).count()
}

#[cfg(test)]
mod tests {
    use mdle_runtime::SonarId;

    use super::*;
    use crate::trial::{Sensed, sized};

    const SPEED: MetersPerSecond = MetersPerSecond(0.12);

    fn aim(left: f64) -> Aim {
        Aim { ahead: 0.4, left, is_straight: false, winding: Winding::begin(&Sensed::default()) }
    }

    /// Returns the input that brings this body nearest to a place 0.4 m ahead and `left` metres to the left, beside
    /// walls that run along its way at these distances; `None` if every movement would touch a wall.
    fn towards(y: &Sensed, left: f64, walls: &[f64]) -> Option<Twist> {
        let mut map = Map::EMPTY;
        for wall in walls {
            map.occupy((-0.6, *wall), (0.6, *wall));
        }
        Surroundings::of(y, &map, Pose::ORIGIN).towards(&aim(left), SPEED, false)
    }

    #[test]
    fn straight_on_between_walls_and_to_a_place_aside() {
        let straight = towards(&Sensed::default(), 0.0, &[0.3, -0.3]);
        assert_eq!(straight, Some(Twist { v: SPEED, omega: RadiansPerSecond(0.0) }));
        let aside = towards(&Sensed::default(), 0.4, &[]).expect("nothing near");
        assert!(aside.omega.0 > 0.0, "{aside:?}");
    }

    /// The end of a wall is ahead to the left, but a ping that met the wall at a slant has passed it.
    #[test]
    fn a_scout_approaches_the_doubtful_end_of_a_wall_slowly() {
        let mut map = Map::EMPTY;
        map.occupy((0.22, 0.17), (0.22, 0.6));
        map.doubt();
        assert_eq!(map.around(Pose::ORIGIN, Meters(0.7)).count(), 0, "nothing is occupied");
        let towards = |y: &Sensed, is_bold| {
            let near = Surroundings::of(y, &map, Pose::ORIGIN).doubt(y, &map, Pose::ORIGIN);
            near.towards(&aim(0.0), SPEED, is_bold).map(|twist| twist.v)
        };
        let scout = Sensed { confirmation: 2, ..Sensed::default() };
        let slow = MetersPerSecond(SPEED.0 / 2.0);
        assert!(towards(&scout, false).is_some_and(|v| v <= slow));
        let (bold, another) = (towards(&scout, true), towards(&Sensed::default(), false));
        assert_eq!([bold, another], [Some(SPEED); 2], "bold, and another body");
    }

    #[test]
    fn a_disc_turns_where_a_rectangle_would_touch() {
        let turns = |y: &Sensed| towards(y, 3.0, &[0.32, -0.32]).map(|twist| twist.omega.0);
        assert_eq!(turns(&sized(0.27, 0.27)), Some(0.7));
        assert!(turns(&sized(0.315, 0.27)).is_none_or(|omega| omega < 0.7));
    }

    /// In an arc to the left, the rear right corner of the widest body comes within 2 cm of the centres of the cells,
    /// that of the next one within 4 cm, and that of the narrowest one within 6 cm.
    #[test]
    fn a_corner_does_not_swing_into_a_wall_that_is_nearer_than_its_cells() {
        let mut map = Map::EMPTY;
        map.occupy((-0.6, -0.36), (0.6, -0.36));
        let beside = |half_width: f64| Surroundings::of(&sized(0.315, half_width), &map, Pose::ORIGIN);
        let free = |near: &Surroundings, omega: f64, kept: f64| {
            near.cost(SPEED.0, omega, near.now(), kept, &aim(0.4), None).is_some()
        };
        let is_free = |half_width: f64| free(&beside(half_width), 0.35, beside(half_width).swings(0.35));
        assert_eq!([0.29, 0.27, 0.25].map(is_free), [false, false, true]);
        let near = beside(0.29);
        assert!(free(&near, 0.35, 0.0), "the map alone would allow it");
        assert!(free(&near, 0.15, near.swings(0.15)), "a slower turn is free");
        let disc = Surroundings::of(&Sensed::default(), &map, Pose::ORIGIN);
        assert_eq!((near.swings(0.0), disc.swings(0.7)), (0.0, 0.0), "a doorway is passed straight");
    }

    #[test]
    fn the_nearest_cells_count_where_there_are_many() {
        let mut map = Map::EMPTY;
        for step in 0..4 {
            let x = -0.42 - 0.05 * f64::from(step);
            map.occupy((x, -0.45), (x, 0.45));
        }
        for y in [0.52, 0.47, -0.47, -0.52] {
            map.occupy((-0.35, y), (0.35, y));
        }
        let forward = |map: &Map| {
            let twist = Surroundings::of(&sized(0.315, 0.27), map, Pose::ORIGIN).towards(&aim(0.0), SPEED, false);
            twist.is_some_and(|twist| twist.v.0 > 0.0)
        };
        assert!(forward(&map));
        map.occupy((0.34, -0.2), (0.34, 0.2));
        assert!(!forward(&map), "many cells are further off than the wall ahead");
    }

    #[test]
    fn a_rectangle_that_has_turned_far_turns_back() {
        let y = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        let turns = |quarters: i32| {
            let mut winding = Winding::begin(&y);
            let heading = |quarter: i32| Pose { theta: Radians::from_degrees(f64::from(90 * quarter)), ..Pose::ORIGIN };
            (0..quarters).for_each(|quarter| winding.take(&heading(quarter), &heading(quarter + 1)));
            let behind = Aim { ahead: -0.4, left: 0.2, is_straight: false, winding };
            let twist = Surroundings::of(&y, &Map::EMPTY, Pose::ORIGIN).towards(&behind, SPEED, false);
            twist.map(|twist| twist.omega.0)
        };
        assert_eq!((turns(1), turns(3)), (Some(0.7), Some(-0.7)));
    }

    /// An echo at the minimum range comes from 45° to the left, where the map has no obstacle.
    #[test]
    fn an_obstacle_too_near_to_be_measured_is_approached_slowly() {
        let twist = |range: Option<f64>| {
            let mut scout = Sensed { confirmation: 2, ..Sensed::default() };
            scout.ping_at(SonarId::new(2), range, scout.now);
            towards(&scout, 0.0, &[])
        };
        assert_eq!(twist(Some(0.2)), Some(Twist { v: SPEED, omega: RadiansPerSecond(0.0) }));
        assert!(twist(Some(0.15)).is_some_and(|twist| twist.v.0 <= SPEED.0 / 2.0));
    }

    /// With the costs of a Scout, it would turn while driving ahead, past an obstacle at 45° to the right.
    #[test]
    fn a_rectangle_turns_backwards_beside_an_obstacle_too_near_to_be_measured() {
        let mut atrv = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        atrv.ping_at(SonarId::new(14), Some(0.11), atrv.now);
        let aim = Aim { ahead: 0.1, ..aim(0.3) };
        let twist = Surroundings::of(&atrv, &Map::EMPTY, Pose::ORIGIN).towards(&aim, SPEED, false);
        assert!(twist.is_some_and(|twist| twist.v.0 < 0.0 && twist.omega.0 > 0.0), "{twist:?}");
    }

    #[test]
    fn the_front_of_a_rectangle_touches_before_that_of_a_disc() {
        let ahead = |y: &Sensed| {
            let mut map = Map::EMPTY;
            map.occupy((0.34, -0.1), (0.34, 0.1));
            let twist = Surroundings::of(y, &map, Pose::ORIGIN).towards(&aim(0.0), SPEED, false);
            twist.is_some_and(|twist| twist.v.0 > 0.0 && twist.omega.0 == 0.0)
        };
        assert!(!ahead(&sized(0.33, 0.27)));
        assert!(ahead(&Sensed::default()));
    }
}
