//! Many robots in one world. Finds the robots that are near each other.

use crate::footprint::Footprint;
use crate::point::Point;

/// Minimum side length of a cell, in metres.
const CELL_LEAST: f64 = 1.0;
/// Maximum number of grid cells per robot.
const CELLS_MOST: f64 = 8.0;

/// The footprints of robots at a certain time, stored in a grid.
#[derive(Debug, Clone)]
pub struct Crowd {
    bodies: Vec<Footprint>,
    least: Point,
    /// Side length of a cell, in metres.
    cell: f64,
    columns: usize,
    rows: usize,
    /// Index of the first entry of each cell, row by row; an additional last element marks the end of the entries.
    starts: Vec<u32>,
    /// Numbers of the robots, ordered by the cells that contain their centres.
    entries: Vec<u32>,
}

/// Groups of robots. Robots of different groups cannot touch each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Groups {
    /// Numbers of the robots, group by group, in ascending order within a group.
    members: Vec<u32>,
    /// Index of the first member of each group; an additional last element marks the end of the members.
    starts: Vec<u32>,
}

impl Crowd {
    /// Creates a crowd of robots with these footprints. Their coordinates must be finite.
    #[must_use]
    pub fn of(bodies: Vec<Footprint>) -> Self {
        let bound = |of: fn(&Footprint) -> f64, pick: fn(f64, f64) -> f64| bodies.iter().map(of).reduce(pick);
        let (x, y) = (|body: &Footprint| body.pose.x.0, |body: &Footprint| body.pose.y.0);
        let least = Point { x: bound(x, f64::min).unwrap_or(0.0), y: bound(y, f64::min).unwrap_or(0.0) };
        let (width, height) =
            (bound(x, f64::max).unwrap_or(0.0) - least.x, bound(y, f64::max).unwrap_or(0.0) - least.y);
        let cells = CELLS_MOST * bodies.len().max(1) as f64;
        // Limits the number of cells also if the robots stand in a row.
        let cell = libm::sqrt(width * height / cells).max(width.max(height) / cells).max(CELL_LEAST);
        let count = |length: f64| (length / cell) as usize + 1;
        let (columns, rows) = (count(width), count(height));
        let mut crowd = Self { bodies, least, cell, columns, rows, starts: Vec::new(), entries: Vec::new() };
        crowd.enter();
        crowd
    }

    /// Enters all robots into the grid. First counts the robots of each cell, then stores them.
    fn enter(&mut self) {
        let cells: Vec<usize> = self.bodies.iter().map(|body| self.cell_of(body.at())).collect();
        let mut starts = vec![0_u32; self.columns * self.rows + 1];
        for cell in &cells {
            starts[*cell + 1] += 1;
        }
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let mut next = starts.clone();
        let mut entries = vec![0; self.bodies.len()];
        for (cell, number) in cells.iter().zip(0..) {
            entries[next[*cell] as usize] = number;
            next[*cell] += 1;
        }
        (self.starts, self.entries) = (starts, entries);
    }

    fn cell_of(&self, at: Point) -> usize {
        self.row(at.y) * self.columns + self.column(at.x)
    }

    fn column(&self, x: f64) -> usize {
        // The conversion turns negative values into zero.
        (((x - self.least.x) / self.cell) as usize).min(self.columns - 1)
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.least.y) / self.cell) as usize).min(self.rows - 1)
    }

    /// Returns the footprints of the robots; the index is the robot's number.
    #[must_use]
    pub fn bodies(&self) -> &[Footprint] {
        &self.bodies
    }

    /// Calls `take` with the number and the footprint of each robot whose centre is within `reach` metres of `at`. The
    /// order depends only on the footprints.
    pub fn near(&self, at: Point, reach: f64, mut take: impl FnMut(usize, &Footprint)) {
        let (left, right) = (self.column(at.x - reach), self.column(at.x + reach));
        for row in self.row(at.y - reach)..=self.row(at.y + reach) {
            let first = row * self.columns;
            // Adjacent cells of a row have adjacent entries.
            let (from, to) = (self.starts[first + left], self.starts[first + right + 1]);
            for number in self.entries[from as usize..to as usize].iter().map(|number| *number as usize) {
                let body = &self.bodies[number];
                let (x, y) = (body.pose.x.0 - at.x, body.pose.y.0 - at.y);
                if x * x + y * y <= reach * reach {
                    take(number, body);
                }
            }
        }
    }

    /// Returns the groups of robots. Two robots are in the same group if a chain of robots connects them, in which the
    /// centres of neighbours are at most `reach` metres apart.
    #[must_use]
    pub fn groups(&self, reach: f64) -> Groups {
        let mut leaders: Vec<u32> = (0..self.bodies.len() as u32).collect();
        for (number, body) in self.bodies.iter().enumerate() {
            self.near(body.at(), reach, |other, _| {
                if other < number {
                    let (one, other) = (leader(&mut leaders, number as u32), leader(&mut leaders, other as u32));
                    leaders[one.max(other) as usize] = one.min(other);
                }
            });
        }
        Groups::of(&mut leaders)
    }
}

