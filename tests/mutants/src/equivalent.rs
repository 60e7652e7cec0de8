//! The list `equivalent.toml` of equivalent mutants, which do not change the behavior of the code, each with the
//! reason.

use serde::Deserialize;

use crate::mutant::Mutant;

/// Text of the list, included at build time.
const LIST: &str = include_str!("../equivalent.toml");

/// Content of the list.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Equivalents {
    #[serde(default)]
    equivalent: Vec<Equivalent>,
}

/// A mutant, identified by its file, its function and its change, with the reason why no test can find it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Equivalent {
    pub(crate) file: String,
    pub(crate) function: String,
    pub(crate) change: String,
    pub(crate) reason: String,
}

impl Equivalents {
    /// Reads the list.
    pub(crate) fn read() -> Self {
        toml::from_str(LIST).expect("tests/mutants/equivalent.toml is as its head says")
    }

    /// Returns the entry of this mutant, or `None` if the mutant is not in the list.
    pub(crate) fn find(&self, mutant: &Mutant) -> Option<&Equivalent> {
        self.equivalent.iter().find(|entry| entry.is(mutant))
    }

    /// Returns the entries that match no mutant any more, and the entries without a reason.
    pub(crate) fn stale<'e>(&'e self, mutants: &'e [Mutant]) -> impl Iterator<Item = &'e Equivalent> {
        let is_stale = |entry: &&Equivalent| entry.reason.is_empty() || !mutants.iter().any(|mutant| entry.is(mutant));
        self.equivalent.iter().filter(is_stale)
    }
}

impl Equivalent {
    fn is(&self, mutant: &Mutant) -> bool {
        (&self.file, &self.function, &self.change) == (&mutant.file, &mutant.function, &mutant.change)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice;

    #[test]
    fn every_entry_names_a_mutant() {
        let (sources, equivalents) = (choice::sources(), Equivalents::read());
        let mutants = choice::all(&sources);
        assert!(mutants.len() > equivalents.equivalent.len(), "no mutants are found");
        let stale: Vec<_> = equivalents.stale(&mutants).collect();
        assert!(stale.is_empty(), "equivalent.toml has entries without a mutant or a reason: {stale:#?}");
    }
}
