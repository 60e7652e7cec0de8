//! A map of the obstacles around the robot, made from the echoes of its sonars (an occupancy grid). For each cell of a
//! square, it records evidence: how often an echo came from the cell, and how often a ping passed it. The map moves
//! with the robot.

use mdle_runtime::capability::{DiffDrive, SonarRing};
use mdle_runtime::{Meters, Nanos, Pose, Radians, SONARS, SonarId};

use crate::gains::{Evidence, Gains, fire_in_turn};

/// Number of cells along a side.
pub(crate) const CELLS: i32 = 64;
/// Side of a cell, in metres.
pub(crate) const CELL: f64 = 0.05;
/// Number of rows of cells.
const ROWS: usize = CELLS as usize;
/// Size of a row, in bytes; a byte contains two cells.
const BYTES: usize = ROWS / 2;
/// Value of the evidence in an unknown cell.
const UNKNOWN: u8 = 4;
/// Values of the evidence in a row of unknown cells.
const UNKNOWN_ROW: [u8; BYTES] = [UNKNOWN | UNKNOWN << 4; BYTES];
/// Minimum evidence of an occupied cell.
const OCCUPIED: u8 = 8;
/// Minimum evidence of a doubtful cell: an echo came from it, and a ping has passed it since.
const DOUBTFUL: u8 = 6;
/// Maximum evidence of a cell.
const MOST: u8 = 13;
/// Amount by which a passing ping decreases the evidence of a cell. With 3, a few pings that missed a jamb beside the
/// body cleared it, and twice as many Scouts touched it. With 1, echoes that came from elsewhere on their arcs would
/// close doorways.
const MISS: u8 = 2;
/// Evidence of a cell that one ping has passed.
const PASSED_ONCE: u8 = UNKNOWN - MISS;
/// Angles from a sonar's axis, in degrees, of the points that represent an echo.
const ARC: [f64; 9] = [-12.0, -9.0, -6.0, -3.0, 0.0, 3.0, 6.0, 9.0, 12.0];
/// Rays along which a ping marks cells as free: the angle from the sonar's axis, in degrees, and the distance from the
/// transducer, in metres, at which the marking begins. Nearer cells are marked by another ray.
const RAYS: [(f64, f64); 5] = [(0.0, 0.0), (-EDGE, 0.26), (EDGE, 0.26), (-5.5, 0.52), (5.5, 0.52)];
/// Angle between a sonar's axis and the rays at the edges of its cone, in degrees.
const EDGE: f64 = 11.0;
/// Distance from the transducer, in metres, up to which a ping changes the map.
const WITHIN: f64 = 1.6;
/// Range, in metres, that is used in place of a range that is too small to be exact: the obstacle may then be at any
/// smaller distance.
const INSTEAD: f64 = 0.1;
/// Maximum absolute index of a cell, so that the difference of two indices does not overflow.
const FURTHEST: f64 = 1e8;
/// Number of parts into which the sonars are divided, on a robot whose sonars all ping in every turn. In each turn, one
/// part is read.
const THIRDS: usize = 3;
/// Distance from an echo, in metres, within which cells are not marked as free.
const BEFORE: f64 = 0.08;

/// A cell, given by its indices along both axes of the odometry coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cell {
    pub(crate) x: i32,
    pub(crate) y: i32,
}

impl Cell {
    /// Returns the cell that contains this position.
    pub(crate) fn of(x: f64, y: f64) -> Self {
        let [x, y] = [x, y].map(|metres| below((metres / CELL).clamp(-FURTHEST, FURTHEST)));
        Self { x, y }
    }

    /// Returns the centre of the cell, in metres.
    pub(crate) fn centre(self) -> (f64, f64) {
        ((f64::from(self.x) + 0.5) * CELL, (f64::from(self.y) + 0.5) * CELL)
    }
}

