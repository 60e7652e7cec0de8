//! The folder that mdlec keeps between runs: unpacked sources, compiled libraries, the packages of plans.
//!
//! It is `mdlec` in the user's cache folder unless `MDLEC_CACHE` names another; it may be deleted at any time.

use std::env;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;

use super::{LinkError, Progress};

/// The folder that mdlec keeps between runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// The user's: what `MDLEC_CACHE` names, else `mdlec` in the user's cache folder.
    ///
    /// # Errors
    /// When neither the variable nor a home folder is there, or the folder cannot be made.
    pub fn of_user() -> Result<Self, LinkError> {
        match env::var_os("MDLEC_CACHE").filter(|folder| !folder.is_empty()) {
            Some(folder) => Self::at(Path::new(&folder)),
            None => {
                let folders = etcetera::choose_base_strategy().map_err(|_| LinkError::NoCacheFolder)?;
                Self::at(&folders.cache_dir().join("mdlec"))
            }
        }
    }

    /// The one in `folder`, which is made if need be.
    ///
    /// # Errors
    /// When `folder` cannot be made.
    pub fn at(folder: &Path) -> Result<Self, LinkError> {
        // Cargo shows paths without symbolic links; ours are compared with them.
        let found = fs::create_dir_all(folder).and_then(|()| folder.canonicalize());
        Ok(Self { folder: found.map_err(|error| LinkError::cache(folder, error))? })
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Waits until no other mdlec uses the cache, and keeps others waiting as long as the result lives.
    pub(super) fn lock(&self, progress: &mut dyn FnMut(Progress)) -> Result<File, LinkError> {
        let path = self.folder.join("lock");
        let failed = |error| LinkError::cache(&path, error);
        let file = File::options().create(true).append(true).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                progress(Progress::Waiting);
                file.lock().map_err(failed)?;
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        Ok(file)
    }
}

/// Writes `text` to `file` unless it is there already, and says whether it wrote; a reader sees the old or the new text.
pub(super) fn write_if_changed(file: &Path, text: &str) -> Result<bool, LinkError> {
    if fs::read(file).is_ok_and(|found| found == text.as_bytes()) {
        return Ok(false);
    }
    replace(file, text).map_err(|error| LinkError::cache(file, error))?;
    Ok(true)
}

/// Writes beside `file` and renames.
fn replace(file: &Path, text: &str) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    let new = file.with_extension("new");
    fs::write(&new, text)?;
    fs::rename(new, file)
}
