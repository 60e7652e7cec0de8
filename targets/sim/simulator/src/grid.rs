//! A uniform grid of segments. Finds the first segment that a ray hits, and the segments near a point. This module
//! contains all of the simulator's ray geometry.
//!
//! A ray visits the cells on its path in order (Amanatides and Woo, 1987) and stops in the first cell that contains a
//! hit. The code uses only additions, multiplications, divisions and square roots, so that results have the same bits
//! on every machine.

use crate::point::Point;

/// Approximate number of cells per segment. With more cells, the search is faster but needs more memory.
const CELLS_FOR_EACH: f64 = 3.0;
/// Maximum number of cells along one axis.
const CELLS_MOST: f64 = 4096.0;
/// Maximum number of cells that a segment of mean length crosses. A world with long walls therefore has larger cells.
const CROSSED_MOST: f64 = 8.0;
/// Fraction of a cell by which both ends of a segment are extended when it is entered into the grid, so that rounding
/// errors do not cause a cell to be missed.
const BEYOND: f64 = 1e-6;

/// A segment from the point `from` to `from` plus `along`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Segment {
    pub(crate) from: Point,
    pub(crate) along: Point,
}

/// Point at which a ray hits a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// Distance from the start of the ray, in metres.
    pub(crate) range: f64,
    /// Index of the segment.
    pub(crate) segment: usize,
}

/// A grid of segments. Each segment is entered in all cells that it touches.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    least: Point,
    /// Side length of a cell, in metres.
    cell: f64,
    columns: usize,
    rows: usize,
    /// Index of the first entry of each cell; an additional last element marks the end of the entries.
    starts: Vec<u32>,
    entries: Vec<(Segment, u32)>,
}

impl Segment {
    pub(crate) fn between(from: Point, to: Point) -> Self {
        Self { from, along: Point { x: to.x - from.x, y: to.y - from.y } }
    }

    pub(crate) fn to(&self) -> Point {
        Point { x: self.from.x + self.along.x, y: self.from.y + self.along.y }
    }

    /// Returns the distance that a ray from `from` in the unit direction `way` travels before it hits this segment;
    /// `None` if the ray does not hit it within `most` metres.
    pub(crate) fn met(&self, from: Point, way: Point, most: f64) -> Option<f64> {
        let (ox, oy) = (self.from.x - from.x, self.from.y - from.y);
        // Cramer's rule; the division is only done once a hit is certain.
        let determinant = way.x * self.along.y - way.y * self.along.x;
        let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
        let size = determinant * sign;
        let part = (ox * way.y - oy * way.x) * sign;
        let range = (ox * self.along.y - oy * self.along.x) * sign;
        let met = 0.0 <= part && part <= size && 0.0 <= range && range < most * size;
        met.then(|| range / size)
    }

    /// Returns the point of this segment that is nearest to `at`.
    pub(crate) fn nearest(&self, at: Point) -> Point {
        let (ox, oy) = (at.x - self.from.x, at.y - self.from.y);
        let part =
            (ox * self.along.x + oy * self.along.y) / (self.along.x * self.along.x + self.along.y * self.along.y);
        // Every segment has a positive length.
        let part = part.clamp(0.0, 1.0);
        Point { x: self.from.x + part * self.along.x, y: self.from.y + part * self.along.y }
    }
}

