//! The cache, which mdlec keeps between runs. It contains unpacked sources, compiled libraries, and the packages of
//! plans.
//!
//! It is the folder `mdlec` in the user's cache folder, unless `MDLEC_CACHE` names another folder; it may be deleted at
//! any time.

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::{env, process};

use etcetera::BaseStrategy;

use super::access::{self, Private};
use super::{BuildStep, LinkError};

/// The cache, which is a folder that mdlec keeps between runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// Returns the user's cache.
    ///
    /// # Errors
    /// Fails if there is no [`Cache::folder_of_user`], or if it cannot be created.
    pub fn of_user() -> Result<Self, LinkError> {
        Self::at(&Self::folder_of_user()?)
    }

    /// Returns the folder of the user's cache, which need not exist: the value of `MDLEC_CACHE` or, without this
    /// variable, `mdlec` in the user's cache folder.
    ///
    /// # Errors
    /// Fails if there is neither the variable nor a home folder.
    pub fn folder_of_user() -> Result<PathBuf, LinkError> {
        match env::var_os("MDLEC_CACHE").filter(|folder| !folder.is_empty()) {
            Some(folder) => Ok(PathBuf::from(folder)),
            None => {
                let folders = etcetera::choose_base_strategy().map_err(|_| LinkError::NoCacheFolder)?;
                Ok(folders.cache_dir().join("mdlec"))
            }
        }
    }

    /// Returns the cache in `folder`, which is created if necessary. Access by other users is removed.
    ///
    /// # Errors
    /// Fails if `folder` cannot be created, or if others can change or replace it.
    pub fn at(folder: &Path) -> Result<Self, LinkError> {
        // The path has no symbolic links, because it is compared with paths that cargo prints without symbolic links.
        let Private { folder, was_open } = access::private(folder)?;
        let cache = Self { folder };
        if was_open {
            // Other users may have put files there that cargo would take for its own. The sources can stay, since their
            // contents are compared.
            remove(&cache.target())?;
            remove(&cache.plans())?;
        }
        Ok(cache)
    }

    /// Returns the folder of the cache.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the folder of cargo's build results.
    pub(super) fn target(&self) -> PathBuf {
        self.folder.join("target")
    }

    /// Returns the folder of the packages of plans.
    pub(super) fn plans(&self) -> PathBuf {
        self.folder.join("plans")
    }

    /// Returns an empty folder for the temporary files of a build. Files that a killed compiler has left in it are
    /// removed.
    pub(super) fn scratch(&self) -> Result<PathBuf, LinkError> {
        let folder = self.folder.join("tmp");
        remove(&folder)?;
        fs::create_dir(&folder).map_err(|error| LinkError::cache(&folder, error))?;
        Ok(folder)
    }

    /// Waits until no other mdlec uses the cache, and then locks the cache until the returned file is closed.
    pub(super) fn lock(&self, progress: &mut dyn FnMut(BuildStep)) -> Result<File, LinkError> {
        let path = self.folder.join("lock");
        let failed = |error| LinkError::cache(&path, error);
        let mut options = File::options();
        let mut file = options.create(true).append(true).mode(0o600).open(&path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let holder = fs::read_to_string(&path).ok().and_then(|text| text.trim_end().parse().ok());
                progress(BuildStep::Waiting(holder));
                file.lock().map_err(failed)?;
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        // Waiting processes show this number. On a full disk it is missing.
        let _ = file.set_len(0).and_then(|()| writeln!(file, "{}", process::id()));
        Ok(file)
    }
}

/// Writes `contents` to `file` if the file has other contents; returns `true` if the file was written. Another process
/// that reads the file sees either the old or the new contents.
pub(super) fn write_if_changed(file: &Path, contents: &[u8]) -> Result<bool, LinkError> {
    if fs::read(file).is_ok_and(|found| found == contents) {
        return Ok(false);
    }
    replace(file, contents).map_err(|error| LinkError::cache(file, error))?;
    Ok(true)
}

/// Writes a temporary file next to `file`, and renames it to `file`.
fn replace(file: &Path, contents: &[u8]) -> io::Result<()> {
    if let Some(folder) = file.parent() {
        fs::create_dir_all(folder)?;
    }
    // A file cannot be renamed over a folder.
    if file.is_dir() {
        fs::remove_dir_all(file)?;
    }
    let new = file.with_extension("new");
    fs::write(&new, contents)?;
    fs::rename(new, file)
}

/// Removes a file, or a folder with all its contents.
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
