//! Computes the cost of the way to the goal from each cell of a map. The costs spread as a wave: from the goal, or, if
//! the goal is not on the map, from the cells at the map's edge through which a way leads to the goal. Cells beside
//! obstacles cost more.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Pose};

use crate::gains::{Factors, Gains};
use crate::map::{self, CELLS, Cell, Map};

/// Number of cells along a side of the wave: the cells along a side of the map, and one more cell at each end.
pub(crate) const SIDE: usize = CELLS as usize + 2;
/// Cost of a step to a cell of the same row or column, in centimetres. All distances are whole centimetres.
const STRAIGHT: u16 = 5;
/// Cost of a diagonal step, in centimetres.
const ACROSS: u16 = 7;
/// Mask of the bits of a cell that contain its distance from the end of the way; the other bits contain its class.
const DISTANCE: u16 = 0x1fff;
/// For each class of cells, the room beside the body, in centimetres, below which a cell belongs to the class. A body
/// does not pass a cell of the first class. From class `AROUND` on, the room is measured from the smallest circle
/// around the body, inside which a rectangle can turn.
const CLASSES: [i32; 8] = [2, 4, 6, 8, 2, 10, 16, i32::MAX];
/// First class whose room is measured from the smallest circle around the body.
const AROUND: usize = 4;
/// First class in which any body can turn freely; a disc can also turn in lower classes.
const TURNS: usize = 5;
/// Room, in centimetres, below which the class of a cell is looked up in a table.
const SMALL: usize = 64;
/// Room on a map without obstacles, in centimetres.
const LARGE: i32 = DISTANCE as i32;
/// Factor of the cost of a step in a cell that the body does not pass. With it, the step costs more than any distance.
const NO_WAY: u16 = DISTANCE / STRAIGHT + 1;
/// Maximum class of an unknown cell.
const UNKNOWN: usize = 5;
/// Maximum number of passes over the map, forwards and backwards.
const PASSES: u32 = 12;
/// Distance, in metres, by which the end of a way at the map's edge must be nearer to the goal than the distance `from`
/// of [`Ends`].
const GAINS: f64 = 0.5;
/// Distance from the robot, in metres, that lies just beyond the corners of the map. The part of the distance to the
/// goal that lies further away is not included in the costs, so that a cost fits into a cell.
pub(crate) const EDGE: f64 = 2.4;

/// The ends of ways on a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    /// Position of the goal.
    pub(crate) goal: Pose,
    /// Distance from the goal at which the robot is near enough. It is needed because the body has no room at a goal
    /// that is near a wall, or inside the wall because odometry has drifted.
    pub(crate) near: Meters,
    /// Reference distance from the goal: a way may leave the map only where the distance from the goal is smaller than
    /// this by at least `GAINS`.
    pub(crate) from: Meters,
    /// Length, in metres, that is subtracted from all distances from the goal.
    pub(crate) base: f64,
}

/// The distance of each cell from the end of the cheapest way, and the class of each cell.
pub(crate) struct Wave {
    rows: [Row; SIDE],
    factors: &'static Factors,
}

/// A row of cells.
type Row = [u16; SIDE];

/// Rows of the map, one bit for each row, in which a forward or a backward pass may still lower a distance. A pass
/// lowers a distance in a row only after a distance in the same row or in the previous row of the pass has changed.
struct Rows {
    forth: u64,
    back: u64,
}

impl Rows {
    const NONE: Self = Self { forth: 0, back: 0 };

    /// Records that a distance in row `y` has changed.
    fn changes(&mut self, y: i32) {
        let row = 1_u64 << y;
        self.forth |= row | row << 1;
        self.back |= row | row >> 1;
    }

    fn are_done(&self) -> bool {
        const { assert!(CELLS as u32 == u64::BITS) };
        self.forth == 0 && self.back == 0
    }
}