/// Returns the lowest known number in the group of robot `number`, and shortens the chain that leads to it.
fn leader(leaders: &mut [u32], mut number: u32) -> u32 {
    while leaders[number as usize] != number {
        leaders[number as usize] = leaders[leaders[number as usize] as usize];
        number = leaders[number as usize];
    }
    number
}

impl Groups {
    /// Creates the groups. `leaders` contains an entry for each robot: the robot's own number if it is the lowest in
    /// the group, and a lower number of the group otherwise.
    fn of(leaders: &mut [u32]) -> Self {
        let mut sizes = vec![0_u32; leaders.len()];
        for number in 0..leaders.len() as u32 {
            leaders[number as usize] = leader(leaders, number);
            sizes[leaders[number as usize] as usize] += 1;
        }
        let (mut starts, mut next, mut total) = (Vec::new(), vec![0; leaders.len()], 0);
        for (place, size) in next.iter_mut().zip(&sizes).filter(|(_, size)| **size > 0) {
            starts.push(total);
            *place = total;
            total += size;
        }
        starts.push(total);
        let mut members = vec![0; leaders.len()];
        for (number, leader) in (0..).zip(&*leaders) {
            members[next[*leader as usize] as usize] = number;
            next[*leader as usize] += 1;
        }
        Self { members, starts }
    }

    /// Returns the number of groups.
    #[must_use]
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the numbers of the robots in a group, in ascending order. `number` is the index of the group; it must be
    /// below [`Groups::count`].
    #[must_use]
    pub fn group(&self, number: usize) -> &[u32] {
        let bounds = self.starts.get(number).zip(self.starts.get(number + 1));
        bounds.and_then(|(from, to)| self.members.get(*from as usize..*to as usize)).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::{Meters, Pose};

    use super::*;
    use crate::footprint::Form;
    use crate::noise::{Noise, Purpose};
    use crate::surfaces::apart;

    fn scattered(count: u32, side: f64, seed: u64) -> Vec<Footprint> {
        let mut noise = Noise::of(seed, Purpose::Start);
        let mut at = || Meters(side * (noise.uniform() - 0.5));
        (0..count).map(|_| Footprint { pose: Pose { x: at(), y: at(), ..Pose::ORIGIN }, form: Form::SCOUT }).collect()
    }

    #[test]
    fn the_grid_finds_whom_a_search_of_all_finds() {
        for (count, side) in [(1, 10.0), (50, 5.0), (300, 40.0), (20, 5000.0)] {
            let bodies = scattered(count, side, 3);
            let crowd = Crowd::of(bodies.clone());
            for (body, reach) in bodies.iter().zip([0.1, 0.7, 7.0, 100.0].into_iter().cycle()) {
                let mut near = Vec::new();
                crowd.near(body.at(), reach, |number, _| near.push(number));
                near.sort_unstable();
                let all = bodies.iter().enumerate().filter(|(_, other)| apart(other.at(), body.at()) <= reach);
                assert_eq!(near, all.map(|(number, _)| number).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn groups_are_all_robots_and_never_near_each_other() {
        let bodies = scattered(400, 20.0, 5);
        let groups = Crowd::of(bodies.clone()).groups(0.8);
        let mut members: Vec<u32> = (0..groups.count()).flat_map(|group| groups.group(group).to_vec()).collect();
        let group_of = |robot: u32| (0..groups.count()).position(|group| groups.group(group).contains(&robot));
        assert!(groups.count() > 100 && (0..groups.count()).any(|group| groups.group(group).len() > 3));
        assert!((0..groups.count()).all(|group| groups.group(group).is_sorted()));
        for (one, body) in (0..).zip(&bodies) {
            for (other, _) in (0..).zip(&bodies).filter(|(_, other)| apart(other.at(), body.at()) <= 0.8) {
                assert_eq!(group_of(one), group_of(other));
            }
        }
        members.sort_unstable();
        assert!(members.into_iter().eq(0..400));
        assert_eq!(Crowd::of(Vec::new()).groups(1.0).count(), 0);
    }
}