/// Returns the largest whole number that is at most `number`. The absolute value of `number` is at most [`FURTHEST`].
/// `floor` of `libm`, or a conversion that checks for overflow, would take longer.
fn below(number: f64) -> i32 {
    // In a sum of this size, the last bit of the mantissa counts ones, so the low bits contain the nearest whole
    // number.
    const ROUNDS: f64 = 6_755_399_441_055_744.0;
    const { assert!(ROUNDS == 1.5 * (1_u64 << 52) as f64) };
    let sum = number + ROUNDS;
    sum.to_bits() as i32 - i32::from(sum - ROUNDS > number)
}

/// Number of binary places of a coordinate on the map, which makes its resolution 0.05 µm.
const BINARY: u32 = 20;

/// Converts a number of cells to a fixed-point number. The number is at most a few times the number of cells of the
/// map.
fn fixed(cells: f64) -> i32 {
    const LIMIT: f64 = 4.0 * CELLS as f64;
    (cells.clamp(-LIMIT, LIMIT) * f64::from(1 << BINARY)) as i32
}

/// Returns the largest whole number of cells that is at most the fixed-point number `cells`.
fn whole(cells: i32) -> i32 {
    cells >> BINARY
}

/// Evidence for obstacles around the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Map {
    evidence: [[u8; BYTES]; ROWS],
    /// The cell with the smallest indices.
    pub(crate) corner: Cell,
    /// Time up to which the pings of each third of the sonars have been read; `None` before the first reading. Sonars
    /// that fire in turn all belong to the first third.
    taken: [Option<Nanos>; THIRDS],
    /// Number of the third that is read next.
    third: usize,
}

impl Map {
    pub(crate) const EMPTY: Self =
        Self { evidence: [UNKNOWN_ROW; ROWS], corner: Cell { x: 0, y: 0 }, taken: [None; THIRDS], third: 0 };

    /// Updates the map with the pings since the last turn; the robot is at `here`. On a robot whose sonars all ping in
    /// every turn, each sonar is read in every third turn, which is about as often as a sonar that fires in turn pings.
    pub(crate) fn take<Y: DiffDrive + SonarRing>(&mut self, y: &Y, here: Pose) {
        self.move_to(here);
        let Gains { least_range: least, saturates, evidence, .. } = *Gains::of(y);
        let thirds = if fire_in_turn(y) { 1 } else { THIRDS };
        let third = self.third % thirds;
        self.third = (third + 1) % thirds;
        let taken = self.taken.get_mut(third).and_then(|taken| taken.replace(y.now()));
        let of_third = |sonar: &SonarId| sonar.number() % thirds == third;
        for sonar in (0..SONARS as u8).map(SonarId::new).filter(of_third) {
            let mut pings = y.pings(sonar).newest_first();
            let Some(ping) = pings.next().filter(|ping| taken.is_none_or(|taken| ping.at > taken)) else {
                continue;
            };
            // A single missed echo does not mark cells as free.
            let before = pings.next().and_then(|before| before.range);
            let Meters(range) = ping.range.or(before).unwrap_or(Meters(f64::INFINITY));
            let centre = ping.axis(sonar);
            let (axis, from) = (centre.theta, centre.towards(centre.theta, y.ring_radius()));
            if range >= least {
                self.pass(from, axis, (range - BEFORE).min(WITHIN), evidence.edges);
            }
            if ping.range.is_some() && range < WITHIN {
                if range >= least {
                    self.hit(from, axis, range, (evidence, range < saturates));
                } else if !self.explains(from, axis, least) {
                    self.hit(from, axis, INSTEAD, (evidence, false));
                }
            }
        }
    }

    /// Marks as free the cells that a ping from this position passed in the direction of `axis`, up to the distance
    /// `free`.
    fn pass(&mut self, from: Pose, axis: Radians, free: f64, edges: f64) {
        let Cell { x: left, y: low } = self.corner;
        // A ping passes many cells. In whole numbers, each takes two additions.
        let [x, y] = [(from.x, left), (from.y, low)].map(|(at, corner)| fixed(at.0 / CELL - f64::from(corner)));
        for (degrees, begin) in RAYS {
            let (sin, cos) = libm::sincos(axis.0 + degrees.to_radians());
            let (along, up) = (fixed(cos), fixed(sin));
            let free = if degrees.abs() < EDGE { free } else { free.min(edges) };
            let end = libm::floor(free / CELL).max(0.0) as i32 + 1;
            let mut last = -1;
            for step in libm::floor(begin / CELL) as i32..end {
                let (right, above) = (whole(x + step * along), whole(y + step * up));
                let number = above * CELLS + right;
                // A cell that is repeated in succession is changed only once.
                if is_within(right) && is_within(above) && number != last {
                    last = number;
                    self.free(Cell { x: left + right, y: low + above });
                }
            }
        }
    }