impl Grid {
    /// Creates a grid of these segments. Their coordinates must be finite.
    pub(crate) fn of(segments: &[Segment]) -> Self {
        let ends = || segments.iter().flat_map(|segment| [segment.from, segment.to()]);
        let bound = |of: fn(Point) -> f64, pick: fn(f64, f64) -> f64| ends().map(of).reduce(pick).unwrap_or(0.0);
        let least = Point { x: bound(|place| place.x, f64::min), y: bound(|place| place.y, f64::min) };
        let most = Point { x: bound(|place| place.x, f64::max), y: bound(|place| place.y, f64::max) };
        let (width, height) = (most.x - least.x, most.y - least.y);
        let cells = CELLS_FOR_EACH * segments.len().max(1) as f64;
        let long = width.max(height).max(1e-3);
        let lengths = segments.iter().map(|segment| segment.along.x.abs() + segment.along.y.abs());
        let crossing = lengths.sum::<f64>() / (CROSSED_MOST * segments.len().max(1) as f64);
        let cell = libm::sqrt(width * height / cells).max(long / cells.min(CELLS_MOST)).max(crossing).max(1e-3);
        let count = |length: f64| (length / cell) as usize + 1;
        let mut grid =
            Self { least, cell, columns: count(width), rows: count(height), starts: Vec::new(), entries: Vec::new() };
        grid.enter(segments);
        grid
    }

    /// Enters all segments. First counts the segments of each cell, then stores them.
    fn enter(&mut self, segments: &[Segment]) {
        let mut starts = vec![0_u32; self.columns * self.rows + 1];
        for segment in segments {
            self.touched(segment, |cell| starts[cell] += 1);
        }
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        let nothing = Segment { from: self.least, along: Point { x: 0.0, y: 0.0 } };
        let mut entries = vec![(nothing, 0); total as usize];
        let mut next = starts.clone();
        for (segment, number) in segments.iter().zip(0..) {
            self.touched(segment, |cell| {
                entries[next[cell] as usize] = (*segment, number);
                next[cell] += 1;
            });
        }
        (self.starts, self.entries) = (starts, entries);
    }

    /// Calls `take` with each cell that a segment touches. Goes column by column, and in each column through the rows
    /// that the segment crosses.
    fn touched(&self, segment: &Segment, mut take: impl FnMut(usize)) {
        let Segment { from, along } = *segment;
        let to = segment.to();
        let beyond = BEYOND * self.cell;
        let (left, right) = (from.x.min(to.x) - beyond, from.x.max(to.x) + beyond);
        let (low, high) = (from.y.min(to.y) - beyond, from.y.max(to.y) + beyond);
        for column in self.column(left)..=self.column(right) {
            // Part of the segment in this column.
            let edge = self.least.x + column as f64 * self.cell;
            let rises = |x: f64| from.y + along.y * ((x - from.x) / along.x).clamp(0.0, 1.0);
            let (mut bottom, mut top) = (low, high);
            if along.x != 0.0 {
                let (one, other) = (rises(edge - beyond), rises(edge + self.cell + beyond));
                (bottom, top) = (one.min(other) - beyond, one.max(other) + beyond);
            }
            for row in self.row(bottom.max(low))..=self.row(top.min(high)) {
                take(row * self.columns + column);
            }
        }
    }