/// Returns the index of a cell in a wave, given the cell's column and row, counted from the corner of the map.
pub(crate) fn index(x: i32, y: i32) -> usize {
    (y + 1) as usize * SIDE + (x + 1) as usize
}

fn class(value: u16) -> usize {
    (value >> 13) as usize
}

/// Returns the factor of the cost of a cell with this value; 0 if the body does not pass the cell.
fn factor(factors: &Factors, value: u16) -> u16 {
    factors.get(class(value)).copied().unwrap_or(0)
}

/// Returns the factor of a step's cost in a cell with this value; in a cell that the body does not pass, a step costs
/// more than any distance.
fn step(factors: &Factors, value: u16) -> u16 {
    match factor(factors, value) {
        0 => NO_WAY,
        factor => factor,
    }
}

/// Lowers the distances in a row, using steps from the cells that the pass has already processed. These are cells of
/// the same row and of the previous row. `factor` returns the factor of a step's cost, given the value of the cell.
/// Returns `true` if any distance has changed.
fn relax<'r>(
    mut row: impl Iterator<Item = &'r mut u16>,
    mut previous: impl Iterator<Item = &'r u16>,
    factor: impl Fn(u16) -> u16,
) -> bool {
    let mut earlier = || previous.next().map_or(DISTANCE, |value| value & DISTANCE);
    let (mut across, mut beside, mut changes) = (earlier(), earlier(), false);
    let mut before = row.next().map_or(DISTANCE, |value| *value & DISTANCE);
    for value in row.take(CELLS as usize) {
        let (next, factor, distance) = (earlier(), factor(*value), *value & DISTANCE);
        let least = (before.min(beside) + STRAIGHT * factor).min(across.min(next) + ACROSS * factor);
        changes |= least < distance;
        (across, beside, before) = (beside, next, distance.min(least));
        *value = *value & !DISTANCE | before;
    }
    changes
}

impl Wave {
    /// The wave before the computation, with the maximum distance in each cell.
    pub(crate) const NONE: Self = Self { rows: [[DISTANCE; SIDE]; SIDE], factors: &[0; CLASSES.len()] };

    /// Computes the wave that begins at `ends` on a map, for the body of `y`.
    pub(crate) fn start<Y: DiffDrive + SonarRing>(&mut self, map: &Map, ends: &Ends, y: &Y) {
        self.factors = &Gains::of(y).factors;
        self.measure(map, y);
        let rows = self.seed(map, ends);
        self.spread(rows);
    }

    /// Returns the cost from a cell to the goal, in centimetres, not including the length `base`; `None` if no way
    /// leads to the goal.
    pub(crate) fn left(&self, cell: usize) -> Option<i32> {
        let left = self.at(cell) & DISTANCE;
        (left < DISTANCE).then_some(left.into())
    }

    /// Returns the cost, in centimetres, of a way that is `cells` cells long, all of them of the same class as this
    /// cell.
    pub(crate) fn cost(&self, cell: usize, cells: f64) -> i32 {
        libm::round(f64::from(STRAIGHT * factor(self.factors, self.at(cell))) * cells) as i32
    }

    /// Returns `true` if the body can pass the cell.
    pub(crate) fn is_free(&self, cell: usize) -> bool {
        factor(self.factors, self.at(cell)) > 0
    }

    /// Returns `true` if the body cannot turn freely in the cell.
    pub(crate) fn is_tight(&self, cell: usize) -> bool {
        class(self.at(cell)) < TURNS
    }

    fn at(&self, cell: usize) -> u16 {
        self.rows.as_flattened().get(cell).copied().unwrap_or(DISTANCE)
    }

    fn set(&mut self, cell: usize, value: u16) {
        if let Some(place) = self.rows.as_flattened_mut().get_mut(cell) {
            *place = value;
        }
    }

