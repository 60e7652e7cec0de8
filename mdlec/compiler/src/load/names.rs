//! Stores the names that occur in loaded plans until the process ends.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use mdle_runtime::{ModuleRead, PUBLISHED};

use super::LoadError;
use crate::fsm::AttributeRead;

/// Maximum total length, in bytes, of all names in the plans that a process loads.
///
/// The names of a quark are never freed, so the memory of a process grows with each loaded plan that has new
/// names.
pub const MOST_NAMES: usize = 1_000_000;

/// The names that this process has stored.
static NAMES: Mutex<KeptNames> = Mutex::new(KeptNames { kept: BTreeSet::new(), bytes: 0 });

/// Number of bytes that the plans from one source may still use for new names. With a separate budget, another robot's
/// plans cannot use up the names that the operator's plans need.
#[derive(Debug)]
pub struct NameBudget(Cell<usize>);

impl NameBudget {
    /// Creates a budget of this number of bytes.
    #[must_use]
    pub fn new(bytes: usize) -> Self {
        Self(Cell::new(bytes))
    }

    fn spend(&self, bytes: usize) -> Result<(), LoadError> {
        self.0.set(self.0.get().checked_sub(bytes).ok_or(LoadError::OverBudget)?);
        Ok(())
    }
}

/// Returns a copy of the name; the copy is never freed. Equal names are stored only once.
///
/// # Errors
/// Fails if there are too many names.
pub(super) fn interned(name: &str, budget: &NameBudget) -> Result<&'static str, LoadError> {
    NAMES.lock().unwrap_or_else(PoisonError::into_inner).keep(name, budget)
}

/// Returns these module attributes as a list that is never freed. Equal lists are stored only once.
///
/// # Errors
/// Fails if there are too many names, or too many attributes for one plan.
pub(super) fn reads(
    reads: BTreeSet<AttributeRead<'_>>,
    budget: &NameBudget,
) -> Result<&'static [ModuleRead], LoadError> {
    static LISTS: Mutex<BTreeSet<&'static [ModuleRead]>> = Mutex::new(BTreeSet::new());
    if reads.len() > PUBLISHED {
        return Err(LoadError::TooManyReads(reads.len()));
    }
    let interned = reads.into_iter().map(|AttributeRead { module, attribute, unit }| {
        Ok(ModuleRead { module: interned(module, budget)?, attribute: interned(attribute, budget)?, unit })
    });
    let list: Vec<_> = interned.collect::<Result<_, _>>()?;
    let mut lists = LISTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = lists.get(&*list) {
        return Ok(known);
    }
    // The names in a new list are counted again, so that the number of lists is limited as well.
    let bytes = list.iter().map(|read| read.module.len() + read.attribute.len()).sum();
    NAMES.lock().unwrap_or_else(PoisonError::into_inner).count(bytes, budget)?;
    let list: &'static [ModuleRead] = list.leak();
    lists.insert(list);
    Ok(list)
}

/// The names that have been stored so far, and their total number of bytes.
struct KeptNames {
    kept: BTreeSet<&'static str>,
    bytes: usize,
}

impl KeptNames {
    fn keep(&mut self, name: &str, budget: &NameBudget) -> Result<&'static str, LoadError> {
        if let Some(known) = self.kept.get(name) {
            return Ok(known);
        }
        self.count(name.len(), budget)?;
        let kept: &'static str = Box::leak(name.into());
        self.kept.insert(kept);
        Ok(kept)
    }

    /// Adds `more` to the number of stored bytes. Fails if the maximum or the budget would be exceeded.
    fn count(&mut self, more: usize, budget: &NameBudget) -> Result<(), LoadError> {
        let bytes = self.bytes.saturating_add(more);
        if bytes > MOST_NAMES {
            return Err(LoadError::TooManyNames);
        }
        budget.spend(more)?;
        self.bytes = bytes;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_once_and_names_have_a_limit() {
        let mut names = KeptNames { kept: BTreeSet::new(), bytes: 0 };
        let budget = NameBudget::new(usize::MAX);
        let mut keep = |name: &str| names.keep(name, &budget);
        let long = "a".repeat(MOST_NAMES - 4);
        let first = keep(&long).unwrap();
        assert!(std::ptr::eq(first, keep(&long).unwrap()));
        assert_eq!((keep("hall"), keep("x")), (Ok("hall"), Err(LoadError::TooManyNames)));
        assert_eq!(keep("hall"), Ok("hall"), "a name that is known is no new one");
    }

    #[test]
    fn a_budget_leaves_the_other_names_alone() {
        let mut names = KeptNames { kept: BTreeSet::new(), bytes: 0 };
        let (small, large) = (NameBudget::new(6), NameBudget::new(100));
        assert_eq!(names.keep("hall", &small), Ok("hall"));
        assert_eq!((names.keep("door", &small), names.bytes), (Err(LoadError::OverBudget), 4));
        assert_eq!((names.keep("hall", &small), names.keep("up", &small)), (Ok("hall"), Ok("up")));
        assert_eq!((names.keep("door", &large), names.keep("door", &small)), (Ok("door"), Ok("door")));
    }
}