    fn column(&self, x: f64) -> usize {
        // The conversion turns negative values into zero.
        (((x - self.least.x) / self.cell) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.least.y) / self.cell) as usize).min(self.rows - 1)
    }

    fn entries(&self, column: usize, row: usize) -> &[(Segment, u32)] {
        let cell = row * self.columns + column;
        &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Returns the first segment that a ray from `from` in the unit direction `way` hits; `None` if there is no hit
    /// within `most` metres.
    pub(crate) fn ray(&self, from: Point, way: Point, most: f64) -> Option<Hit> {
        let (entered, left) = self.crossed(from, way, most)?;
        let at = Point { x: from.x + entered * way.x, y: from.y + entered * way.y };
        let (mut column, mut row) = (self.column(at.x), self.row(at.y));
        let mut across = RayAxis::of(from.x - self.least.x, way.x, column, self.cell);
        let mut up = RayAxis::of(from.y - self.least.y, way.y, row, self.cell);
        let mut best = Hit { range: most, segment: usize::MAX };
        loop {
            for (segment, number) in self.entries(column, row) {
                if let Some(range) = segment.met(from, way, best.range) {
                    best = Hit { range, segment: *number as usize };
                }
            }
            let border = across.next.min(up.next);
            if best.range <= border || left < border {
                break;
            }
            let inside = if across.next < up.next {
                across.step(&mut column, self.columns)
            } else {
                up.step(&mut row, self.rows)
            };
            if !inside {
                break;
            }
        }
        (best.segment != usize::MAX).then_some(best)
    }

    /// Returns the distances along a ray at which the ray enters and leaves the grid; `None` if the ray does not cross
    /// the grid.
    fn crossed(&self, from: Point, way: Point, most: f64) -> Option<(f64, f64)> {
        let beyond = BEYOND * self.cell;
        let slab = |from: f64, way: f64, cells: usize| {
            let (least, most) = (-beyond, cells as f64 * self.cell + beyond);
            if way == 0.0 {
                let inside = least <= from && from <= most;
                return inside.then_some((f64::NEG_INFINITY, f64::INFINITY));
            }
            let (one, other) = ((least - from) / way, (most - from) / way);
            Some((one.min(other), one.max(other)))
        };
        let (left, right) = slab(from.x - self.least.x, way.x, self.columns)?;
        let (bottom, top) = slab(from.y - self.least.y, way.y, self.rows)?;
        let (entered, left) = (left.max(bottom).max(0.0), right.min(top).min(most));
        (entered <= left).then_some((entered, left))
    }

    /// Returns the number of segments in the cell that contains `at`.
    pub(crate) fn beside(&self, at: Point) -> u64 {
        self.entries(self.column(at.x), self.row(at.y)).len() as u64
    }

    /// Returns `true` if a ray from `at` with the length `reach` may hit a segment. The function checks only that the
    /// bounding rectangle of all segments overlaps the square that contains all such rays.
    pub(crate) fn is_in_reach(&self, at: Point, reach: f64) -> bool {
        let reach = reach + BEYOND * (self.cell + reach);
        let (left, right) = (at.x - reach, at.x + reach);
        let (low, high) = (at.y - reach, at.y + reach);
        let overlaps = |(Segment { from, along }, _): &(Segment, u32)| {
            let (x, y) = (from.x + along.x, from.y + along.y);
            from.x.min(x) <= right && from.x.max(x) >= left && from.y.min(y) <= high && from.y.max(y) >= low
        };
        let (columns, mut rows) = (self.column(left)..=self.column(right), self.row(low)..=self.row(high));
        rows.any(|row| columns.clone().any(|column| self.entries(column, row).iter().any(overlaps)))
    }

    /// Calls `take` with each segment that touches a cell within `reach` of `at`; `take` is called several times for a
    /// segment in several cells.
    pub(crate) fn near(&self, at: Point, reach: f64, mut take: impl FnMut(usize, &Segment)) {
        for row in self.row(at.y - reach)..=self.row(at.y + reach) {
            for column in self.column(at.x - reach)..=self.column(at.x + reach) {
                for (segment, number) in self.entries(column, row) {
                    take(*number as usize, segment);
                }
            }
        }
    }
}

/// State of a ray along one axis of the grid.
struct RayAxis {
    /// Distance along the ray to the next cell border.
    next: f64,
    /// Distance along the ray between two cell borders.
    between: f64,
    forward: bool,
}

impl RayAxis {
    fn of(from: f64, way: f64, number: usize, cell: f64) -> Self {
        let forward = way > 0.0;
        let border = (number + usize::from(forward)) as f64 * cell;
        if way == 0.0 {
            return Self { next: f64::INFINITY, between: 0.0, forward };
        }
        Self { next: (border - from) / way, between: (cell / way).abs(), forward }
    }

    /// Advances to the next cell. Returns `false` if there is no further cell.
    fn step(&mut self, number: &mut usize, count: usize) -> bool {
        self.next += self.between;
        let next = if self.forward { *number + 1 } else { number.wrapping_sub(1) };
        *number = next;
        next < count
    }
}
