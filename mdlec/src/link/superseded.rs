//! Removes the packages of earlier versions of a plan file from the cache. The name of a package depends on the plan's
//! text, so each edit would otherwise leave behind a package with an executable of some megabytes.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::cache::{remove, write_if_changed};
use super::hash::hash;
use super::machine::BuildMachine;
use super::plan_package::PlanPackage;
use super::{Cache, LinkError};

/// Name of a file in a package's folder. It contains a hash of the plan file's path and, if the package is not for this
/// machine, of the target triple.
const OWNER: &str = "owner";

/// Records that `plan_file` was last built for `machine` as `package`, and removes the packages of its earlier
/// builds for that machine.
pub(super) fn remove_before(
    cache: &Cache,
    plan_file: &Path,
    machine: &BuildMachine,
    package: &PlanPackage,
) -> Result<(), LinkError> {
    let file = plan_file.canonicalize().unwrap_or_else(|_| plan_file.to_owned());
    let foreign = machine.foreign().unwrap_or_default().as_bytes();
    let owner = hash(&[file.as_os_str().as_encoded_bytes(), foreign].concat());
    write_if_changed(&package.folder.join(OWNER), owner.as_bytes())?;
    for folder in entries(&cache.plans())? {
        let is_before = || fs::read(folder.join(OWNER)).is_ok_and(|before| before == owner.as_bytes());
        if folder != package.folder && is_before() {
            remove_results(cache, folder.file_name().unwrap_or_default())?;
            remove(&folder)?;
        }
    }
    Ok(())
}

/// Removes cargo's results for the package `name`: the executable, under both of its names, and its fingerprints.
fn remove_results(cache: &Cache, name: &OsStr) -> Result<(), LinkError> {
    let Some(name) = name.to_str() else { return Ok(()) };
    let names = [name.to_owned(), name.replace('-', "_")];
    for triple in entries(&cache.target())? {
        for folder in ["release", "release/deps", "release/.fingerprint"] {
            for result in entries(&triple.join(folder))? {
                let found = result.file_name().and_then(OsStr::to_str).unwrap_or_default();
                if names.iter().any(|name| found.starts_with(name)) {
                    remove(&result)?;
                }
            }
        }
    }
    Ok(())
}

/// Returns the paths of the entries of a folder; empty if there is no such folder.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, LinkError> {
    let entries = fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    match entries {
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(Vec::new()),
        entries => entries.map_err(|error| LinkError::cache(folder, error)),
    }
}
