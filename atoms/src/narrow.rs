//! Moves `goAvoid` through narrow places: the robot follows the shortest way on a map of echoes, and makes only
//! movements in which its body, a disc or a rectangle, touches nothing on the map.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, MetersPerSecond, Nanos, Pose, Radians, Twist};

use crate::gains::Gains;
use crate::map::Map;
use crate::swept::{Aim, Surroundings};
use crate::way::{Ahead, Next, way};
use crate::winding::Winding;

/// Distance by which the free way ahead must exceed the look-ahead before the robot leaves the way on the map.
const LEAVES: Meters = Meters(0.4);
/// Length of the way to the goal, in metres, that must be free on the map before the robot leaves the way on the map.
const CLEAR: f64 = 0.6;
/// Distance, in metres, between the side of the body and the centre of an occupied cell at which the cell is beside the
/// way to the goal. The cell is 5 cm wide, and the obstacle may be anywhere in it.
const BESIDE: f64 = 0.04;
/// Time between two searches for a way.
const SEARCHES: Nanos = Nanos(500_000_000);
/// Time for which the last way remains valid if the searches find no way, because single pings can close and reopen
/// gaps on the map.
const COUNTS: Nanos = Nanos(2_000_000_000);
/// Maximum speed, in m/s.
const FASTEST: f64 = 0.12;
/// Distance, in metres, to the place to which a rectangular body drives if there is no way on the map.
const AHEAD: Meters = Meters(0.4);
/// Maximum time for which the robot only turns on the spot. After this time, it drives with less room, because the
/// cells of the map are coarse.
const STANDS: Nanos = Nanos(4_000_000_000);
/// Time after which a rectangular body that only turns on the spot backs off, and for how long it does. No sonar faces
/// the strip before the middle of such a body. If an echo from elsewhere has marked a cell of this strip as occupied,
/// no ping marks the cell as free before the robot has backed off.
const BACKS_AFTER: Nanos = Nanos(8_000_000_000);
const BACKS: Nanos = Nanos(4_000_000_000);

/// The map, and the way on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Narrow {
    map: Map,
    /// Next place on the way; `None` if the robot follows no way.
    way: Option<Next>,
    /// Time of the last search.
    searched: Nanos,
    /// Time of the last search that replaced the way.
    found: Nanos,
    /// Time since which the robot has not driven but only turned on the spot; `None` while it drives.
    stands: Option<Nanos>,
    /// Time until which the robot backs off; `None` if it does not.
    backs: Option<Nanos>,
}

/// Conditions under which a movement is chosen.
struct Care {
    /// `true` if the body may also drive where there is little room.
    is_bold: bool,
    /// `true` if the body keeps away from doubtful cells.
    doubts: bool,
}

impl Care {
    /// Care of a robot that follows no way on its map.
    const ROUND: Self = Self { is_bold: false, doubts: false };
}

impl Narrow {
    pub(crate) const EMPTY: Self =
        Self { map: Map::EMPTY, way: None, searched: Nanos::ZERO, found: Nanos::ZERO, stands: None, backs: None };

