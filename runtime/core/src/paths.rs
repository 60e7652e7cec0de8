//! Paths that a robot can drive: headings and forward speeds over time, and a store that holds them by name.

use crate::{MetersPerSecond, Nanos, Radians};

/// Setpoint of a path: the heading and the forward speed at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setpoint {
    /// Time since the path began.
    pub at: Nanos,
    /// Heading in the frame of the atom that replays the path; between -π and π.
    pub heading: Radians,
    /// Forward speed.
    pub speed: MetersPerSecond,
}

/// A path, with the name that plans use for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StoredPath {
    /// Name of the path, which the plan gives after `path`.
    pub name: &'static str,
    /// Setpoints of the path: the first at time 0, each later than its predecessor.
    pub setpoints: &'static [Setpoint],
}

/// The paths that a plan can replay. They are loaded before the robot moves and stay in memory until the program ends,
/// so an output can refer to all paths and still be copied in every turn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PathStore(&'static [StoredPath]);

impl PathStore {
    /// A store without paths.
    pub const EMPTY: Self = Self(&[]);

    /// Creates a store of these paths, which must be sorted by name.
    #[must_use]
    pub const fn new(paths: &'static [StoredPath]) -> Self {
        Self(paths)
    }

    /// Returns the setpoints of the path `name`; `None` if no path has this name.
    #[must_use]
    pub fn path(&self, name: &str) -> Option<&'static [Setpoint]> {
        let place = self.0.binary_search_by(|path| path.name.cmp(name)).ok()?;
        self.0.get(place).map(|path| path.setpoints)
    }

    /// Returns the names of the paths, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|path| path.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_found_by_its_whole_name() {
        static HALL: [Setpoint; 1] = [Setpoint { at: Nanos::ZERO, heading: Radians(1.0), speed: MetersPerSecond(0.2) }];
        static PATHS: [StoredPath; 2] =
            [StoredPath { name: "empty", setpoints: &[] }, StoredPath { name: "hall", setpoints: &HALL }];
        let store = PathStore::new(&PATHS);
        assert_eq!(
            ["hall", "empty", "hal", "Hall", ""].map(|name| store.path(name).map(<[Setpoint]>::len)),
            [Some(1), Some(0), None, None, None]
        );
        assert_eq!(PathStore::EMPTY.path("hall"), None);
        assert!(store.names().eq(["empty", "hall"]));
    }
}
