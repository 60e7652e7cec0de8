//! Collects the changes of plans between two turns, in the form in which a record stores them.

use std::collections::BTreeMap;

use mdle_record::RecordedChange;

use super::event::When;

/// The changes of plans since the last turn.
#[derive(Debug, Default)]
pub(crate) struct PlanChanges {
    /// Maps a hash of a plan's files to their number in the record. Only hashes are kept, because a run may have any
    /// number of plans.
    files: BTreeMap<[u8; 32], u32>,
    changes: Vec<RecordedChange>,
}

impl PlanChanges {
    /// Records that the plan `plan`, which is in these files, is armed to take over at the moment `when`. Files that
    /// the record already contains are not recorded again.
    pub(crate) fn armed(&mut self, files: &[(String, String)], plan: &str, when: When) {
        let next = u32::try_from(self.files.len()).unwrap_or(u32::MAX);
        let number = *self.files.entry(hash(files)).or_insert_with(|| {
            self.changes.push(RecordedChange::Files(files.to_vec()));
            next
        });
        self.changes.push(RecordedChange::Armed { files: number, plan: plan.to_owned(), when: when.number() });
    }

    /// Records any other change.
    pub(crate) fn note(&mut self, change: RecordedChange) {
        self.changes.push(change);
    }

    /// Removes and returns the changes since the last call.
    pub(crate) fn take(&mut self) -> Vec<RecordedChange> {
        std::mem::take(&mut self.changes)
    }
}

/// Returns the hash of the names and texts of files.
fn hash(files: &[(String, String)]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for text in files.iter().flat_map(|(name, text)| [name, text]) {
        // The length separates the text from the next text.
        hasher.update(&u64::try_from(text.len()).unwrap_or(u64::MAX).to_le_bytes());
        hasher.update(text.as_bytes());
    }
    *hasher.finalize().as_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_has_each_text_once() {
        let files = |name: &str, text: &str| vec![(name.to_owned(), text.to_owned())];
        let mut changes = PlanChanges::default();
        let plans = [files("a", "bc"), files("ab", "c"), files("a", "bc"), files("a", ""), files("ab", "c")];
        plans.iter().for_each(|files| changes.armed(files, "P", When::Now));
        let changes = changes.take();
        let numbers = changes
            .iter()
            .filter_map(|change| if let RecordedChange::Armed { files, .. } = change { Some(*files) } else { None });
        assert_eq!(numbers.collect::<Vec<_>>(), [0, 1, 0, 2, 1]);
        let texts: Vec<_> =
            changes.iter().filter(|change| matches!(change, RecordedChange::Files(_))).cloned().collect();
        assert_eq!(texts, [0, 1, 3].map(|place: usize| RecordedChange::Files(plans[place].clone())));
    }
}
