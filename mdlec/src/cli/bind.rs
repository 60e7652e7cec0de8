//! `mdlec bind`: generates a target's `src/alphabet.rs` from its `alphabet.mdle`.

use super::{Bind, CommandFailure, report};
use crate::link;
use mdle_compiler::rust;
use mdle_files::read::{self, LARGEST_PLAN};
use mdle_files::{bound, out_of_date};

/// Writes `src/alphabet.rs` beside the alphabet or, with `--check`, reports that the file is out of date.
pub(super) fn bind(options: &Bind) -> Result<(), CommandFailure> {
    let file = &options.alphabet;
    let alphabet = mdle_files::alphabet(file)?;
    let text = rust::bind(&alphabet);
    let bound = bound(file);
    if read::file(&bound, LARGEST_PLAN).is_ok_and(|found| found == text.as_bytes()) {
        report::note(format_args!("{} is up to date", bound.display()));
        return Ok(());
    }
    if options.check {
        return Err(CommandFailure::of(1, out_of_date(file)));
    }
    link::write_whole(&bound, text.as_bytes(), std::slice::from_ref(file))?;
    report::note(format_args!("{} is written", bound.display()));
    Ok(())
}
