//! Represents the folder of a plan's cargo package.

use std::ffi::OsStr;
use std::path::PathBuf;

use super::LinkError;
use super::cache::write_if_changed;

/// A plan's package whose files have been written.
#[derive(Debug)]
pub(super) struct PlanPackage {
    /// Folder of the package; package and executable have the same name.
    pub(super) folder: PathBuf,
    /// Hash of all files that mdlec wrote into the folder.
    pub(super) hash: String,
}

impl PlanPackage {
    /// Returns the name of the package and of its executable.
    pub(super) fn name(&self) -> &OsStr {
        self.folder.file_name().unwrap_or_default()
    }

    /// Returns the path of the package's manifest.
    pub(super) fn manifest(&self) -> PathBuf {
        self.folder.join("Cargo.toml")
    }

    /// Writes the output of a build to a log file for bug reports, and returns the path of the log file.
    pub(super) fn keep(&self, text: &str) -> Result<PathBuf, LinkError> {
        let log = self.folder.join("build.log");
        write_if_changed(&log, text.as_bytes())?;
        Ok(log)
    }
}
