//! The poses at which the robots of a crowd begin. Each pose is a lattice point with a random heading.

use mdle_runtime::{Meters, Pose, Radians};
use mdle_sim::{Point, World};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

use super::super::file::ScenarioError;

/// Points of a lattice over a world, row by row.
pub(super) struct Places {
    least: Point,
    columns: u64,
    count: u64,
    spacing: f64,
    next: u64,
    random: ChaCha8Rng,
}

impl Places {
    /// Returns the lattice points between the walls of `world`. The headings are random; `seed` is their random seed.
    pub(super) fn of(world: &World, spacing: f64, seed: u64) -> Self {
        let points = || world.outlines.iter().flat_map(|outline| &outline.points);
        let bound = |of: fn(&Point) -> f64, pick: fn(f64, f64) -> f64| points().map(of).reduce(pick).unwrap_or(0.0);
        let (left, low) = (bound(|place| place.x, f64::min), bound(|place| place.y, f64::min));
        let (right, high) = (bound(|place| place.x, f64::max), bound(|place| place.y, f64::max));
        let along = |length: f64| libm::floor(length / spacing).max(0.0) as u64;
        let (columns, rows) = (along(right - left), along(high - low));
        let least = Point { x: left + spacing / 2.0, y: low + spacing / 2.0 };
        let random = ChaCha8Rng::seed_from_u64(seed);
        Self { least, columns, count: columns.saturating_mul(rows), spacing, next: 0, random }
    }
}

impl Iterator for Places {
    type Item = Pose;

    fn next(&mut self) -> Option<Pose> {
        if self.next >= self.count {
            return None;
        }
        let (column, row) = (self.next % self.columns, self.next / self.columns);
        self.next += 1;
        let turns = (self.random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        Some(Pose {
            x: Meters(self.least.x + column as f64 * self.spacing),
            y: Meters(self.least.y + row as f64 * self.spacing),
            theta: Radians(std::f64::consts::TAU * turns).wrapped(),
        })
    }
}

/// Returns a square hall with room for `robots` robots at a distance of `spacing` metres from each other.
///
/// # Errors
/// Never fails, because the text of the hall is valid.
pub(super) fn hall(robots: u64, spacing: f64) -> Result<World, ScenarioError> {
    let rows = libm::ceil(libm::sqrt(robots as f64));
    // Slightly larger than the lattice, so that rounding does not remove a row.
    let side = (rows + 0.01) * spacing;
    let start = spacing / 2.0;
    let text = format!(
        "start = {{ x = {start:?}, y = {start:?}, heading = 0.0 }}\n[[wall]]\nname = \"wall\"\npoints = [[0, 0], \
         [{side:?}, 0], [{side:?}, {side:?}], [0, {side:?}], [0, 0]]\n"
    );
    World::parse("the hall", &text).map_err(|error| ScenarioError::whole(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hall_has_room_for_all() {
        for (robots, spacing) in [(1, 2.0), (2, 0.5), (100, 2.0), (9_999, 3.7)] {
            let world = hall(robots, spacing).unwrap_or_else(|_| panic!("a good world"));
            let places: Vec<Pose> = Places::of(&world, spacing, 1).collect();
            assert!(places.len() as u64 >= robots, "{robots}");
            let apart = places.windows(2).map(|pair| pair[0].distance(&pair[1]).0);
            assert!(apart.fold(f64::INFINITY, f64::min) > 0.999 * spacing, "{robots}");
        }
    }
}
