//! An evidence grid: for each cell, the log-odds that the cell is occupied, computed from sonar pings (Martin and
//! Moravec, the paper's reference 26). docs/src/navigation.md describes the model.

/// Number of cells along each axis, as in the paper's Fig. 9.
pub(super) const CELLS: usize = 150;
/// Edge length of a cell, in metres (one inch).
pub(crate) const CELL: f64 = 0.0254;
/// Distance from the middle of the grid to its edges, in metres.
pub(crate) const HALF: f64 = CELL * CELLS as f64 / 2.0;
/// Maximum absolute value of log-odds.
const MOST: f64 = 5.0;
/// Half the angle of a sonar's cone, in radians.
const CONE: f64 = 12.5 * std::f64::consts::PI / 180.0;
/// Tangent of half the angle of a wider cone. This cone contains a sonar's cone even with rounding errors.
const WIDER: f64 = 0.25;
/// Half the depth of an echo's arc, in metres.
const DEPTH: f64 = 0.05;
/// Range, in metres, beyond which an echo does not mark cells as occupied.
const FARTHEST: f64 = 3.0;
/// Distance, in metres, up to which a ping without an echo marks cells as free. A smooth wall beyond this distance may
/// return no echo.
const SILENT: f64 = 0.5;
/// Distance, in metres, from which no cell is marked as free.
const FADES: f64 = 2.5;

/// A ping, in grid coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GridPing {
    /// Position of the transducer, in metres.
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// Direction of the transducer, in radians.
    pub(crate) theta: f64,
    /// Range in metres; `None` without an echo.
    pub(crate) range: Option<f64>,
}

/// A square grid, centred on the origin of its coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct EvidenceGrid {
    /// Log-odds of the cells, row by row in the order of the y coordinates.
    odds: Vec<f64>,
}

impl EvidenceGrid {
    /// Creates a grid without evidence, in which all log-odds are 0.
    pub(crate) fn new() -> Self {
        Self { odds: vec![0.0; CELLS * CELLS] }
    }

    /// Adds the evidence of a ping.
    pub(crate) fn take(&mut self, ping: &GridPing) {
        let reach = ping.range.map_or(SILENT, |range| range.min(FARTHEST) + DEPTH);
        let direction = libm::sincos(ping.theta);
        let (sin, cos) = direction;
        let aside = WIDER * reach;
        // The wider cone is a triangle: its tip is the transducer, and these are the other two corners.
        let columns = between(ping.x, reach * cos - aside * sin, reach * cos + aside * sin);
        let rows = between(ping.y, reach * sin - aside * cos, reach * sin + aside * cos);
        for row in rows {
            let cells = self.odds.iter_mut().enumerate().skip(row * CELLS + columns.start).take(columns.len());
            let y = middle(row) - ping.y;
            for (number, odds) in cells {
                let x = middle(number % CELLS) - ping.x;
                *odds = (*odds + evidence(x, y, direction, ping)).clamp(-MOST, MOST);
            }
        }
    }

    /// Creates a grid with these probabilities, which are given row by row in the order of the y coordinates.
    pub(super) fn of(probabilities: impl Iterator<Item = f64>) -> Self {
        let odds = |p: f64| libm::log(p / (1.0 - p)).clamp(-MOST, MOST);
        Self { odds: probabilities.map(odds).collect() }
    }

    /// Returns the log-odds at a position; 0 outside the grid.
    pub(super) fn odds_at(&self, x: f64, y: f64) -> f64 {
        cell_at(x, y).and_then(|cell| self.odds.get(cell)).copied().unwrap_or_default()
    }

    /// Returns the log-odds of all cells, row by row in the order of the y coordinates.
    pub(super) fn odds(&self) -> impl Iterator<Item = f64> {
        self.odds.iter().copied()
    }

    /// Returns the probability that a cell is occupied. `column` counts along the x axis, `row` along the y axis.
    pub(crate) fn probability(&self, column: usize, row: usize) -> f64 {
        let odds = self.odds.get(row * CELLS + column).copied().unwrap_or_default();
        1.0 / (1.0 + libm::exp(-odds))
    }
}

/// Returns the index of the cell at a position; `None` outside the grid. Cells are numbered row by row in the order of
/// the y coordinates.
pub(super) fn cell_at(x: f64, y: f64) -> Option<usize> {
    let (column, row) = (libm::floor((x + HALF) / CELL), libm::floor((y + HALF) / CELL));
    let (inside, end) = (column >= 0.0 && row >= 0.0, CELLS as f64);
    (inside && column < end && row < end).then_some(row as usize * CELLS + column as usize)
}

/// Returns the coordinate of a cell's centre along an axis, in metres.
pub(super) fn middle(cell: usize) -> f64 {
    (cell as f64 + 0.5) * CELL - HALF
}

/// Returns the indices, along an axis, of the cells whose centres may be within a triangle. A corner is at `position`,
/// and the others are `one` and `other` away from it.
fn between(position: f64, one: f64, other: f64) -> std::ops::Range<usize> {
    // The conversion to an integer saturates. A cell more at each end makes up for rounding errors.
    let cell = |at: f64| (libm::floor((at + HALF) / CELL).max(0.0) as usize).min(CELLS);
    cell(position + one.min(other).min(0.0) - CELL)..cell(position + one.max(other).max(0.0) + 2.0 * CELL)
}

