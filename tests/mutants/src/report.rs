//! Results of the mutants, counted by file and by the test that caught them.

use std::collections::BTreeMap;
use std::fmt;

use crate::equivalent::Equivalent;
use crate::mutant::Mutant;
use crate::trial::{self, Outcome};

/// Counts of mutants, and complaints about survivors and wrong entries of `equivalent.toml`.
#[derive(Debug, Default)]
pub(crate) struct Report {
    files: BTreeMap<String, Counts>,
    tests: BTreeMap<usize, usize>,
    complaints: Vec<String>,
}

/// Counts of the mutants of a file.
#[derive(Debug, Default)]
struct Counts {
    not_compiled: usize,
    caught: usize,
    hanging: usize,
    equivalent: usize,
    survived: usize,
}

impl Report {
    /// Counts a mutant; `listed` is `true` if `equivalent.toml` lists it.
    pub(crate) fn add(&mut self, mutant: &Mutant, outcome: Outcome, listed: bool) {
        let counts = self.files.entry(mutant.file.clone()).or_default();
        match outcome {
            Outcome::DoesNotCompile => counts.not_compiled += 1,
            Outcome::Caught(_) => counts.caught += 1,
            Outcome::Hangs(_) => counts.hanging += 1,
            Outcome::Survived if listed => counts.equivalent += 1,
            Outcome::Survived => counts.survived += 1,
        }
        if let Outcome::Caught(test) | Outcome::Hangs(test) = outcome {
            *self.tests.entry(test).or_default() += 1;
        }
        match (outcome, listed) {
            (Outcome::Survived, false) => self.complaints.push(format!("survived: {mutant}")),
            (Outcome::Survived, true) | (_, false) => {}
            (_, true) => self.complaints.push(format!("listed in equivalent.toml, but {}: {mutant}", verdict(outcome))),
        }
    }

    /// Returns the number of mutants that could be tested.
    pub(crate) fn compiled(&self) -> usize {
        self.files.values().map(|counts| counts.caught + counts.hanging + counts.equivalent + counts.survived).sum()
    }

    /// Returns `true` if each mutant was caught, or survived and is listed in `equivalent.toml`.
    pub(crate) fn is_good(&self) -> bool {
        self.complaints.is_empty()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "\ncaught, hanging (caught as well), equivalent, survived; not compiled (not counted)")?;
        for (file, Counts { not_compiled, caught, hanging, equivalent, survived }) in &self.files {
            writeln!(f, "{caught:4} {hanging:4} {equivalent:4} {survived:4}; {not_compiled:4}  {file}")?;
        }
        for (test, count) in &self.tests {
            writeln!(f, "{count:4} by {}", trial::name(*test))?;
        }
        for complaint in &self.complaints {
            writeln!(f, "{complaint}")?;
        }
        let verdict = if self.is_good() { "none survived without a reason" } else { "NOT ALL WELL" };
        write!(f, "{} mutants: {verdict}", self.compiled())
    }
}

/// Returns the description of an outcome in a report.
pub(crate) fn verdict(outcome: Outcome) -> String {
    match outcome {
        Outcome::DoesNotCompile => "does not compile".to_owned(),
        Outcome::Caught(test) => format!("caught by {}", trial::name(test)),
        Outcome::Hangs(test) => format!("caught, as it does not end, by {}", trial::name(test)),
        Outcome::Survived => "SURVIVED".to_owned(),
    }
}

/// Returns the text of an entry in the form in which mutants are printed.
pub(crate) fn name(entry: &Equivalent) -> String {
    format!("{} {}: {}", entry.file, entry.function, entry.change)
}
