//! Tries mutants, one by one or all together, and reports and counts the results.

use std::time::Instant;

use crate::at_once::{AtOnce, BuildState};
use crate::checkout::Checkout;
use crate::choice::Source;
use crate::equivalent::Equivalents;
use crate::mutant::Mutant;
use crate::report::{self, Report};
use crate::trial::{Outcome, Trials};

/// The source files and the list of equivalent mutants, which all trials need.
pub(crate) struct Judge<'a> {
    pub(crate) sources: &'a [Source],
    pub(crate) equivalents: &'a Equivalents,
}

impl Judge<'_> {
    /// Tries mutants one by one until `count` mutants have compiled.
    pub(crate) fn some(&self, chosen: &[&Mutant], count: usize) -> Report {
        let mut report = Report::default();
        self.apart(&Trials::prepare(Checkout::copy()), chosen, count, &mut report);
        report
    }

    /// Tries all these mutants in a common build. Mutants that cannot be part of it, and mutants that survive in it,
    /// are then tried one by one.
    pub(crate) fn all(&self, chosen: &[&Mutant]) -> Report {
        let mut report = Report::default();
        let at_once = AtOnce::prepare(Checkout::copy(), self.sources, chosen);
        let mut apart = Vec::new();
        for (place, standing, mutant) in at_once.mutants() {
            let start = Instant::now();
            match standing {
                BuildState::Built => match at_once.run(place) {
                    Outcome::Survived => {
                        println!("{mutant}: survived the fast tests [{:.0?}]", start.elapsed());
                        apart.push(mutant);
                    }
                    outcome => self.tried(mutant, outcome, start, &mut report),
                },
                BuildState::DoesNotCompile => self.tried(mutant, Outcome::DoesNotCompile, start, &mut report),
                BuildState::Apart => apart.push(mutant),
            }
        }
        let checkout = at_once.restored(self.sources);
        if !apart.is_empty() {
            self.apart(&Trials::prepare(checkout), &apart, usize::MAX, &mut report);
        }
        report
    }

    fn apart(&self, trials: &Trials, chosen: &[&Mutant], count: usize, report: &mut Report) {
        let before = report.compiled();
        for mutant in chosen {
            if report.compiled() - before == count {
                break;
            }
            let source = self.sources.iter().find(|source| source.file == mutant.file).expect("the mutant's file");
            let start = Instant::now();
            self.tried(mutant, trials.run(mutant, &source.text), start, report);
        }
    }

    /// Counts a mutant, and prints its result.
    fn tried(&self, mutant: &Mutant, outcome: Outcome, start: Instant, report: &mut Report) {
        let equivalent = self.equivalents.find(mutant);
        report.add(mutant, outcome, equivalent.is_some());
        if outcome != Outcome::DoesNotCompile {
            let reason = equivalent.map_or(String::new(), |entry| format!(" (changes nothing: {})", entry.reason));
            println!("{mutant}: {}{reason} [{:.0?}]", report::verdict(outcome), start.elapsed());
        }
    }
}