    /// Removes the evidence of a ping that passed a cell of the map.
    fn free(&mut self, cell: Cell) {
        let (row, column, shift) = place(cell);
        if let Some(byte) = self.evidence.get_mut(row).and_then(|row| row.get_mut(column)) {
            let evidence = *byte >> shift & 15;
            *byte -= evidence.min(MISS) << shift;
        }
    }

    /// Returns `true` if the map already has an object nearer than `least` in the cone of a sonar at this position.
    fn explains(&self, from: Pose, axis: Radians, least: f64) -> bool {
        ARC.iter().any(|degrees| {
            let (sin, cos) = libm::sincos(axis.0 + degrees.to_radians());
            let steps = libm::ceil(least / CELL) as i32 + 1;
            (0..=steps).any(|step| {
                let along = f64::from(step) * CELL;
                self.is_occupied(Cell::of(from.x.0 + along * cos, from.y.0 + along * sin))
            })
        })
    }

    /// Records an echo. If a cell on the echo's arc is occupied, the evidence of the cells with the most evidence is
    /// increased. Otherwise the cells on the arc become occupied that at most one ping has passed; if pings have passed
    /// all of them, those with the most evidence.
    ///
    /// If `is_saturated` is `true`, all cells on the arc become occupied in any case. Such an echo repeats while the
    /// robot drives along a wall that approaches its front corner, and the occupied cells that the arc still contains
    /// would hide the part of the wall ahead of them.
    fn hit(
        &mut self,
        from: Pose,
        axis: Radians,
        range: f64,
        (Evidence { hit, below, .. }, is_saturated): (Evidence, bool),
    ) {
        let cells = ARC.map(|degrees| {
            let (sin, cos) = libm::sincos(axis.0 + degrees.to_radians());
            Cell::of(from.x.0 + range * cos, from.y.0 + range * sin)
        });
        let most = cells.iter().map(|cell| self.evidence(*cell)).max().unwrap_or(UNKNOWN);
        let is_known = most >= OCCUPIED;
        self.once(cells.into_iter(), |evidence| match is_known {
            _ if is_saturated => evidence.max(OCCUPIED),
            true if evidence + below >= most => (evidence + hit).min(MOST),
            true => evidence,
            false if evidence == most || evidence >= PASSED_ONCE => OCCUPIED,
            false => evidence,
        });
    }

    /// Returns the evidence for an object in a cell; outside the map, the evidence of an unknown cell.
    fn evidence(&self, cell: Cell) -> u8 {
        let (row, column, shift) = place(cell);
        let byte = self.evidence.get(row).and_then(|row| row.get(column)).filter(|_| self.contains(cell));
        byte.map_or(UNKNOWN, |byte| byte >> shift & 15)
    }

    /// Applies `to` to the evidence of each cell. If the same cell comes several times in succession, it is changed
    /// only once.
    fn once(&mut self, cells: impl Iterator<Item = Cell>, to: impl Fn(u8) -> u8) {
        let mut last = None;
        for cell in cells {
            if last != Some(cell) {
                self.change(cell, &to);
            }
            last = Some(cell);
        }
    }

