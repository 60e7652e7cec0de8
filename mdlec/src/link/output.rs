//! Checks the output file before the build, and writes it in one step after the build.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};

use super::{LinkError, cleanup};

/// Writes `bytes` to the file `output`, completely or not at all; a device is written directly. A file that is
/// overwritten keeps its permissions. `inputs` are the files from which `bytes` were made.
///
/// # Errors
/// Fails if `output` is a folder, is one of `inputs`, or cannot be written.
pub fn write_whole(output: &Path, bytes: &[u8], inputs: &[PathBuf]) -> Result<(), LinkError> {
    match OutputFile::check(output, inputs) {
        Ok(destination) => destination.put(|new| {
            if let Ok(old) = fs::metadata(&destination.path) {
                new.set_permissions(old.permissions())?;
            }
            new.write_all(bytes)
        }),
        Err(LinkError::OutputIsSpecial(_)) => {
            fs::write(output, bytes).map_err(|error| LinkError::output(output, error))
        }
        Err(error) => Err(error),
    }
}

/// Refuses an `output` that is the same file as one of `inputs`, even if its path differs or it is a link, because
/// writing would destroy the input.
///
/// # Errors
/// Fails with [`LinkError::OutputIsInput`].
pub fn must_not_be_read(output: &Path, inputs: &[PathBuf]) -> Result<(), LinkError> {
    let file = |path: &Path| fs::metadata(path).ok().map(|found| (found.dev(), found.ino()));
    let is_input = file(output).is_some_and(|output| inputs.iter().any(|input| file(input) == Some(output)));
    if is_input { Err(LinkError::OutputIsInput(output.to_owned())) } else { Ok(()) }
}

/// A file that can be created or overwritten by a build.
#[derive(Debug)]
pub(super) struct OutputFile {
    /// Path as the caller wrote it.
    shown: PathBuf,
    /// Path with symbolic links resolved, because a rename to a link would replace the link.
    path: PathBuf,
}

impl OutputFile {
    /// Checks before the build that a file can be written to `output`, which must not be one of `inputs`.
    pub(super) fn check(output: &Path, inputs: &[PathBuf]) -> Result<Self, LinkError> {
        let shown = output.to_owned();
        let path = match fs::metadata(output) {
            Ok(found) if found.is_dir() => return Err(LinkError::OutputIsFolder(shown)),
            Ok(found) if !found.is_file() => return Err(LinkError::OutputIsSpecial(shown)),
            Ok(_) => output.canonicalize().map_err(|error| LinkError::output(output, error))?,
            Err(error) if error.kind() == io::ErrorKind::NotFound => output.to_owned(),
            Err(error) => return Err(LinkError::output(output, error)),
        };
        must_not_be_read(output, inputs)?;
        if path.file_name().is_none() || output.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(LinkError::OutputIsFolder(shown));
        }
        let folder = folder(&path);
        if !folder.is_dir() {
            return Err(LinkError::OutputFolderMissing(folder.to_owned()));
        }
        let destination = Self { shown, path };
        // The trial file is removed at once, so that a signal during the build does not leave a file behind.
        let trial = destination.beside();
        let tried = cleanup::create(&trial).and_then(|_watched| fs::remove_file(&trial));
        tried.map_err(|error| LinkError::output(&destination.shown, error))?;
        Ok(destination)
    }

    /// Copies the file `executable` to the destination, including its permissions; returns the size in bytes.
    pub(super) fn copy(&self, executable: &Path) -> Result<u64, LinkError> {
        self.put(|new| {
            let mut executable = File::open(executable)?;
            new.set_permissions(executable.metadata()?.permissions())?;
            io::copy(&mut executable, new)
        })
    }

    /// Creates a file next to the destination, lets `write` fill it, and renames it to the destination.
    fn put<T>(&self, write: impl FnOnce(&mut File) -> io::Result<T>) -> Result<T, LinkError> {
        let new = self.beside();
        let refused = |error| LinkError::output(&self.shown, error);
        let (mut file, _watched) = cleanup::create(&new).map_err(refused)?;
        let written = write(&mut file).and_then(|written| fs::rename(&new, &self.path).map(|()| written));
        written.map_err(|error| {
            // Only the first error is reported; an error of the removal is ignored.
            let _ = fs::remove_file(&new);
            refused(error)
        })
    }

    /// Returns the path of a file that does not exist yet, in the same folder.
    fn beside(&self) -> PathBuf {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let mut name = OsString::from(".");
        name.push(self.path.file_name().unwrap_or_default());
        name.push(format!(".{}-{}.new", process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
        folder(&self.path).join(name)
    }
}

/// Returns the folder of a file; `.` for a path that is only a name.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::super::LinkError;
    use super::super::tests::folder;
    use super::{OutputFile, write_whole};

    #[test]
    fn a_place_that_is_no_file_is_refused_before_the_build() {
        let folder = folder("refused");
        let check = |output: &Path| OutputFile::check(output, &[folder.join("nap.mdle")]).unwrap_err();
        fs::write(folder.join("nap.mdle"), "").unwrap();
        assert!(matches!(check(&folder), LinkError::OutputIsFolder(_)));
        assert!(matches!(check(&folder.join("none/nap")), LinkError::OutputFolderMissing(_)));
        assert!(matches!(check(&folder.join("nap/")), LinkError::OutputIsFolder(_)));
        assert!(matches!(check(Path::new("/dev/null")), LinkError::OutputIsSpecial(_)));
        assert!(matches!(check(&folder.join("nap.mdle")), LinkError::OutputIsInput(_)));
        assert!(matches!(check(&folder.join("nap.mdle/nap")), LinkError::OutputRefused { .. }));
        assert_eq!(check(&folder).exit_status(), 2);
    }

    #[test]
    fn only_the_whole_file_appears() {
        let folder = folder("whole");
        let output = folder.join("nap");
        OutputFile::check(&output, &[]).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        write_whole(&output, b"one", &[]).unwrap();
        write_whole(&output, b"two", &[]).unwrap();
        assert_eq!(fs::read(&output).unwrap(), b"two");
        let destination = OutputFile::check(&output, &[]).unwrap();
        destination.copy(&folder.join("missing")).unwrap_err();
        assert_eq!(fs::read(&output).unwrap(), b"two");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    }

    #[test]
    fn a_link_is_followed() {
        let folder = folder("linked");
        fs::write(folder.join("real"), "old").unwrap();
        std::os::unix::fs::symlink("real", folder.join("link")).unwrap();
        write_whole(&folder.join("link"), b"new", &[]).unwrap();
        assert_eq!(fs::read(folder.join("real")).unwrap(), b"new");
    }
}
