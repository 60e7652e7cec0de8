//! Changes of plans between turns, as records keep them.

use std::sync::Arc;

use mdle_record::Change;

use super::event::When;

/// The changes of plans since the last turn.
#[derive(Debug, Default)]
pub(crate) struct PlanChanges {
    /// The files of plans that the record contains, by their numbers.
    files: Vec<Arc<[(String, String)]>>,
    changes: Vec<Change>,
}

impl PlanChanges {
    /// Records that a plan of these files is to take over.
    pub(crate) fn armed(&mut self, files: &Arc<[(String, String)]>, plan: &str, when: When) {
        let number = self.files.iter().position(|known| known == files).unwrap_or_else(|| {
            self.changes.push(Change::Files(files.to_vec()));
            self.files.push(Arc::clone(files));
            self.files.len() - 1
        });
        let files = u32::try_from(number).unwrap_or(u32::MAX);
        self.changes.push(Change::Armed { files, plan: plan.to_owned(), when: when.number() });
    }

    /// Records another change.
    pub(crate) fn note(&mut self, change: Change) {
        self.changes.push(change);
    }

    /// Takes the changes since the last call.
    pub(crate) fn take(&mut self) -> Vec<Change> {
        std::mem::take(&mut self.changes)
    }
}
