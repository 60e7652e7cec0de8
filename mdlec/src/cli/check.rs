//! `mdlec check`: prints the diagnostics of plans, and the errors of scenarios.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use super::each::each;
use super::everywhere::{ALL, everywhere};
use super::{CheckArguments, CommandFailure, report, scenario};
use crate::link;
use mdle_compiler::diagnostic::has_errors;
use mdle_files::{Settings, Target, file_beside};

/// Checks each plan file and prints its diagnostics.
pub(super) fn check(options: &CheckArguments) -> Result<(), CommandFailure> {
    let mut scenarios = options.plans.iter().filter(|path| scenario::is_scenario(path));
    scenarios.try_for_each(|path| {
        let robot = Settings::beside(path)?.name_of_target(options.target.as_deref());
        scenario::must_be_simulated(path, robot.as_deref().unwrap_or(scenario::SIM))
    })?;
    if options.target.as_deref() == Some(ALL) {
        return everywhere(options);
    }
    let named = options.target.as_deref().map(|name| mdle_files::target(Some(name))).transpose()?;
    // Without `--target`, each folder can have a different target.
    let mut beside = BTreeMap::new();
    each(&options.plans, |path| {
        if scenario::is_scenario(path) {
            return scenario::check(path, options.deny_warnings);
        }
        let target = match (&named, beside.entry(file_beside(path))) {
            (Some(named), _) => named,
            (None, Entry::Occupied(known)) => known.into_mut(),
            (None, Entry::Vacant(unknown)) => unknown.insert(checked_target(path)?),
        };
        let mut input = mdle_files::read_plan(path, target)?;
        let found = input.check(&target.alphabet);
        let good = report::diagnostics(&input.sources, &found, options.deny_warnings);
        if good && !has_errors(&found) { Ok(()) } else { Err(CommandFailure::PLAN) }
    })
}

/// Returns the target that the `mdle.toml` beside the file `plan` names. Checks the options that a run would take from
/// this `mdle.toml`.
fn checked_target(plan: &Path) -> Result<Target, CommandFailure> {
    let settings = Settings::beside(plan)?;
    let target = settings.target(None)?;
    settings.run_options(None, &[], link::known)?;
    Ok(target)
}