    /// Moves the map so that the robot is in its middle, and resets the cells that are new on the map to unknown.
    fn move_to(&mut self, here: Pose) {
        let Cell { x, y } = Cell::of(here.x.0, here.y.0);
        let corner = Cell { x: x - CELLS / 2, y: y - CELLS / 2 };
        let Cell { x: from_x, y: from_y } = self.corner;
        let (dx, dy) = (corner.x - from_x, corner.y - from_y);
        self.corner = corner;
        if (dx, dy) == (0, 0) {
            return;
        }
        for step in 0..dx.abs().min(CELLS) {
            self.forget_column(if dx > 0 { corner.x + CELLS - 1 - step } else { corner.x + step });
        }
        for step in 0..dy.abs().min(CELLS) {
            self.forget_row(if dy > 0 { corner.y + CELLS - 1 - step } else { corner.y + step });
        }
    }

    /// Resets the cells with this x index to unknown.
    fn forget_column(&mut self, x: i32) {
        let (_, column, shift) = place(Cell { x, y: 0 });
        for byte in self.evidence.iter_mut().filter_map(|row| row.get_mut(column)) {
            *byte = *byte & !(15 << shift) | UNKNOWN << shift;
        }
    }

    /// Resets the cells with this y index to unknown.
    fn forget_row(&mut self, y: i32) {
        let (row, ..) = place(Cell { x: 0, y });
        if let Some(row) = self.evidence.get_mut(row) {
            *row = UNKNOWN_ROW;
        }
    }

    /// Returns `true` if the cell is on the map.
    pub(crate) fn contains(&self, cell: Cell) -> bool {
        is_within(cell.x - self.corner.x) && is_within(cell.y - self.corner.y)
    }

    fn change(&mut self, cell: Cell, to: impl Fn(u8) -> u8) {
        if !self.contains(cell) {
            return;
        }
        let (row, column, shift) = place(cell);
        if let Some(byte) = self.evidence.get_mut(row).and_then(|row| row.get_mut(column)) {
            let evidence = to(*byte >> shift & 15);
            *byte = *byte & !(15 << shift) | evidence << shift;
        }
    }

    /// Returns `true` if the cell is occupied; `false` outside the map.
    pub(crate) fn is_occupied(&self, cell: Cell) -> bool {
        self.evidence(cell) >= OCCUPIED
    }

    /// Returns `true` if the cell or one of the eight cells around it is occupied.
    pub(crate) fn is_occupied_near(&self, Cell { x, y }: Cell) -> bool {
        (0..9).any(|number| self.is_occupied(Cell { x: x + number % 3 - 1, y: y + number / 3 - 1 }))
    }

    /// Returns the occupied cells.
    pub(crate) fn occupied(&self) -> impl Iterator<Item = Cell> {
        // Most rows have no occupied cell, and most bytes contain two cells that are not occupied.
        const { assert!(OCCUPIED == 8) };
        let is_occupied = |byte: u8| byte & (OCCUPIED | OCCUPIED << 4) != 0;
        let rows = (0..).zip(&self.evidence);
        let rows = rows.filter(move |(_, row)| is_occupied(row.iter().fold(0, |all, byte| all | byte)));
        let bytes = rows.flat_map(move |(y, row)| {
            (0..).zip(row).filter(move |(_, byte)| is_occupied(**byte)).map(move |(number, _)| (2 * number, y))
        });
        let cells = bytes.flat_map(|(x, y)| [Cell { x, y }, Cell { x: x + 1, y }]);
        let on_map = |at: i32, corner: i32| corner + ((at - corner) & (CELLS - 1));
        let cells = cells.map(move |Cell { x, y }| Cell { x: on_map(x, self.corner.x), y: on_map(y, self.corner.y) });
        cells.filter(|cell| self.is_occupied(*cell))
    }

    /// Returns the evidence of the cells in the row with this number, in order.
    pub(crate) fn row(&self, y: i32) -> impl Iterator<Item = u8> {
        (self.corner.x..self.corner.x.saturating_add(CELLS)).map(move |x| {
            let (row, column, shift) = place(Cell { x, y });
            let byte = self.evidence.get(row).and_then(|row| row.get(column));
            byte.map_or(UNKNOWN, |byte| byte >> shift & 15)
        })
    }

