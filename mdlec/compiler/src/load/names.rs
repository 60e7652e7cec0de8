//! The names in loaded plans, which stay as long as the process does.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use super::LoadError;

/// The most bytes of all names in the plans that a process loads.
///
/// A quark keeps its names for ever, so a process that loads plan after plan with new names needs ever more memory.
pub const MOST_NAMES: usize = 1_000_000;

/// Returns a name that stays; a text is kept once.
///
/// # Errors
/// There are too many names.
pub(super) fn interned(name: &str) -> Result<&'static str, LoadError> {
    static NAMES: Mutex<Names> = Mutex::new(Names { kept: BTreeSet::new(), bytes: 0 });
    NAMES.lock().unwrap_or_else(PoisonError::into_inner).keep(name)
}

/// Names that were kept.
struct Names {
    kept: BTreeSet<&'static str>,
    bytes: usize,
}

impl Names {
    fn keep(&mut self, name: &str) -> Result<&'static str, LoadError> {
        if let Some(known) = self.kept.get(name) {
            return Ok(known);
        }
        let bytes = self.bytes.saturating_add(name.len());
        if bytes > MOST_NAMES {
            return Err(LoadError::TooManyNames);
        }
        self.bytes = bytes;
        let kept: &'static str = Box::leak(name.into());
        self.kept.insert(kept);
        Ok(kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_kept_once_and_names_have_a_limit() {
        let mut names = Names { kept: BTreeSet::new(), bytes: 0 };
        let long = "a".repeat(MOST_NAMES - 4);
        let first = names.keep(&long).unwrap();
        assert!(std::ptr::eq(first, names.keep(&long).unwrap()));
        assert_eq!((names.keep("hall"), names.keep("x")), (Ok("hall"), Err(LoadError::TooManyNames)));
        assert_eq!(names.keep("hall"), Ok("hall"), "a name that is known is no new one");
    }
}
