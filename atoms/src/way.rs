//! Finds the shortest way on a map to a place nearer to the goal. A rectangular body keeps to its way until another way
//! is much shorter. It drives straight through places in which it cannot turn: in the last place before them, it turns
//! to face the first place beyond them.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians};

use crate::map::{CELLS, Cell, Map};
use crate::wave::{EDGE, Ends, SIDE, Wave, index};
use crate::winding::Winding;

/// Maximum amount, in centimetres, by which the cost of a way may exceed the length of a straight line to the goal.
const LONGER: i32 = 600;
/// Distance along the way, in cells, of the place to which a disc drives.
const AHEAD: u32 = 7;
/// Distance, in cells, of the place to which a rectangle drives where it can turn.
const NEAR: f64 = 7.0;
/// Maximum distance along the way, in cells, over which a rectangle drives straight where it cannot turn.
const STRAIGHT_MOST: u32 = 24;
/// Number of cells between the end of a narrow section and the place beyond it to which a rectangle drives straight.
const BEYOND: u32 = 3;
/// Maximum distance from a narrow section, in cells, at which a rectangle begins to drive straight.
const BEFORE: f64 = 1.5;
/// Maximum amount, in centimetres, by which the cost of the way chosen before may exceed the cost of the best way, so
/// that single pings, which change the best way, do not make the robot change its way.
const KEEPS: i32 = 80;

/// The state of the tangent rule in this turn.
pub(crate) struct Ahead {
    /// Place of the goal.
    pub(crate) goal: Pose,
    /// Maximum distance from the goal at which the goal is treated as reached.
    pub(crate) near: Meters,
    /// Reference distance from the goal; a way must end nearer to the goal. Infinite if a way may lead anywhere off the
    /// map.
    pub(crate) from: Meters,
    /// Direction that the tangent rule has chosen.
    pub(crate) chosen: Radians,
    /// Free length of the way to the goal, and the length that is required; `None` on a detour.
    pub(crate) free: Option<(Meters, Meters)>,
    /// Speed at which the robot drives where the way is free.
    pub(crate) speed: MetersPerSecond,
    /// Angle by which the robot has turned.
    pub(crate) winding: Winding,
    /// Next place of the last way; `None` if there is no last way.
    pub(crate) before: Option<Next>,
    /// `true` if the robot keeps away from doubtful cells.
    pub(crate) doubts: bool,
}

/// The next place on a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Next {
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// `true` if the body cannot turn on the way to the place, and so has to drive straight.
    pub(crate) is_straight: bool,
}

/// Returns the next place to which the body of `y`, at `here`, has to drive on its way to the goal; `None` if the map
/// has no way that leads nearer.
///
/// The function is not inlined: the wave is the largest value that a law puts on the stack, so it should not remain on
/// the stack after the function has returned.
#[inline(never)]
pub(crate) fn way<Y: DiffDrive + SonarRing>(map: &Map, here: Pose, ahead: &Ahead, y: &Y) -> Option<Next> {
    let (goal, straight) = (&ahead.goal, here.distance(&ahead.goal).0);
    let base = (straight - EDGE).max(0.0);
    // Constructed in place: a copy would take the same space on the stack again.
    let mut wave = Wave::NONE;
    wave.start(map, &Ends { goal: *goal, near: ahead.near, from: ahead.from, base }, y);
    let way = Way { wave: &wave, here: index(CELLS / 2, CELLS / 2) };
    let most = libm::round(100.0 * (straight - base)) as i32 + LONGER;
    if way.wave.left(way.here)? > most && ahead.from.0.is_finite() {
        return None;
    }
    let (to, is_straight) = if y.is_disc() { (way.ahead(), false) } else { way.beyond(map, ahead.before) };
    let corner = map.corner;
    let end = Cell::of(goal.x.0, goal.y.0);
    if map.contains(end) && to == index(end.x - corner.x, end.y - corner.y) {
        return Some(Next { x: goal.x.0, y: goal.y.0, is_straight });
    }
    let cell = Cell { x: corner.x + (to % SIDE) as i32 - 1, y: corner.y + (to / SIDE) as i32 - 1 };
    let (x, y) = cell.centre();
    Some(Next { x, y, is_straight })
}

/// The wave, and the cell of the robot.
struct Way<'w> {
    wave: &'w Wave,
    here: usize,
}

