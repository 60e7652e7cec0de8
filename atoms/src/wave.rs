//! The shortest way on a map to where the robot is nearer to its goal: a wave that starts at the goal, or at the edge
//! of the map on the way to it, and costs more beside obstacles.

use mdle_runtime::capability::DiffDrive;
use mdle_runtime::{Meters, MetersPerSecond, Pose, Radians};

use crate::map::{CELLS, Cell, Map};

/// Cells along a side of the wave: those of the map, and one around them.
const SIDE: usize = CELLS as usize + 2;
/// Distances are whole centimetres: a step to a cell beside, and to one across.
const STRAIGHT: u16 = 5;
const ACROSS: u16 = 7;
/// The bits of a cell that hold the distance; the others hold its class.
const DISTANCE: u16 = 0x1fff;
/// Room beside the body, in centimetres, below which a cell is of a class, and the factor of its cost. A body does not
/// pass a cell of the first class. From `TURNS` on, room counts beside the smallest circle around the body, in which a
/// rectangle turns.
const CLASSES: [(i32, u16); 7] = [(2, 0), (4, 10), (6, 6), (8, 5), (10, 4), (16, 2), (i32::MAX, 1)];
const TURNS: usize = 4;
/// Class of cells of which nothing is known.
const UNKNOWN: usize = 4;
/// Maximum number of passes over the map, to and fro.
const PASSES: u32 = 12;
/// A way ends where the goal is nearer by this, in metres.
const GAINS: f64 = 0.5;
/// Most centimetres, by cost, that a way may be longer than the straight one.
const LONGER: i32 = 600;
/// Distance of the far edge of the map, in metres, from which distances count.
const EDGE: f64 = 2.4;
/// Distance along the way, in cells, of the place that is driven to.
const AHEAD: u32 = 7;

/// The state of the tangent rule in this turn.
pub(crate) struct Ahead {
    /// Place of the goal.
    pub(crate) goal: Pose,
    /// Distance of the goal from which a way must lead nearer.
    pub(crate) from: Meters,
    /// Direction that the rule has chosen.
    pub(crate) chosen: Radians,
    /// Length of the way to the goal that is free, and that is asked for; `None` on a detour.
    pub(crate) free: Option<(Meters, Meters)>,
    /// Speed where the way is free.
    pub(crate) speed: MetersPerSecond,
}

/// The distance of each cell from the end of the way, and its class.
struct Wave {
    cells: [u16; SIDE * SIDE],
}

/// Returns the place at which the body of `y`, at `here`, next has to be on its way to the goal; `None` if the map has
/// no way that leads nearer.
pub(crate) fn way<Y: DiffDrive>(map: &Map, here: Pose, ahead: &Ahead, y: &Y) -> Option<(f64, f64)> {
    let mut wave = Wave { cells: [DISTANCE; SIDE * SIDE] };
    wave.measure(map, y);
    let (goal, straight) = (&ahead.goal, here.distance(&ahead.goal).0);
    let base = (straight - EDGE).max(0.0);
    wave.seed(map, goal, ahead.from.0, base);
    wave.spread();
    let middle = index(CELLS / 2, CELLS / 2);
    let distance = i32::from(wave.at(middle) & DISTANCE);
    if distance >= i32::from(DISTANCE) || distance > libm::round(100.0 * (straight - base)) as i32 + LONGER {
        return None;
    }
    let to = wave.ahead(middle);
    let corner = map.corner;
    let end = Cell::of(goal.x.0, goal.y.0);
    if map.contains(end) && to == index(end.x - corner.x, end.y - corner.y) {
        return Some((goal.x.0, goal.y.0));
    }
    let cell = Cell { x: corner.x + (to % SIDE) as i32 - 1, y: corner.y + (to / SIDE) as i32 - 1 };
    Some(cell.centre())
}

/// The place of a cell of the map, given by its numbers from the corner.
fn index(x: i32, y: i32) -> usize {
    (y + 1) as usize * SIDE + (x + 1) as usize
}

/// The cells of the map, row by row.
fn all() -> impl Iterator<Item = (i32, i32, usize)> {
    (0..CELLS).flat_map(|y| (0..CELLS).map(move |x| (x, y, index(x, y))))
}

fn factor(value: u16) -> u16 {
    CLASSES.get((value >> 13) as usize).map_or(0, |class| class.1)
}

impl Wave {
    fn at(&self, cell: usize) -> u16 {
        self.cells.get(cell).copied().unwrap_or(DISTANCE)
    }

    fn set(&mut self, cell: usize, value: u16) {
        if let Some(place) = self.cells.get_mut(cell) {
            *place = value;
        }
    }