    /// Returns the centres of the occupied cells whose distance from the robot along each axis is at most `within`
    /// metres. The centres are relative to the robot at `here`, and are ordered by squares around the robot's own cell,
    /// from the innermost square outwards.
    pub(crate) fn around(&self, here: Pose, within: Meters) -> impl Iterator<Item = (f64, f64)> {
        self.cells_around(here, within, |evidence| evidence >= OCCUPIED)
    }

    /// Returns the centres of the doubtful cells, like [`Self::around`]. They are not occupied, but the end of a smooth
    /// wall may be there: a ping that meets the wall at a slant receives no echo of it, and so passes its cells.
    pub(crate) fn doubtful_around(&self, here: Pose, within: Meters) -> impl Iterator<Item = (f64, f64)> {
        self.cells_around(here, within, |evidence| (DOUBTFUL..OCCUPIED).contains(&evidence))
    }

    /// Returns the centres of the cells with such evidence, in the order of [`Self::around`].
    fn cells_around(
        &self,
        here: Pose,
        within: Meters,
        is_such: impl Fn(u8) -> bool,
    ) -> impl Iterator<Item = (f64, f64)> {
        let middle = Cell::of(here.x.0, here.y.0);
        let reach = libm::ceil(within.0 / CELL) as i32;
        (0..=reach).flat_map(square).filter_map(move |(x, y)| {
            let cell = Cell { x: middle.x + x, y: middle.y + y };
            let (x, y) = cell.centre();
            is_such(self.evidence(cell)).then_some((x - here.x.0, y - here.y.0))
        })
    }
}

/// Returns the offsets of the cells on the edge of a square that extends `half` cells from its middle to each side.
fn square(half: i32) -> impl Iterator<Item = (i32, i32)> {
    (-half..=half).flat_map(move |x| {
        // The first and the last column belong to the edge; of the other columns, only the two ends do.
        let step = if x.abs() == half { 1 } else { 2 * half };
        (-half..=half).step_by(step.max(1) as usize).map(move |y| (x, y))
    })
}

/// Returns `true` if a number of cells from the corner of the map, along one axis, leads to a cell on the map.
fn is_within(cells: i32) -> bool {
    // Converted to unsigned, a negative number becomes large.
    (cells as u32) < CELLS as u32
}

/// Returns `true` if this is the evidence of an unknown cell.
pub(crate) fn is_unknown(evidence: u8) -> bool {
    evidence == UNKNOWN
}

/// Returns the row and the byte in which a cell's evidence is stored, and the number of bits by which the evidence is
/// shifted in this byte. These values do not change when the map moves.
#[inline]
fn place(Cell { x, y }: Cell) -> (usize, usize, u8) {
    const { assert!(ROWS.is_power_of_two()) };
    let (x, y) = (x as usize & (ROWS - 1), y as usize & (ROWS - 1));
    (y, x / 2, 4 * (x & 1) as u8)
}

#[cfg(test)]
impl Map {
    /// A map around a robot at the origin, all cells of which pings have passed.
    pub(crate) const FREE: Self =
        Self { evidence: [[0; BYTES]; ROWS], corner: Cell { x: -CELLS / 2, y: -CELLS / 2 }, ..Self::EMPTY };

    /// Marks as occupied every cell along a line between two positions, in metres. The robot is at the origin.
    pub(crate) fn occupy(&mut self, from: (f64, f64), to: (f64, f64)) {
        self.move_to(Pose::ORIGIN);
        let steps = libm::ceil(libm::hypot(to.0 - from.0, to.1 - from.1) / CELL) as i32;
        for step in 0..=steps {
            let part = f64::from(step) / f64::from(steps.max(1));
            let (x, y) = (from.0 + part * (to.0 - from.0), from.1 + part * (to.1 - from.1));
            self.change(Cell::of(x, y), |_| MOST);
        }
    }

    /// Lets three pings pass every cell of the map; those that were marked by [`Self::occupy`] are doubtful then.
    pub(crate) fn doubt(&mut self) {
        let Cell { x, y } = self.corner;
        let cells = (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| Cell { x: x + column, y: y + row }));
        cells.for_each(|cell| (0..3).for_each(|_| self.free(cell)));
    }
}

#[cfg(test)]
mod tests;