impl Way<'_> {
    /// Returns the cell of the next place of the last way; `None` if that way is no longer usable.
    fn kept(&self, map: &Map, before: &Next) -> Option<usize> {
        let at = Cell::of(before.x, before.y);
        let cell = map.contains(at).then(|| index(at.x - map.corner.x, at.y - map.corner.y))?;
        let total = self.wave.left(cell)? + self.wave.cost(self.here, apart(self.here, cell));
        (self.sees(cell) && total <= self.wave.left(self.here)? + KEEPS).then_some(cell)
    }

    /// Returns the cell that is a few steps ahead along the way.
    fn ahead(&self) -> usize {
        (0..AHEAD).fold(self.here, |cell, _| self.wave.next(cell).unwrap_or(cell))
    }

    /// Returns the cell to which a rectangular body drives next, and `true` if it must drive there straight. Before a
    /// narrow section this is the last cell in which the body can turn; from there it is a cell a little beyond the
    /// section, if a free straight line leads to it. `before` is the previous result, from which the search continues
    /// if it is still usable.
    fn beyond(&self, map: &Map, before: Option<Next>) -> (usize, bool) {
        let before = before.and_then(|before| Some((self.kept(map, &before)?, before.is_straight)));
        let is_tight = |cell: usize| self.wave.is_tight(cell);
        let goes_straight = |(cell, is_straight): (usize, bool)| is_straight && line(self.here, cell).any(is_tight);
        let mut is_straight = is_tight(self.here) || before.is_some_and(goes_straight);
        let (mut cell, mut left) = (before.map_or(self.here, |(cell, _)| cell), BEYOND);
        for _ in 0..STRAIGHT_MOST {
            let Some(next) = self.wave.next(cell) else { break };
            if is_tight(next) && !is_straight {
                if apart(self.here, cell) > BEFORE {
                    return (cell, false);
                }
                is_straight = true;
            }
            let is_far = apart(self.here, cell) >= NEAR;
            if is_far && (!is_straight || left == 0 || !self.sees(next)) {
                break;
            }
            if is_straight && !is_tight(next) {
                left = left.saturating_sub(1);
            }
            cell = next;
        }
        (cell, is_straight)
    }

    /// Returns `true` if the body can pass all cells on the straight line from the robot to this cell.
    fn sees(&self, to: usize) -> bool {
        line(self.here, to).all(|cell| self.wave.is_free(cell))
    }
}

/// Returns the distance between two cells, in cells.
fn apart(from: usize, to: usize) -> f64 {
    let ((x, y), (to_x, to_y)) = (place(from), place(to));
    libm::hypot(to_x - x, to_y - y)
}

/// Returns the column and the row of a cell.
fn place(cell: usize) -> (f64, f64) {
    ((cell % SIDE) as f64, (cell / SIDE) as f64)
}