    /// Measures the distance of every cell from the nearest occupied cell, and stores the cell's class.
    fn measure<Y: DiffDrive>(&mut self, map: &Map, y: &Y) {
        let (corner, mut rows) = (map.corner, Rows::NONE);
        for Cell { x, y } in map.occupied() {
            let (x, y) = (x - corner.x, y - corner.y);
            self.set(index(x, y), 0);
            rows.changes(y);
        }
        self.pass(&mut rows, |_| 1);
        let [half_width, radius] =
            [y.half_width(), y.body_radius()].map(|Meters(length)| libm::round(100.0 * length) as i32);
        let class_of = |room: i32| {
            let is_below =
                |(class, below): (usize, &i32)| room - if class < AROUND { half_width } else { radius } < *below;
            CLASSES.iter().enumerate().position(is_below).unwrap_or(CLASSES.len() - 1)
        };
        // Most cells have little room, or the room of a map without obstacles.
        let (small, large) = (core::array::from_fn::<_, SMALL, _>(|room| class_of(room as i32)), class_of(LARGE));
        for (row, y) in self.rows.iter_mut().skip(1).zip(0..CELLS) {
            for (value, evidence) in row.iter_mut().skip(1).zip(map.row(corner.y + y)) {
                let room = i32::from(*value);
                let known = if room == LARGE { Some(large) } else { small.get(room as usize).copied() };
                let class = known.unwrap_or_else(|| class_of(room));
                let class = if map::is_unknown(evidence) { class.min(UNKNOWN) } else { class };
                *value = (class as u16) << 13 | DISTANCE;
            }
        }
        // The robot can drive in the cells that it covers, even if an error of the map blocks them.
        for (x, y) in (-2..=2).flat_map(|y| (-2..=2).map(move |x| (CELLS / 2 + x, CELLS / 2 + y))) {
            if class(self.at(index(x, y))) == 0 {
                self.set(index(x, y), 1 << 13 | DISTANCE);
            }
        }
    }

    /// Passes over the rows of the map once forwards and once backwards. `factor` returns the factor of a cell's cost,
    /// given the cell's value.
    fn pass(&mut self, rows: &mut Rows, factor: impl Fn(u16) -> u16) {
        for y in 0..CELLS {
            if rows.forth >> y & 1 == 1
                && let [previous, row, ..] = self.rows_from(y)
                && relax(row.iter_mut(), previous.iter(), &factor)
            {
                rows.changes(y);
            }
        }
        rows.forth = 0;
        for y in (0..CELLS).rev() {
            if rows.back >> y & 1 == 1
                && let [_, row, previous, ..] = self.rows_from(y)
                && relax(row.iter_mut().rev(), previous.iter().rev(), &factor)
            {
                rows.changes(y);
            }
        }
        rows.back = 0;
    }

    /// Returns all rows from row `y` of the map on, and the row before it.
    fn rows_from(&mut self, y: i32) -> &mut [Row] {
        self.rows.get_mut(y as usize..).unwrap_or_default()
    }

    /// Sets the distances of the cells in which ways end; returns the rows in which distances may change as a result.
    fn seed(&mut self, map: &Map, Ends { goal, near, from, base }: &Ends) -> Rows {
        let (corner, end, mut rows) = (map.corner, Cell::of(goal.x.0, goal.y.0), Rows::NONE);
        for row in 0..CELLS {
            let is_edge = row == 0 || row == CELLS - 1;
            let (_, y) = Cell { x: corner.x, y: corner.y + row }.centre();
            let may_end = corner.y + row == end.y || (goal.y.0 - y).abs() < near.0;
            // In the other rows, ways end only in the first and the last cell.
            let columns = (0..CELLS).step_by(if is_edge || may_end { 1 } else { CELLS as usize - 1 });
            for column in columns {
                let is_border = is_edge || column == 0 || column == CELLS - 1;
                let at = Cell { x: corner.x + column, y: corner.y + row };
                let (x, y) = at.centre();
                let (ahead, aside) = (goal.x.0 - x, goal.y.0 - y);
                let is_near = ahead.abs() < near.0 && aside.abs() < near.0;
                let (place, value) = (index(column, row), self.at(index(column, row)));
                if !(at == end || is_near || is_border) || factor(self.factors, value) == 0 {
                    continue;
                }
                let left = libm::hypot(ahead, aside);
                if at == end || left < near.0 || is_border && left < from.0 - GAINS {
                    let distance = libm::round(100.0 * (left - base)).max(0.0) as u16;
                    self.set(place, value & !DISTANCE | distance.min(DISTANCE));
                    rows.changes(row);
                }
            }
        }
        rows
    }

