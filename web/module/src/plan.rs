//! A compiled plan, loaded for the robot of the playground.

use std::sync::Arc;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm;
use mdle_compiler::load::{self, Entered, Examining, Loaded};
use mdle_runtime::{Stamp, Stamps};
use mdle_simulator::alphabet::Alphabet;

use crate::document::Document;

/// A plan that can begin any number of times.
pub(crate) struct Plan {
    /// The plan as a state machine.
    pub(crate) machine: fsm::Machine,
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
        let machine = document.compile(name, |_| Ok(()))?.machine;
        let loaded = load::load(&machine, &document.sources, document.alphabet).map_err(|error| error.to_string())?;
        Ok(Self { machine, sources: document.sources, loaded: Arc::new(loaded) })
    }

    /// Returns the plan before it begins, with the time of entry of each level of scopes.
    pub(crate) fn examining(&self) -> Examining<Alphabet> {
        let stamps = vec![Stamp::START; self.machine.depth()].into();
        let entered = Entered::Stamps(Stamps::new(stamps, self.machine.frames().into()));
        Examining::new(self.loaded.plan(), entered, Vec::new())
    }
}
