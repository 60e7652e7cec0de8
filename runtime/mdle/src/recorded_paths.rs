//! Paths that a run has recorded. In a replay, they replace the paths with which the run began.

use mdle_runtime::{PathStore, Sensed, Setpoint, StoredPath};

/// The paths that have been recorded so far. They stay in memory until the program ends, as all paths of a run do.
#[derive(Debug, Default)]
pub(crate) struct RecordedPaths {
    recorded: Vec<StoredPath>,
    /// All paths of the robot, including the recorded ones; `None` after a recording, until the paths are needed.
    store: Option<PathStore>,
}

impl RecordedPaths {
    /// Replaces the path called `name`.
    pub(crate) fn replace(&mut self, name: String, setpoints: Vec<Setpoint>) {
        self.store = None;
        let setpoints = setpoints.leak();
        match self.recorded.iter_mut().find(|path| path.name == name) {
            Some(path) => path.setpoints = setpoints,
            None => self.recorded.push(StoredPath { name: name.leak(), setpoints }),
        }
    }

    /// Replaces the paths in an output with recorded paths that have the same names.
    pub(crate) fn complete(&mut self, y: &mut Sensed) {
        if self.recorded.is_empty() {
            return;
        }
        let Self { recorded, store } = self;
        y.paths = *store.get_or_insert_with(|| {
            let others = y.paths.names().filter(|name| recorded.iter().all(|path| path.name != *name));
            let others = others.map(|name| StoredPath { name, setpoints: y.paths.path(name).unwrap_or_default() });
            let mut paths: Vec<_> = others.chain(recorded.iter().copied()).collect();
            paths.sort_by_key(|path| path.name);
            PathStore::new(paths.leak())
        });
    }
}