    /// Measures the distance of every cell from the nearest occupied one, and notes its class.
    fn measure<Y: DiffDrive>(&mut self, map: &Map, y: &Y) {
        let corner = map.corner;
        for (x, y, place) in all() {
            if map.is_occupied(Cell { x: corner.x + x, y: corner.y + y }) {
                self.set(place, 0);
            }
        }
        self.pass(|_| 1);
        let [half_width, radius] =
            [y.half_width(), y.body_radius()].map(|Meters(length)| libm::round(100.0 * length) as i32);
        for (x, y, place) in all() {
            let room = i32::from(self.at(place));
            let is_below = |(class, (below, _)): (usize, &(i32, u16))| {
                room - if class < TURNS { half_width } else { radius } < *below
            };
            let mut class = CLASSES.iter().enumerate().position(is_below).unwrap_or(CLASSES.len() - 1);
            let cell = Cell { x: corner.x + x, y: corner.y + y };
            if class > UNKNOWN && map.is_unknown(cell) {
                class = UNKNOWN;
            }
            // The robot is where it is.
            if class == 0 && (x - CELLS / 2).abs() <= 2 && (y - CELLS / 2).abs() <= 2 {
                class = 1;
            }
            self.set(place, (class as u16) << 13 | DISTANCE);
        }
    }

    /// Passes over the map to and fro once; `true` if a distance has changed. `factor` is that of a cell's cost.
    fn pass(&mut self, factor: impl Fn(u16) -> u16) -> bool {
        let forth =
            self.relax((0..CELLS).flat_map(|y| (0..CELLS).map(move |x| index(x, y))), &factor, |cell, off| cell - off);
        let back = self.relax(
            (0..CELLS).rev().flat_map(|y| (0..CELLS).rev().map(move |x| index(x, y))),
            &factor,
            |cell, off| cell + off,
        );
        forth || back
    }

    fn relax(
        &mut self,
        cells: impl Iterator<Item = usize>,
        factor: impl Fn(u16) -> u16,
        other: impl Fn(usize, usize) -> usize,
    ) -> bool {
        let mut changes = false;
        for cell in cells {
            let value = self.at(cell);
            let factor = factor(value);
            if factor == 0 {
                continue;
            }
            let beside = (self.at(other(cell, 1)) & DISTANCE).min(self.at(other(cell, SIDE)) & DISTANCE);
            let across = (self.at(other(cell, SIDE - 1)) & DISTANCE).min(self.at(other(cell, SIDE + 1)) & DISTANCE);
            let least = (beside + STRAIGHT * factor).min(across + ACROSS * factor);
            if least < value & DISTANCE {
                self.set(cell, value & !DISTANCE | least);
                changes = true;
            }
        }
        changes
    }

    /// Sets the distances where ways end.
    fn seed(&mut self, map: &Map, goal: &Pose, from: f64, base: f64) {
        let corner = map.corner;
        for (x, y, place) in all() {
            let is_border = x == 0 || y == 0 || x == CELLS - 1 || y == CELLS - 1;
            let at = Cell { x: corner.x + x, y: corner.y + y };
            let is_goal = at == Cell::of(goal.x.0, goal.y.0);
            let value = self.at(place);
            if !(is_goal || is_border) || factor(value) == 0 {
                continue;
            }
            let (x, y) = at.centre();
            let left = libm::hypot(goal.x.0 - x, goal.y.0 - y);
            if is_goal || left < from - GAINS {
                let distance = libm::round(100.0 * (left - base)).max(0.0) as u16;
                self.set(place, value & !DISTANCE | distance.min(DISTANCE));
            }
        }
    }

    fn spread(&mut self) {
        for _ in 0..PASSES {
            if !self.pass(factor) {
                return;
            }
        }
    }

    /// The cell a few steps along the way from this one.
    fn ahead(&self, from: usize) -> usize {
        const STEPS: [(usize, u16); 4] = [(1, STRAIGHT), (SIDE, STRAIGHT), (SIDE - 1, ACROSS), (SIDE + 1, ACROSS)];
        let mut cell = from;
        for _ in 0..AHEAD {
            let (mut best, weight) = ((u16::MAX, cell), factor(self.at(cell)));
            for (off, step) in STEPS {
                for other in [cell + off, cell.saturating_sub(off)] {
                    let value = self.at(other);
                    let total = (value & DISTANCE) + step * weight;
                    if factor(value) > 0 && total < best.0 {
                        best = (total, other);
                    }
                }
            }
            if self.at(best.1) & DISTANCE >= self.at(cell) & DISTANCE {
                return cell;
            }
            cell = best.1;
        }
        cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::{Sensed, sized};
    use mdle_runtime::{MetersPerSecond, Radians};

    /// Returns the place to drive to first, past a wall 0.6 m ahead with a gap of this width, in metres, whose middle
    /// is
    /// 0.3 m to the left.
    fn through(gap: f64, y: &Sensed) -> Option<(f64, f64)> {
        let mut map = Map::EMPTY;
        map.occupy((0.6, 0.3 + gap / 2.0), (0.6, 1.55));
        map.occupy((0.6, 0.3 - gap / 2.0), (0.6, -1.55));
        let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
        let speed = MetersPerSecond(0.2);
        let ahead = Ahead { goal, from: Meters(5.0), chosen: Radians(0.0), free: None, speed };
        way(&map, Pose::ORIGIN, &ahead, y)
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
        let ahead = Ahead { goal, from: Meters(0.22), chosen: Radians(0.0), free: None, speed: MetersPerSecond(0.2) };
        let mut map = Map::EMPTY;
        map.occupy((1.0, 1.0), (1.0, 1.0));
        assert_eq!(way(&map, Pose::ORIGIN, &ahead, &Sensed::default()), Some((0.2, 0.1)));
    }
}
