//! Processes several files, and continues after a file that fails.

use std::path::{Path, PathBuf};

use super::CommandFailure;

/// Calls `done` for every file, and prints each failure. Fails with the highest exit status.
pub(super) fn each(
    paths: &[PathBuf],
    mut done: impl FnMut(&Path) -> Result<(), CommandFailure>,
) -> Result<(), CommandFailure> {
    let mut failed = None;
    for failure in paths.iter().filter_map(|path| done(path).err()) {
        failed = failed.max(Some(failure.print()));
    }
    failed.map_or(Ok(()), |status| Err(CommandFailure::silent(status)))
}