/// Returns the change in a cell's log-odds that a ping causes. `x` and `y` are the cell's coordinates relative to the
/// transducer, in metres; `sin` and `cos` are the sine and the cosine of the transducer's direction.
fn evidence(x: f64, y: f64, (sin, cos): (f64, f64), ping: &GridPing) -> f64 {
    let (ahead, aside) = (x * cos + y * sin, y * cos - x * sin);
    // Nine cells in ten lie outside the wider cone or behind the transducer, and need no angle.
    if aside.abs() > WIDER * ahead {
        return 0.0;
    }
    let distance = libm::hypot(x, y);
    let angle = libm::atan2(aside, ahead);
    if angle.abs() >= CONE || distance > ping.range.map_or(SILENT, |range| range + DEPTH) {
        return 0.0;
    }
    let weight = 1.0 - (angle / CONE) * (angle / CONE);
    let free = -0.35 * weight * (1.0 - (distance / FADES) * (distance / FADES)).max(0.0);
    match ping.range {
        Some(range) if distance >= range - DEPTH => {
            let off = (distance - range) / DEPTH;
            if range <= FARTHEST { 0.9 * (0.6 / range).min(1.0) * weight * (1.0 - off * off) } else { 0.0 }
        }
        Some(_) | None => free,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the probability at a position, after pings of these ranges along the x axis from the origin.
    fn after(ranges: &[Option<f64>], x: f64, y: f64) -> f64 {
        let mut grid = EvidenceGrid::new();
        for range in ranges {
            grid.take(&GridPing { x: 0.0, y: 0.0, theta: 0.0, range: *range });
        }
        let cell = |at: f64| ((at + HALF) / CELL) as usize;
        grid.probability(cell(x), cell(y))
    }

    #[test]
    fn an_echo_is_free_before_and_occupied_there() {
        let echoes = [Some(1.0); 4];
        assert!(after(&echoes, 0.5, 0.0) < 0.3 && after(&echoes, 1.0, 0.0) > 0.8);
        for (x, y) in [(1.1, 0.0), (0.5, 0.3), (-0.5, 0.0), (1.0, 0.4)] {
            assert_eq!(after(&echoes, x, y).to_bits(), 0.5_f64.to_bits(), "{x} {y}");
        }
    }

    #[test]
    fn a_ping_changes_what_is_in_its_cone() {
        for direction in [0.0, 0.7, 2.0, -3.1] {
            let ping = GridPing { x: 0.0, y: 0.0, theta: direction, range: None };
            for tenth in -1800..1800_i32 {
                let (sin, cos) = libm::sincos(direction + f64::from(tenth).to_radians() / 10.0);
                let changed = evidence(0.4 * cos, 0.4 * sin, libm::sincos(direction), &ping) < 0.0;
                // The edges of the cone are not checked, because rounding moves them.
                assert!(tenth.abs() == 125 || changed == (tenth.abs() < 125), "{direction} {tenth}");
            }
        }
    }

    #[test]
    fn no_cell_of_the_cone_is_left_out() {
        for number in 0..72_i32 {
            let theta = f64::from(5 * number + number % 5).to_radians();
            let (x, y) = (f64::from(number % 7) * 0.3 - 1.0, f64::from(number % 11) * 0.2 - 1.0);
            let range = (number % 3 > 0).then_some(0.2 + f64::from(number % 13) * 0.25);
            let ping = GridPing { x, y, theta, range };
            let mut grid = EvidenceGrid::new();
            grid.take(&ping);
            for (cell, odds) in grid.odds.iter().enumerate() {
                let (x, y) = (middle(cell % CELLS) - ping.x, middle(cell / CELLS) - ping.y);
                // Adding zero drops the sign of a zero, as in the grid.
                let expected = 0.0 + evidence(x, y, libm::sincos(theta), &ping);
                assert_eq!(odds.to_bits(), expected.to_bits(), "{ping:?} {cell}");
            }
        }
    }

    #[test]
    fn silence_frees_the_nearest_half_metre() {
        assert!(after(&[None; 4], 0.4, 0.0) < 0.3);
        assert_eq!(after(&[None; 4], 0.6, 0.0).to_bits(), 0.5_f64.to_bits());
    }

    #[test]
    fn a_far_echo_marks_no_wall() {
        let mut grid = EvidenceGrid::new();
        grid.take(&GridPing { x: -1.8, y: 0.0, theta: 0.0, range: Some(3.2) });
        let cells = (0..CELLS).flat_map(|row| (0..CELLS).map(move |column| (column, row)));
        assert!(cells.into_iter().all(|(column, row)| grid.probability(column, row) <= 0.5));
    }

    #[test]
    fn evidence_has_a_limit() {
        let most = 1.0 / (1.0 + libm::exp(-MOST));
        assert_eq!(after(&[Some(0.5); 100], 0.5, 0.0).to_bits(), most.to_bits());
        let (first, later) = (after(&[Some(0.5); 100], 0.3, 0.0), after(&[Some(0.5); 200], 0.3, 0.0));
        assert_eq!(first.to_bits(), later.to_bits());
    }

    #[test]
    fn a_ping_from_outside_the_grid_is_taken() {
        let mut grid = EvidenceGrid::new();
        for (x, y) in [(1e9, 0.0), (-1e9, -1e9), (f64::NAN, 0.0)] {
            grid.take(&GridPing { x, y, theta: 0.0, range: Some(1.0) });
        }
        assert_eq!(grid, EvidenceGrid::new());
        grid.take(&GridPing { x: -2.5, y: 0.0, theta: 0.0, range: Some(2.0) });
        assert!(grid.probability(((-0.5 + HALF) / CELL) as usize, CELLS / 2) > 0.5);
    }
}
