//! Makes a map from pings. Also computes a score that tells how well the echoes of these pings fit the map.

use super::grid::{CELLS, EvidenceGrid, GridPing, cell_at};
use super::matching::{BEFORE_WEIGHT, Echo};
use super::saved_map::SavedMap;

/// The map that has been made from the pings so far.
#[derive(Debug, Clone)]
pub(crate) struct MapMaker {
    grid: EvidenceGrid,
    /// Weight of each cell in the score of the map's own echoes.
    weights: Vec<f64>,
    echoes: u64,
    pings: u64,
}

impl MapMaker {
    /// Creates a map without any ping.
    pub(crate) fn new() -> Self {
        Self { grid: EvidenceGrid::new(), weights: vec![0.0; CELLS * CELLS], echoes: 0, pings: 0 }
    }

    /// Adds a ping to the map.
    pub(crate) fn take(&mut self, ping: &GridPing) {
        self.pings = self.pings.saturating_add(1);
        self.grid.take(ping);
        let Some(Echo { at, before }) = Echo::of(ping) else { return };
        self.echoes = self.echoes.saturating_add(1);
        for ((x, y), weight) in [(at, 1.0), (before, -BEFORE_WEIGHT)] {
            if let Some(sum) = cell_at(x, y).and_then(|cell| self.weights.get_mut(cell)) {
                *sum += weight;
            }
        }
    }

    /// Returns the number of pings that have been added.
    pub(crate) const fn pings(&self) -> u64 {
        self.pings
    }

    /// Returns the number of cells that a ping has changed.
    pub(crate) fn cells(&self) -> usize {
        self.grid.odds().filter(|odds| *odds != 0.0).count()
    }

    /// Returns the map.
    pub(crate) fn map(&self) -> SavedMap {
        let sum: f64 = self.grid.odds().zip(&self.weights).map(|(odds, weight)| odds * weight).sum();
        let own_score = (self.echoes > 0).then(|| sum / self.echoes as f64);
        SavedMap::of(self.grid.clone(), own_score)
    }
}

#[cfg(test)]
mod tests {
    use mdle_runtime::Pose;

    use super::super::matching::fit;
    use super::*;

    #[test]
    fn its_score_is_that_of_a_fit_where_it_was_made() {
        let mut maker = MapMaker::new();
        assert_eq!((maker.cells(), maker.map().least.to_bits()), (0, 1.7_f64.to_bits()));
        let range = |number: u32| (!number.is_multiple_of(7)).then(|| 1.0 + 0.01 * f64::from(number));
        let pings: Vec<GridPing> = (0..72)
            .map(|number| GridPing { x: 0.1, y: -0.2, theta: f64::from(number) * 0.0873, range: range(number) })
            .collect();
        pings.iter().for_each(|ping| maker.take(ping));
        assert_eq!(maker.pings(), 72);
        assert!(maker.cells() > 1000, "{}", maker.cells());
        let map = maker.map();
        let best = fit(&map.grid, &pings, Pose::ORIGIN, 1).unwrap().score;
        let own = map.least / 0.7;
        assert!(own <= best + 0.01 && own > 0.8 * best, "{own} and {best}");
    }
}
