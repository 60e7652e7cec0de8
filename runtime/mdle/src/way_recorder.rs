//! The recorder of a robot. It replaces a path of the plan with the way back along the path that the robot has driven
//! under `path` and `Follow`.

use mdle_engine::Recorder;
use mdle_host::setpoints;
use mdle_runtime::{Frame, PathStore, Pose, Sensed, StoredPath, Twist};

use crate::way_back::DrivenPath;

/// Maximum number of setpoints in all paths that a robot records. The limit is needed because setpoints stay in memory
/// until the program ends.
const SETPOINTS: usize = 2_000_000;

/// The recorder of a robot.
pub(crate) struct WayRecorder {
    /// Name of the path that the recorder replaces.
    path: &'static str,
    /// Maximum speeds of a replayed path.
    fastest: Twist,
    /// The path that the robot has driven under the current law; `None` if this law is not recorded.
    way: Option<DrivenPath>,
    /// Frame of the plan; `None` before the first turn.
    frame: Option<Frame>,
    /// The robot's paths after the first recording; `None` before the first recording.
    store: Option<PathStore>,
    /// The newly recorded path; `None` once [`Recorder::take_replaced`] has taken it.
    replaced: Option<StoredPath>,
    /// Number of setpoints that have been recorded so far.
    recorded: usize,
}

/// Data of a turn that the recorder needs.
pub(crate) struct WayTurn<'t> {
    /// Pose by odometry.
    pub(crate) here: &'t Pose,
    /// The robot's paths.
    pub(crate) paths: PathStore,
    /// Text of the law that runs after the turn; `None` if no law runs.
    pub(crate) law: Option<&'t str>,
    /// `true` if the plan made transitions.
    pub(crate) has_changed: bool,
}

impl WayRecorder {
    /// Creates a recorder that replaces the path `path`, on a robot with the maximum speeds `fastest`.
    pub(crate) fn new(path: &'static str, fastest: Twist) -> Self {
        Self { path, fastest, way: None, frame: None, store: None, replaced: None, recorded: 0 }
    }

    /// Returns the name of the path that the recorder replaces.
    pub(crate) fn path(&self) -> &'static str {
        self.path
    }

    /// Returns the robot's paths; `None` before the first recording.
    pub(crate) fn store(&self) -> Option<PathStore> {
        self.store
    }

    /// Processes a turn. If a recorded law has ended, replaces the path with the way back, and returns the text of the
    /// way back.
    ///
    /// # Errors
    /// Fails with a message if the way back is not a valid path.
    pub(crate) fn take(&mut self, turn: &WayTurn<'_>) -> Result<Option<String>, String> {
        let WayTurn { here, paths, law, has_changed } = turn;
        let frame = *self.frame.get_or_insert(Frame(here.theta));
        let is_recorded = law.is_some_and(|law| ["path ", "Follow "].iter().any(|name| law.starts_with(name)));
        let ended = if *has_changed { self.way.take() } else { None };
        if is_recorded {
            self.way.get_or_insert_default().went(here);
        }
        let Some(mut way) = ended else { return Ok(None) };
        way.went(here);
        let Some(text) = way.back(frame.0) else { return Ok(None) };
        let replaced = self.replace(*paths, &text);
        replaced.map_err(|sentence| format!("the way back is not recorded: {sentence}"))?;
        Ok(Some(text))
    }

    /// Replaces the path with the path in `text`.
    fn replace(&mut self, paths: PathStore, text: &str) -> Result<(), String> {
        let setpoints = setpoints(self.path, text.as_bytes(), self.fastest)?;
        self.recorded = self.recorded.saturating_add(setpoints.len());
        if self.recorded > SETPOINTS {
            return Err(format!("the robot has recorded more than {SETPOINTS} rows, which is the most"));
        }
        let others = paths.names().filter(|name| *name != self.path);
        let others = others.map(|name| StoredPath { name, setpoints: paths.path(name).unwrap_or_default() });
        let mut stored: Vec<_> = others.collect();
        let replaced = StoredPath { name: self.path, setpoints: setpoints.leak() };
        self.replaced = Some(replaced);
        stored.push(replaced);
        stored.sort_by_key(|path| path.name);
        self.store = Some(PathStore::new(stored.leak()));
        Ok(())
    }
}

impl Recorder<Sensed> for WayRecorder {
    fn complete(&self, y: &mut Sensed) {
        y.paths = self.store.unwrap_or(y.paths);
    }

    fn take_replaced(&mut self) -> Option<StoredPath> {
        self.replaced.take()
    }

    fn turn(&mut self, y: &Sensed, law: Option<&str>, has_changed: bool) -> Option<String> {
        let turn = WayTurn { here: &y.odometry, paths: y.paths, law, has_changed };
        self.take(&turn).err().map(|sentence| format!("warning: {sentence}"))
    }
}