    /// Updates the map with the pings since the last turn; the robot is at `here`.
    pub(crate) fn take<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose) {
        self.map.take(y, here);
    }

    /// Returns the map of the obstacles around the robot.
    pub(crate) fn map(&self) -> &Map {
        &self.map
    }

    /// Returns `true` if the robot does not drive but only turns on the spot.
    pub(crate) fn stands(&self) -> bool {
        self.stands.is_some()
    }

    /// Returns `true` if the robot follows a way on the map.
    pub(crate) fn follows(&self) -> bool {
        self.way.is_some()
    }

    /// Forgets the way on the map, and the time since which the robot has only turned on the spot.
    pub(crate) fn leave(&mut self) {
        (self.way, self.stands) = (None, None);
    }

    /// Returns the input that keeps the robot away from obstacles whose echoes it no longer receives, while it drives
    /// around them in the direction `chosen`; `None` if there is enough room.
    pub(crate) fn round<Y: DiffDrive + SonarRing>(
        &self,
        y: &Y,
        here: Pose,
        chosen: Radians,
        speed: MetersPerSecond,
        winding: Winding,
    ) -> Option<Twist> {
        if self.has_room(y, here) {
            return None;
        }
        let there = here.towards(chosen, AHEAD);
        let next = Next { x: there.x.0, y: there.y.0, is_straight: false };
        self.towards(y, here, next, (speed, winding), Care::ROUND)
    }

    /// Returns the input of a robot at `here`; `None` if the tangent rule chooses the input.
    pub(crate) fn input<Y: DiffDrive + SonarRing>(
        &mut self,
        y: &Y,
        here: Pose,
        t: Nanos,
        mut ahead: Ahead,
    ) -> Option<Twist> {
        if let Some(back) = self.back(y, here, t) {
            return Some(back);
        }
        let more = if self.way.is_some() { LEAVES } else { Meters(0.0) };
        let is_free = ahead.free.is_some_and(|(free, asked)| free.0 >= asked.0 + more.0);
        if is_free && self.has_room(y, here) && (self.way.is_none() || self.is_clear(y, here, &ahead.goal)) {
            self.leave();
            return None;
        }
        if t.since(self.searched) >= SEARCHES {
            self.searched = t;
            ahead.before = self.way;
            let way = way(&self.map, here, &ahead, y);
            if way.is_some() || t.since(self.found) >= COUNTS {
                (self.way, self.found) = (way, t);
            }
        }
        let there = here.towards(ahead.chosen, AHEAD);
        let anyhow = Next { x: there.x.0, y: there.y.0, is_straight: false };
        let next = self.way.or((!y.is_disc()).then_some(anyhow))?;
        let is_bold = self.stands.is_some_and(|since| t.since(since) > STANDS);
        let care = Care { is_bold, doubts: ahead.doubts };
        let twist = self.towards(y, here, next, (ahead.speed, ahead.winding), care)?;
        self.stands = self.stands.or(Some(t)).filter(|_| twist.v.0 == 0.0);
        Some(twist)
    }

    /// Returns the input of a rectangular body that backs off; `None` if it does not, or cannot.
    fn back<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose, t: Nanos) -> Option<Twist> {
        if !y.is_disc() && self.stands.is_some_and(|since| t.since(since) > BACKS_AFTER) {
            (self.stands, self.backs) = (None, Some(Nanos(t.0.saturating_add(BACKS.0))));
        }
        self.backs = self.backs.filter(|until| t < *until);
        self.backs?;
        let back = self.straight_back(y, here);
        self.backs = self.backs.filter(|_| back.is_some());
        back
    }

    /// Returns the input that moves the body straight back; `None` if it would touch something.
    #[inline(never)]
    fn straight_back<Y: DiffDrive + SonarRing>(&self, y: &Y, here: Pose) -> Option<Twist> {
        Surroundings::of(y, &self.map, here).back(MetersPerSecond(FASTEST))
    }

    /// Returns the input that brings the body nearest to a place; `None` if every movement would touch something.
    ///
    /// The function is not inlined, like [`Self::has_room`], so that its surroundings are not on the stack at the same
    /// time as the map of [`way`].
    #[inline(never)]
    fn towards<Y: DiffDrive + SonarRing>(
        &self,
        y: &Y,
        here: Pose,
        next: Next,
        (speed, winding): (MetersPerSecond, Winding),
        Care { is_bold, doubts }: Care,
    ) -> Option<Twist> {
        let (sin, cos) = libm::sincos(here.theta.0);
        let (dx, dy) = (next.x - here.x.0, next.y - here.y.0);
        let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let speed = MetersPerSecond(speed.0.min(FASTEST));
        let aim = Aim { ahead, left, is_straight: next.is_straight, winding };
        let near = Surroundings::of(y, &self.map, here);
        let near = if doubts { near.doubt(y, &self.map, here) } else { near };
        near.towards(&aim, speed, is_bold)
    }

    /// Returns `true` if the body can drive straight towards the goal on the map. Before a doorway, the map has jambs
    /// that the sonars no longer detect, and that the tangent rule would therefore touch.
    fn is_clear<Y: DiffDrive>(&self, y: &Y, here: Pose, goal: &Pose) -> bool {
        let (length, half) = (here.distance(goal).0.min(CLEAR), y.half_width().0 + BESIDE);
        let (sin, cos) = libm::sincos(libm::atan2(goal.y.0 - here.y.0, goal.x.0 - here.x.0));
        self.map.around(here, Meters(length + half)).all(|(x, y)| {
            let (along, across) = (x * cos + y * sin, y * cos - x * sin);
            along < 0.0 || along > length || across.abs() > half
        })
    }

    /// Returns `true` if nothing on the map is near the body.
    #[inline(never)]
    fn has_room<Y: DiffDrive + SonarRing>(&self, y: &Y, here: Pose) -> bool {
        Surroundings::of(y, &self.map, here).now() > Gains::of(y).room
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, sized};

    /// Returns data for a robot whose tangent rule has chosen the direction ahead, and whose goal is 5 m ahead.
    fn ahead(y: &Sensed, free: Option<(Meters, Meters)>) -> Ahead {
        let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
        let (near, from, speed) = (Meters(0.0), Meters(5.0), MetersPerSecond(0.2));
        Ahead {
            goal,
            near,
            from,
            chosen: Radians(0.0),
            free,
            speed,
            winding: Winding::begin(y),
            before: None,
            doubts: true,
        }
    }

    /// Returns `true` if a robot that follows a way leaves it, with a jamb 0.3 m ahead of its centre and `left` metres
    /// to the left. The sonars do not detect the jamb.
    fn leaves(left: f64, follows: bool) -> bool {
        let y = Sensed::default();
        let next = Next { x: 0.4, y: -0.1, is_straight: false };
        let mut narrow = Narrow { way: follows.then_some(next), ..Narrow::EMPTY };
        narrow.map.occupy((0.3, left), (0.3, left + 0.5));
        let ahead = ahead(&y, Some((Meters(3.0), Meters(0.5))));
        narrow.input(&y, Pose::ORIGIN, Nanos(1), ahead).is_none()
    }

    #[test]
    fn doubtful_cells_beside_a_way_are_approached_slowly() {
        let y = Sensed { confirmation: 2, ..Sensed::default() };
        let next = Next { x: 0.4, y: 0.0, is_straight: false };
        let mut narrow = Narrow { way: Some(next), ..Narrow::EMPTY };
        narrow.map.occupy((0.22, 0.17), (0.22, 0.6));
        narrow.map.doubt();
        let speed = |doubts| {
            let mut on_way = narrow;
            let twist = on_way.input(&y, Pose::ORIGIN, Nanos(1), Ahead { doubts, ..ahead(&y, None) });
            twist.map(|twist| twist.v.0)
        };
        assert_eq!([true, false].map(speed), [Some(FASTEST / 2.0), Some(FASTEST)]);
    }

    #[test]
    fn a_way_is_kept_past_a_jamb_that_is_not_heard() {
        assert!(!leaves(0.2, true));
        assert!(leaves(0.35, true), "the body passes the jamb");
        assert!(leaves(0.2, false), "a robot on no way is led by its sonars");
    }

    /// Returns `true` if a robot with these sonars keeps away from a wall ahead, to its left, which they do not detect.
    /// There is this much room between its body and the wall.
    fn keeps_off(confirmation: usize, room: f64) -> bool {
        let y = Sensed { confirmation, ..Sensed::default() };
        let mut narrow = Narrow::EMPTY;
        let left = y.half_width().0 + room;
        narrow.map.occupy((0.0, left), (0.5, left));
        let speed = MetersPerSecond(0.4);
        narrow.round(&y, Pose::ORIGIN, Radians(0.0), speed, Winding::begin(&y)).is_some()
    }

    #[test]
    fn a_robot_keeps_off_walls_on_the_map_that_it_does_not_hear() {
        assert_eq!([0.02, 0.07, 0.13].map(|room| keeps_off(2, room)), [true, true, false], "sonars fire in turn");
        assert_eq!([0.02, 0.07, 0.13].map(|room| keeps_off(3, room)), [true, false, false], "all ping in every turn");
    }

    /// Returns the seconds, of the first fifteen, in which a body with this map backs off, as bits. It has only turned
    /// on the spot since time 0.
    fn backs(y: &Sensed, map: Map) -> u64 {
        let mut narrow = Narrow { map, stands: Some(Nanos::ZERO), ..Narrow::EMPTY };
        let mut backs = |second: &u64| narrow.back(y, Pose::ORIGIN, Nanos(second * 1_000_000_000)).is_some();
        (0..15).filter(&mut backs).map(|second| 1 << second).sum()
    }

    #[test]
    fn a_rectangle_that_only_turns_backs_off() {
        let atrv = sized(0.315, 0.27);
        assert_eq!(backs(&atrv, Map::EMPTY), 0b1_1110_0000_0000);
        assert_eq!(backs(&Sensed::default(), Map::EMPTY), 0, "a disc");
        let mut behind = Map::EMPTY;
        behind.occupy((-0.38, -0.3), (-0.38, 0.3));
        assert_eq!(backs(&atrv, behind), 0, "an obstacle behind it");
        let mut narrow = Narrow { map: behind, stands: Some(Nanos::ZERO), ..Narrow::EMPTY };
        assert_eq!(narrow.back(&atrv, Pose::ORIGIN, Nanos(9_000_000_000)), None);
        narrow.map = Map::EMPTY;
        assert_eq!(narrow.back(&atrv, Pose::ORIGIN, Nanos(10_000_000_000)), None, "it has given up backing off");
    }

    #[test]
    fn a_robot_that_backs_off_does_so_even_if_the_way_is_free() {
        let y = sized(0.315, 0.27);
        let mut narrow = Narrow { stands: Some(Nanos::ZERO), ..Narrow::EMPTY };
        for (second, v) in [(9, Some(-FASTEST)), (12, Some(-FASTEST)), (13, None)] {
            let free = Some((Meters(3.0), Meters(0.5)));
            let twist = narrow.input(&y, Pose::ORIGIN, Nanos(second * 1_000_000_000), ahead(&y, free));
            assert_eq!(twist.map(|twist| twist.v.0), v, "{second} s");
        }
    }
}
