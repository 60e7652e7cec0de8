//! The stored plans, which are compiled and can be started by name.

use std::collections::BTreeMap;
use std::sync::Arc;

use mdle_compiler::load::Loaded;

use super::EngineAlphabet;

/// Maximum number of stored plans.
pub const MOST_STORED: usize = 64;

/// A compiled plan.
pub struct StoredPlan<A: EngineAlphabet> {
    /// Name of the plan.
    pub name: Arc<str>,
    /// Name and text of each file of the plan, the plan's own file first.
    pub files: Arc<[(String, String)]>,
    /// The plan as loaded, before it begins.
    pub loaded: Arc<Loaded<A>>,
    /// Facts about the plan, for the operator.
    pub facts: PlanFacts,
}

/// Texts with facts about a plan, for the operator. The text of an unknown fact is empty.
#[derive(Debug, Clone, Default)]
pub struct PlanFacts {
    /// Warnings about the plan's file; if there are no warnings, a sentence that says so.
    pub diagnostics: Arc<str>,
    /// Results of the static analysis, as `mdlec analyze` prints them.
    pub analysis: Arc<str>,
}

impl<A: EngineAlphabet> Clone for StoredPlan<A> {
    fn clone(&self) -> Self {
        let Self { name, files, loaded, facts } = self;
        Self { name: Arc::clone(name), files: Arc::clone(files), loaded: Arc::clone(loaded), facts: facts.clone() }
    }
}

impl<A: EngineAlphabet> StoredPlan<A> {
    /// Returns the text of the plan's own file.
    #[must_use]
    pub fn text(&self) -> &str {
        self.files.first().map_or("", |(_, text)| text)
    }
}

/// Stored plans by name.
pub(crate) struct Store<A: EngineAlphabet>(BTreeMap<Arc<str>, StoredPlan<A>>);

impl<A: EngineAlphabet> Default for Store<A> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<A: EngineAlphabet> Store<A> {
    /// Stores plans; returns the earlier plans that were replaced.
    ///
    /// # Errors
    /// Returns the given plans, without any change, if more than [`MOST_STORED`] plans would be stored.
    pub(crate) fn put(&mut self, plans: Vec<StoredPlan<A>>) -> Result<Vec<StoredPlan<A>>, Vec<StoredPlan<A>>> {
        let new = plans.iter().filter(|plan| !self.0.contains_key(&plan.name)).count();
        if self.0.len().saturating_add(new) > MOST_STORED {
            return Err(plans);
        }
        Ok(plans.into_iter().filter_map(|plan| self.0.insert(Arc::clone(&plan.name), plan)).collect())
    }

    pub(crate) fn get(&self, name: &str) -> Option<&StoredPlan<A>> {
        self.0.get(name)
    }

    pub(crate) fn remove(&mut self, name: &str) -> Option<StoredPlan<A>> {
        self.0.remove(name)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &StoredPlan<A>> {
        self.0.values()
    }
}
