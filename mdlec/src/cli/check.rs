//! `mdlec check`: diagnostics only.

use super::{Check, Failure, input, report};
use crate::diagnostic::has_errors;

/// Checks each plan file and says what is wrong with it.
pub(super) fn check(options: &Check) -> Result<(), Failure> {
    let target = input::target(options.target.as_deref())?;
    let mut failed = None;
    for path in &options.plans {
        let checked = input::read_plan(path, &target).and_then(|mut input| {
            let (_, found) = input.compile(&target.alphabet, None);
            let good = report::diagnostics(&input.sources, &found, options.deny_warnings);
            if good && !has_errors(&found) { Ok(()) } else { Err(Failure::PLAN) }
        });
        // Every file is looked at; the worst of what was found is the exit status.
        if let Err(failure) = checked {
            if let Some(message) = &failure.message {
                report::error(message);
            }
            failed = failed.max(Some(failure.status));
        }
    }
    failed.map_or(Ok(()), |status| Err(Failure { status, message: None }))
}
