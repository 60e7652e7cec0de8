//! A compiled plan, loaded for the robot of the playground.

use std::sync::Arc;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm;
use mdle_compiler::load::{self, Loaded, LoadedPlan};
use mdle_simulator::alphabet::Alphabet;

use crate::document::Document;

/// A plan that can begin any number of times.
pub(crate) struct Plan {
    /// The plan as a state machine.
    pub(crate) machine: Arc<fsm::Machine>,
    /// Text of the plan.
    pub(crate) sources: Sources,
    loaded: Arc<Loaded<Alphabet>>,
}

impl Plan {
    /// Compiles and loads a plan.
    ///
    /// # Errors
    /// Messages as `mdlec` prints them.
    pub(crate) fn of(text: &str, name: Option<&str>) -> Result<Self, String> {
        let mut document = Document::of(text)?;
        let machine = Arc::new(document.compile(name, |_| Ok(()))?.machine);
        let loaded = load::load(&machine, &document.sources, document.alphabet).map_err(|error| error.to_string())?;
        let loaded = Arc::new(loaded.looked_at(Arc::clone(&machine)));
        Ok(Self { machine, sources: document.sources, loaded })
    }

    /// Returns the plan before it begins, looked at while it makes turns.
    pub(crate) fn looked_at(&self) -> LoadedPlan<Alphabet> {
        self.loaded.plan()
    }
}
