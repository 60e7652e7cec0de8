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

    /// The folder of what cargo has compiled.
    pub(super) fn target(&self) -> PathBuf {
        self.folder.join("target")
    }

    /// The folder of the packages of plans.
    pub(super) fn plans(&self) -> PathBuf {
        self.folder.join("plans")
    }

    /// An empty folder for the temporary files of a build: a compiler that is killed leaves its own behind.
    pub(super) fn scratch(&self) -> Result<PathBuf, LinkError> {
        let folder = self.folder.join("tmp");
        remove(&folder)?;
        fs::create_dir(&folder).map_err(|error| LinkError::cache(&folder, error))?;
        Ok(folder)
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

/// Writes `contents` to `file` unless they are there already, and says whether it wrote; a reader sees the old or the new.
pub(super) fn write_if_changed(file: &Path, contents: &[u8]) -> Result<bool, LinkError> {
    if fs::read(file).is_ok_and(|found| found == contents) {
        return Ok(false);
    }
    replace(file, contents).map_err(|error| LinkError::cache(file, error))?;
    Ok(true)
}

/// Writes beside `file` and renames.
fn replace(file: &Path, contents: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    // Nothing can be renamed over a folder.
    if file.is_dir() {
        fs::remove_dir_all(file)?;
    }
    let new = file.with_extension("new");
    fs::write(&new, contents)?;
    fs::rename(new, file)
}

/// Removes what is at `path`, be it a file or a folder with all that is in it.
pub(super) fn remove(path: &Path) -> Result<(), LinkError> {
    let removed = match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) => Err(error),
    };
    match removed {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(LinkError::cache(path, error)),
        Ok(()) | Err(_) => Ok(()),
    }
}
