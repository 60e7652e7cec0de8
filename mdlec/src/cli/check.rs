//! `mdlec check`: diagnostics only.

use std::path::{Path, PathBuf};

use super::everywhere::{ALL, everywhere};
use super::{Check, Failure, input, report};
use crate::diagnostic::has_errors;

/// Checks each plan file and says what is wrong with it.
pub(super) fn check(options: &Check) -> Result<(), Failure> {
    if options.target.as_deref() == Some(ALL) {
        return everywhere(options);
    }
    let target = input::target(options.target.as_deref())?;
    each(&options.plans, |path| {
        let mut input = input::read_plan(path, &target)?;
        let found = input.check(&target.alphabet);
        let good = report::diagnostics(&input.sources, &found, options.deny_warnings);
        if good && !has_errors(&found) { Ok(()) } else { Err(Failure::PLAN) }
    })
}

/// Does this to every file, whatever comes of those before it; the worst of that is the exit status.
pub(super) fn each(paths: &[PathBuf], mut done: impl FnMut(&Path) -> Result<(), Failure>) -> Result<(), Failure> {
    let mut failed = None;
    for failure in paths.iter().filter_map(|path| done(path).err()) {
        if let Some(message) = &failure.message {
            report::error(message);
        }
        failed = failed.max(Some(failure.status));
    }
    failed.map_or(Ok(()), |status| Err(Failure { status, message: None }))
}
