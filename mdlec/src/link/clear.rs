//! Empties a cache: removes the files that mdlec keeps there, if the folder holds no other files.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, DirEntry};
use std::io;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::cache::remove;
use super::{BuildStep, Cache, LinkError, sources};

/// Name of the file that a running mdlec locks. The file is not removed, so that all processes wait for the
/// same file.
const LOCK: &str = "lock";

/// Names of the other files and folders of a cache, except the unpacked sources. `cargo` is a file that earlier
/// versions of mdlec left when they were killed.
const OWN: [&str; 6] = ["cargo", "compiled", "compiled.new", "target", "tmp", "plans"];

/// Removes the contents of the cache in `folder`, as soon as no other mdlec uses it, and returns the number of bytes
/// that were freed. The folder stays, with its lock file.
///
/// # Errors
/// Fails and changes nothing if the folder is not a cache because it contains a file that mdlec did not write, or no
/// lock file. Also fails if the system refuses to remove a file.
pub fn clear(folder: &Path, progress: &mut dyn FnMut(BuildStep)) -> Result<u64, LinkError> {
    // This check comes before any change, even a change of permissions.
    let Some(found) = contents(folder)? else { return Ok(0) };
    if found.is_empty() {
        return Ok(0);
    }
    let cache = Cache::at(folder)?;
    let _locked = cache.lock(progress)?;
    let found = contents(cache.folder())?.unwrap_or_default();
    let mut counted = BTreeSet::new();
    let mut bytes = 0;
    for entry in found.iter().filter(|entry| entry.file_name() != LOCK) {
        let path = entry.path();
        bytes += size(&path, &mut counted).map_err(|error| LinkError::cache(&path, error))?;
        remove(&path)?;
    }
    Ok(bytes)
}

/// Returns the entries of a folder that must be a cache; `None` if the folder does not exist.
fn contents(folder: &Path) -> Result<Option<Vec<DirEntry>>, LinkError> {
    let found = match fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>) {
        Ok(found) => found,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(LinkError::cache(folder, error)),
    };
    let not_a_cache = |why| LinkError::NotACache { path: folder.to_owned(), why };
    if let Some(strange) = found.iter().find(|entry| !is_own(&entry.file_name())) {
        let name = strange.file_name().to_string_lossy().into_owned();
        return Err(not_a_cache(format!("it contains `{name}`, which mdlec did not write")));
    }
    if !found.is_empty() && !found.iter().any(|entry| entry.file_name() == LOCK) {
        return Err(not_a_cache("it has no `lock`".to_owned()));
    }
    Ok(Some(found))
}

fn is_own(name: &OsStr) -> bool {
    name == LOCK || OWN.iter().any(|own| name == *own) || name.to_str().is_some_and(sources::is_folder)
}

/// Returns the disk space of a file, or of a folder with all its contents, in bytes. A file with several hard links
/// counts once.
fn size(path: &Path, counted: &mut BTreeSet<(u64, u64)>) -> io::Result<u64> {
    let found = fs::symlink_metadata(path)?;
    let own = if counted.insert((found.dev(), found.ino())) { found.blocks() * 512 } else { 0 };
    if !found.is_dir() {
        return Ok(own);
    }
    fs::read_dir(path)?.try_fold(own, |sum, entry| Ok(sum + size(&entry?.path(), counted)?))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::super::LinkError;
    use super::super::tests::{cache, folder};
    use super::clear;

    #[test]
    fn only_what_mdlec_keeps_is_removed() {
        let (cache, outside) = (cache("clear"), folder("clear_outside"));
        let file = outside.join("precious");
        fs::write(&file, "precious").unwrap();
        for name in ["src-0.1.0-0123456789ab/atoms", "target/release", "plans/plan-nap-0"] {
            fs::create_dir_all(cache.folder().join(name)).unwrap();
            fs::write(cache.folder().join(name).join("file"), [7; 10_000]).unwrap();
        }
        fs::hard_link(cache.folder().join("target/release/file"), cache.folder().join("target/second")).unwrap();
        symlink(&outside, cache.folder().join("target/link")).unwrap();
        fs::write(cache.folder().join("lock"), "").unwrap();
        fs::write(cache.folder().join("cargo"), "4711 1\n").unwrap();
        let freed = clear(cache.folder(), &mut |_| {}).unwrap();
        assert!((30_000..90_000).contains(&freed), "{freed}");
        assert_eq!(fs::read_dir(cache.folder()).unwrap().count(), 1, "the lock stays");
        assert_eq!(fs::read_to_string(&file).unwrap(), "precious");
        assert_eq!(clear(cache.folder(), &mut |_| {}).unwrap(), 0);
    }

    #[test]
    fn a_folder_of_something_else_is_not_touched() {
        let folder = folder("clear_no_cache");
        fs::create_dir(folder.join("target")).unwrap();
        fs::set_permissions(&folder, fs::Permissions::from_mode(0o755)).unwrap();
        let why = || match clear(&folder, &mut |_| {}) {
            Err(LinkError::NotACache { why, .. }) => why,
            other => panic!("{other:?}"),
        };
        assert_eq!(why(), "it has no `lock`");
        fs::write(folder.join("lock"), "").unwrap();
        for name in ["src", "src-of-mine", "Cargo.toml", ".git"] {
            fs::write(folder.join(name), "").unwrap();
            assert_eq!(why(), format!("it contains `{name}`, which mdlec did not write"));
            fs::remove_file(folder.join(name)).unwrap();
        }
        assert!(folder.join("target").exists());
        assert_eq!(fs::metadata(&folder).unwrap().permissions().mode() & 0o777, 0o755);
        assert_eq!(clear(&folder.join("none"), &mut |_| {}).unwrap(), 0);
        assert!(!folder.join("none").exists());
    }
}
