//! The sources that executables are built from, as packed into mdlec, and their copy in the cache.

use std::path::{Path, PathBuf};

use super::cache::{remove, write_if_changed};
use super::{Cache, LinkError};

/// The packages that every plan is built on, with their folders.
pub(super) const SHARED: [(&str, &str); 3] =
    [("mdle-runtime", "runtime/core"), ("mdle-host", "runtime/host"), ("mdle-atoms", "atoms")];

/// The versions that everything was tested with.
pub(super) const LOCK: &str = "Cargo.lock";

/// An alphabet that came with mdlec.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Alphabet {
    /// What `--target` or `use` calls it.
    pub name: &'static str,
    /// The name of the file that messages show.
    pub file: &'static str,
    /// The text of the file.
    pub text: &'static str,
    /// Whether it is a target's, and not one that targets share.
    pub target: bool,
}

/// The alphabets that came with mdlec: the shared ones first, then the targets' in the order of their names.
#[must_use]
pub fn alphabets() -> &'static [Alphabet] {
    embedded::ALPHABETS
}

/// The folder and the package name of a built-in target, by what `--target` calls it.
pub(super) fn builtin(target: &str) -> Option<(String, &'static str)> {
    let (name, package) = embedded::TARGETS.iter().find(|(name, _)| *name == target)?;
    Some((format!("targets/{name}"), package))
}

/// The text of a packed file.
pub(super) fn text(name: &str) -> &'static str {
    let file = embedded::FILES.iter().find(|(file, _)| *file == name);
    file.and_then(|(_, contents)| str::from_utf8(contents).ok()).unwrap_or_default()
}

/// The copy in the cache.
#[derive(Debug)]
pub(super) struct Sources {
    /// Its folder.
    pub(super) folder: PathBuf,
}

impl Sources {
    /// Writes the files that the cache lacks, and those that are not as they were packed.
    ///
    /// Files that are there keep their times, by which cargo knows what it has built. Call it with the cache locked.
    pub(super) fn unpack(cache: &Cache) -> Result<Self, LinkError> {
        let folder = cache.folder().join(format!("src-{}-{}", env!("CARGO_PKG_VERSION"), embedded::HASH));
        match write(&folder) {
            Ok(()) => {}
            Err(full @ LinkError::DiskFull(_)) => return Err(full),
            // Such as a file where a folder has to be.
            Err(_) => {
                remove(&folder)?;
                write(&folder)?;
            }
        }
        Ok(Self { folder })
    }
}

/// Writes to `folder` what is not there yet.
fn write(folder: &Path) -> Result<(), LinkError> {
    embedded::FILES.iter().try_for_each(|(name, contents)| write_if_changed(&folder.join(name), contents).map(|_| ()))
}

/// The table that `build/sources.rs` makes.
mod embedded {
    include!(concat!(env!("OUT_DIR"), "/sources.rs"));
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::Cache;
    use super::super::tests::cache;
    use super::{Sources, alphabets, builtin, embedded, text};

    #[test]
    fn alphabets_come_with_names_that_can_be_shown() {
        let names: Vec<_> = alphabets().iter().map(|alphabet| (alphabet.name, alphabet.file)).collect();
        assert!(names.starts_with(&[("atoms", "atoms/alphabet.mdle")]), "{names:?}");
        for alphabet in alphabets() {
            assert_eq!(alphabet.text, text(alphabet.file));
            assert_eq!(builtin(alphabet.name).is_some(), alphabet.target);
        }
    }

    #[test]
    fn nothing_but_what_a_build_needs_is_packed() {
        for (name, _) in embedded::FILES {
            assert!(!name.contains("mdlec") && !name.contains("/tests") && !name.starts_with('/'), "{name}");
        }
        assert!(!text("Cargo.toml").contains("tests\""));
    }

    #[test]
    fn a_damaged_copy_is_mended_and_the_rest_left_alone() {
        let cache = cache("damaged");
        let folder = Sources::unpack(&cache).unwrap().folder;
        let time = |name: &str| fs::metadata(folder.join(name)).unwrap().modified().unwrap();
        let before = time("Cargo.toml");
        fs::remove_file(folder.join("atoms/Cargo.toml")).unwrap();
        fs::write(folder.join("runtime/core/src/lib.rs"), "cut").unwrap();
        fs::remove_dir_all(folder.join("runtime/host")).unwrap();
        // Garbage of the right length, and a folder where a file has to be.
        fs::write(folder.join("atoms/alphabet.mdle"), text("atoms/alphabet.mdle").replace(' ', "?")).unwrap();
        fs::remove_file(folder.join("Cargo.lock")).unwrap();
        fs::create_dir_all(folder.join("Cargo.lock/garbage")).unwrap();
        assert_unpacked(&cache);
        assert_eq!(time("Cargo.toml"), before);
    }

    #[test]
    fn a_file_where_a_folder_has_to_be_gives_way() {
        let cache = cache("in_the_way");
        let folder = Sources::unpack(&cache).unwrap().folder;
        fs::remove_dir_all(folder.join("atoms/src")).unwrap();
        fs::write(folder.join("atoms/src"), "garbage").unwrap();
        assert_unpacked(&cache);
        fs::remove_dir_all(&folder).unwrap();
        fs::write(&folder, "garbage").unwrap();
        assert_unpacked(&cache);
    }

    fn assert_unpacked(cache: &Cache) {
        let folder = Sources::unpack(cache).unwrap().folder;
        for (name, contents) in embedded::FILES {
            assert_eq!(fs::read(folder.join(name)).unwrap(), *contents, "{name}");
        }
    }
}
