//! The facts that records can contain (docs/src/reference/semantics.md, 2.3).

use std::collections::BTreeSet;

use crate::plan::RecordId;

/// The facts of records that may become true in some run.
#[derive(Debug, Clone)]
pub(super) enum PossibleFacts {
    /// Only these facts may become true. Each consists of its record and its number in the record.
    Only(BTreeSet<(RecordId, u32)>),
    /// Any fact may become true, because the question was too large to decide.
    Any,
}

impl PossibleFacts {
    /// Returns `true` if the fact may become true.
    pub(super) fn has(&self, record: RecordId, fact: u32) -> bool {
        match self {
            Self::Only(facts) => facts.contains(&(record, fact)),
            Self::Any => true,
        }
    }
}
