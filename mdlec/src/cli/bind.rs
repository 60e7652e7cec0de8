//! `mdlec bind`: generates a target's `src/alphabet.rs` from its `alphabet.mdle`.

use std::path::{Path, PathBuf};

use super::read::{self, LARGEST_PLAN};
use super::{Bind, Failure, input, report};
use crate::link;
use mdle_compiler::alphabet::Alphabet;
use mdle_compiler::rust;

/// Writes `src/alphabet.rs` beside the alphabet, or reports whether it is up to date.
pub(super) fn bind(options: &Bind) -> Result<(), Failure> {
    let file = &options.alphabet;
    let alphabet = input::alphabet(file)?;
    let text = rust::bind(&alphabet);
    let bound = bound(file);
    if read::file(&bound, LARGEST_PLAN).is_ok_and(|found| found == text.as_bytes()) {
        report::note(format_args!("{} is up to date", bound.display()));
        return Ok(());
    }
    if options.check {
        return Err(Failure { status: 1, message: Some(out_of_date(file)) });
    }
    link::write_whole(&bound, text.as_bytes(), std::slice::from_ref(file))
        .map_err(|error| Failure { status: error.exit_status(), message: Some(error.to_string()) })?;
    report::note(format_args!("{} is written", bound.display()));
    Ok(())
}

/// Fails with exit status 2 if the crate of the target in `folder` is not bound to this alphabet: nothing can be built
/// for it.
pub(super) fn must_be_bound(folder: &Path, alphabet: &Alphabet) -> Result<(), Failure> {
    let file = folder.join("alphabet.mdle");
    let is_up_to_date =
        read::file(&bound(&file), LARGEST_PLAN).is_ok_and(|found| found == rust::bind(alphabet).as_bytes());
    if is_up_to_date { Ok(()) } else { Err(Failure::usage(out_of_date(&file))) }
}

/// Path of the Rust file generated from an alphabet.
fn bound(file: &Path) -> PathBuf {
    file.with_file_name("src").join("alphabet.rs")
}

fn out_of_date(file: &Path) -> String {
    let (rust, file) = (bound(file), file.display());
    let bound = rust.display();
    if !rust.is_file() {
        return format!("there is no `{bound}`\nhelp: `mdlec bind {file}` writes it");
    }
    format!("`{bound}` is not what `{file}` says\nhelp: `mdlec bind {file}` writes it anew")
}
