//! The mutants that change nothing, each with the reason: `equivalent.toml`.

use serde::Deserialize;

use crate::mutant::Mutant;

/// The list, as it was when this was built.
const LIST: &str = include_str!("../equivalent.toml");

/// All entries.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Equivalents {
    #[serde(default)]
    equivalent: Vec<Equivalent>,
}

/// A mutant, by its file, its function and its change, and why no test can find it.
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

    /// The entry of this mutant.
    pub(crate) fn find(&self, mutant: &Mutant) -> Option<&Equivalent> {
        self.equivalent.iter().find(|entry| entry.is(mutant))
    }

    /// The entries to which no mutant belongs any more, and those without a reason.
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