    fn spread(&mut self, mut rows: Rows) {
        let factors = self.factors;
        for _ in 0..PASSES {
            if rows.are_done() {
                return;
            }
            self.pass(&mut rows, |value| step(factors, value));
        }
    }

    /// Returns the next cell along the way from this cell; `None` at the end of the way.
    pub(crate) fn next(&self, cell: usize) -> Option<usize> {
        const STEPS: [(usize, u16); 4] = [(1, STRAIGHT), (SIDE, STRAIGHT), (SIDE - 1, ACROSS), (SIDE + 1, ACROSS)];
        let (mut best, weight) = ((u16::MAX, cell), factor(self.factors, self.at(cell)));
        for (off, step) in STEPS {
            for other in [cell + off, cell.saturating_sub(off)] {
                let value = self.at(other);
                let total = (value & DISTANCE) + step * weight;
                if factor(self.factors, value) > 0 && total < best.0 {
                    best = (total, other);
                }
            }
        }
        (self.at(best.1) & DISTANCE < self.at(cell) & DISTANCE).then_some(best.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trial::Sensed;

    #[test]
    fn a_wave_ends_where_no_pass_changes_it() {
        let mut map = Map::EMPTY;
        for wall in [((0.5, -1.0), (0.5, 0.4)), ((1.0, 0.0), (1.0, 1.3)), ((-0.4, -0.9), (0.1, -0.9))] {
            map.occupy(wall.0, wall.1);
        }
        let goal = Pose { x: Meters(5.0), ..Pose::ORIGIN };
        let mut wave = Wave::NONE;
        let ends = Ends { goal, near: Meters(0.0), from: Meters(5.0), base: 2.6 };
        wave.start(&map, &ends, &Sensed::default());
        let here = index(CELLS / 2, CELLS / 2);
        assert!(wave.left(here).is_some_and(|left| left > 300), "a way round the walls");
        let (before, mut rows) = (wave.rows, Rows::NONE);
        (0..CELLS).for_each(|y| rows.changes(y));
        let factors = wave.factors;
        wave.pass(&mut rows, |value| step(factors, value));
        assert_eq!(wave.rows, before);
    }

    /// The wall is 15 cm thick, and the doorway is 50 cm wide on the map.
    #[test]
    fn a_doorway_costs_a_scout_less_than_another_body() {
        let mut map = Map::EMPTY;
        for (x, side) in [0.6, 0.65, 0.7].into_iter().flat_map(|x| [(x, 1.0), (x, -1.0)]) {
            map.occupy((x, 0.025 + 0.25 * side), (x, 0.025 + 1.5 * side));
        }
        let cost = |y: &Sensed| {
            let (goal, mut wave) = (Pose { x: Meters(1.2), ..Pose::ORIGIN }, Wave::NONE);
            wave.start(&map, &Ends { goal, near: Meters(0.0), from: Meters(1.2), base: 0.0 }, y);
            wave.left(index(CELLS / 2, CELLS / 2)).expect("a way") - 120
        };
        let (scout, ideal) = (cost(&Sensed { confirmation: 2, ..Sensed::default() }), cost(&Sensed::default()));
        assert!(scout + 100 < ideal, "{scout}, {ideal}");
    }
}
