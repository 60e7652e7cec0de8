//! A compiled plan, loaded for the robot of the playground.

use std::collections::BTreeMap;
use std::sync::Arc;

use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::fsm;
use mdle_compiler::load::{self, Loaded, LoadedPlan};
use mdle_simulator::alphabet::{Alphabet, NAME};

use crate::document::Document;
use crate::draft::PageFiles;

/// A compiled plan, from which any number of runs can start.
pub(crate) struct Plan {
    /// The plan as a state machine.
    pub(crate) machine: Arc<fsm::Machine>,
    /// Texts of the plan's files and of the files of the robot's alphabet, to which the spans in `machine` refer.
    pub(crate) sources: Sources,
    /// Paths of the plan's files, without `.` and `..`.
    pub(crate) files: BTreeMap<SourceId, String>,
    loaded: Arc<Loaded<Alphabet>>,
}

impl Plan {
    /// Compiles and loads a plan for the robot `sim`, regardless of the robot for which its files are written.
    ///
    /// # Errors
    /// Fails with messages as `mdlec` prints them.
    pub(crate) fn of(draft: &PageFiles, name: Option<&str>) -> Result<Self, String> {
        let mut document = Document::for_robot(NAME, draft)?;
        let machine = Arc::new(document.compile(name, |_| Ok(()))?.machine);
        let loaded = load::load(&machine, &document.sources, document.alphabet).map_err(|error| error.to_string())?;
        let loaded = Arc::new(loaded.looked_at(Arc::clone(&machine)));
        let files = document.places();
        Ok(Self { machine, sources: document.sources, files, loaded })
    }

    /// Returns the plan for a new run, which records the moments of its turns.
    pub(crate) fn looked_at(&self) -> LoadedPlan<Alphabet> {
        self.loaded.plan()
    }
}
