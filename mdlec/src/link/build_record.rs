//! Keeps a record of the last build of a plan, which contains the hashes of its package, its lock file and its
//! executable.
//!
//! Cargo compares only the times of files. Times do not show that a file was truncated or overwritten, and they are
//! wrong after the clock was set back.

use std::fs;
use std::path::{Path, PathBuf};

use super::LinkError;
use super::cache::write_if_changed;
use super::hash::hash;
use super::plan_package::PlanPackage;

/// Records that `executable` was built from `plan` in its present state.
pub(super) fn write(plan: &PlanPackage, executable: &Path) -> Result<(), LinkError> {
    let unreadable = |error| LinkError::cache(executable, error);
    let executable = hash(&fs::read(executable).map_err(unreadable)?);
    let lock = lock(&plan.folder).unwrap_or_default();
    let text = format!("{}\n{lock}\n{executable}\n", plan.hash);
    write_if_changed(&file(&plan.folder), text.as_bytes())?;
    Ok(())
}

/// Returns `true` if `executable` is identical, byte for byte, to the executable that was built from `plan` in
/// its present state.
pub(super) fn fits(plan: &PlanPackage, executable: &Path) -> bool {
    let executable = fs::read(executable).map(|bytes| hash(&bytes));
    let noted = read(&plan.folder);
    executable.is_ok_and(|executable| {
        noted.is_some_and(|[package, _, built]| (package, built) == (plan.hash.clone(), executable))
    })
}

/// Returns `true` if cargo's lock file in the package's `folder` has not changed since it was recorded.
pub(super) fn has_lock(folder: &Path) -> bool {
    read(folder).is_some_and(|[_, noted, _]| lock(folder).is_some_and(|lock| lock == noted))
}

/// Returns the recorded hashes of the package, of its lock file, and of the executable; `None` if there is no valid
/// record.
fn read(folder: &Path) -> Option<[String; 3]> {
    let text = fs::read_to_string(file(folder)).ok()?;
    let lines: Vec<_> = text.lines().map(str::to_owned).collect();
    lines.try_into().ok()
}

fn lock(folder: &Path) -> Option<String> {
    fs::read(folder.join("Cargo.lock")).ok().map(|bytes| hash(&bytes))
}

fn file(folder: &Path) -> PathBuf {
    folder.join("built")
}