/// Returns the cells on the line between two cells.
fn line(from: usize, to: usize) -> impl Iterator<Item = usize> {
    let ((x, y), (to_x, to_y)) = (place(from), place(to));
    let steps = libm::ceil(2.0 * apart(from, to)).max(1.0);
    (0..=steps as usize).map(move |step| {
        let part = step as f64 / steps;
        libm::round(y + part * (to_y - y)) as usize * SIDE + libm::round(x + part * (to_x - x)) as usize
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, sized};

    /// Returns the state of the tangent rule after it has chosen the way straight ahead to a goal. The reference
    /// distance is 5 m.
    fn ahead(goal: Pose, before: Option<Next>) -> Ahead {
        Ahead {
            goal,
            near: Meters(0.0),
            from: Meters(5.0),
            chosen: Radians(0.0),
            free: None,
            speed: MetersPerSecond(0.2),
            winding: Winding::begin(&Sensed::default()),
            before,
            doubts: false,
        }
    }

    /// Returns the first place to which the robot drives on its way past a wall 0.6 m ahead; `None` if there is no way.
    /// The wall has a gap of this width, in metres, with its middle 0.3 m to the left.
    fn through(gap: f64, y: &Sensed) -> Option<(f64, f64)> {
        let mut map = Map::EMPTY;
        map.occupy((0.6, 0.3 + gap / 2.0), (0.6, 1.55));
        map.occupy((0.6, 0.3 - gap / 2.0), (0.6, -1.55));
        let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
        way(&map, Pose::ORIGIN, &ahead(goal, None), y).map(|next| (next.x, next.y))
    }

    #[test]
    fn a_gap_wider_than_the_body_is_a_way() {
        let y = Sensed::default();
        let (x, left) = through(0.6, &y).expect("a way");
        assert!(x > 0.1 && left > 0.05, "({x}, {left})");
        assert_eq!(through(0.38, &y), None);
    }

    #[test]
    fn a_rectangle_needs_a_gap_of_its_width() {
        let y = sized(0.315, 0.27);
        assert!(through(0.75, &y).is_some());
        assert_eq!(through(0.5, &y), None);
    }

    #[test]
    fn a_goal_on_the_map_is_driven_to() {
        let goal = Pose { x: Meters(0.2), y: Meters(0.1), ..Pose::ORIGIN };
        let ahead = Ahead { from: Meters(0.22), ..ahead(goal, None) };
        let mut map = Map::EMPTY;
        map.occupy((1.0, 1.0), (1.0, 1.0));
        let next = Some(Next { x: 0.2, y: 0.1, is_straight: false });
        assert_eq!(way(&map, Pose::ORIGIN, &ahead, &Sensed::default()), next);
    }

    /// Returns the next place to which an ATRV-mini drives at this distance from a doorway 0.7 m wide.
    fn before_a_doorway(distance: f64, before: Option<Next>) -> Next {
        let mut map = Map::EMPTY;
        for side in [-1.0, 1.0] {
            map.occupy((distance, 0.35 * side), (distance, 1.55 * side));
        }
        let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
        way(&map, Pose::ORIGIN, &ahead(goal, before), &sized(0.315, 0.27)).expect("a way")
    }

    #[test]
    fn a_rectangle_turns_before_a_doorway_and_goes_straight() {
        let first = before_a_doorway(0.7, None);
        assert!(!first.is_straight && (0.25..0.45).contains(&first.x), "{first:?}");
        for distance in [0.3, 0.1] {
            let next = before_a_doorway(distance, None);
            assert!(next.is_straight && next.x > distance + 0.25 && next.y.abs() < 0.06, "{next:?}");
        }
        let next = before_a_doorway(-0.6, None);
        assert!(!next.is_straight, "{next:?}");
    }

    /// Sonars hear only the parts of the wall that face them, here 15 cm beside a doorway. On the map, the doorway is
    /// 0.8 m wide.
    #[test]
    fn a_doorway_is_shorter_than_the_way_round_the_part_of_its_wall_that_is_heard() {
        let mut map = Map::FREE;
        for (x, side) in [0.4, 0.45, 0.5].into_iter().flat_map(|x| [(x, 1.0), (x, -1.0)]) {
            map.occupy((x, 0.125 + 0.4 * side), (x, 0.125 + 0.55 * side));
        }
        let goal = Pose { x: Meters(2.6), ..Pose::ORIGIN };
        let atrv = Sensed { confirmation: 2, ..sized(0.315, 0.27) };
        let next = way(&map, Pose::ORIGIN, &Ahead { from: Meters(2.6), ..ahead(goal, None) }, &atrv).expect("a way");
        assert!(next.x > 0.25 && (next.y - 0.125).abs() < 0.06, "{next:?}");
    }

    #[test]
    fn a_way_is_kept_until_another_is_much_shorter() {
        // A post straight ahead can be passed equally well on both sides.
        let mut map = Map::EMPTY;
        map.occupy((0.6, -0.1), (0.6, 0.1));
        let next = |left: f64| {
            let before = Some(Next { x: 0.3, y: left, is_straight: false });
            let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
            way(&map, Pose::ORIGIN, &ahead(goal, before), &sized(0.315, 0.27)).expect("a way").y
        };
        assert!(next(0.3) > 0.1 && next(-0.3) < -0.1);
    }

    /// A body has no room at a goal 10 cm from a wall, so the robot drives to a place that is near enough.
    #[test]
    fn a_goal_beside_a_wall_has_a_way() {
        let mut map = Map::EMPTY;
        map.occupy((1.2, -1.55), (1.2, 1.55));
        let goal = Pose { x: Meters(1.1), ..Pose::ORIGIN };
        let next = |near| {
            let ahead = Ahead { near: Meters(near), from: Meters(1.1), ..ahead(goal, None) };
            way(&map, Pose::ORIGIN, &ahead, &sized(0.315, 0.27))
        };
        assert_eq!(next(0.1), None);
        assert!(next(0.5).is_some_and(|next| next.x > 0.3 && next.y.abs() < 0.1));
    }
}
