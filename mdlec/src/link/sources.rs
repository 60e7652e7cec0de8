//! Manages the sources of executables: the files that are embedded in mdlec, and their copy in the cache.

use std::fs::{self, DirEntry, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use mdle_files::KnownSettings;

use super::cache::{remove, write_if_changed};
use super::{Cache, LinkError};

/// Names and folders of the packages on which every plan depends.
pub(super) const SHARED: [(&str, &str); 3] =
    [("mdle-runtime", "runtime/core"), ("mdle-host", "runtime/host"), ("mdle-atoms", "atoms")];

/// Name and folder of the package that runs scenarios.
pub(super) const RUNNER: (&str, &str) = ("mdle", "runtime/mdle");

/// Prefix of the names of folders with unpacked sources.
const PREFIX: &str = "src-";

/// Time after which the unpacked sources of an unused version are removed.
const FORGOTTEN: Duration = Duration::from_secs(30 * 24 * 60 * 60);

/// Name of the lock file, which contains the versions of the dependencies with which mdlec was tested.
pub(super) const LOCK: &str = "Cargo.lock";

/// Returns the folder and package name of a built-in target, given its name for `--target`.
pub(super) fn builtin(target: &str) -> Option<(String, &'static str)> {
    let (name, package) = embedded::TARGETS.iter().find(|(name, _)| *name == target)?;
    Some((format!("targets/{name}"), package))
}

/// Returns the robots that have an emulator, in alphabetical order.
pub fn emulators() -> impl Iterator<Item = &'static str> {
    embedded::EMULATORS.iter().map(|(robot, _)| *robot)
}

/// Returns the folder and package name of the emulator of a built-in target.
pub(super) fn emulator(robot: &str) -> Option<(String, &'static str)> {
    let (name, package) = embedded::EMULATORS.iter().find(|(name, _)| *name == robot)?;
    Some((format!("targets/{name}/emulator"), package))
}

/// Returns the worlds that come with a built-in target, in alphabetical order; an empty iterator for a target that
/// takes no worlds.
fn worlds(target: &str) -> impl Iterator<Item = &'static str> {
    let folder = format!("targets/{target}/worlds/");
    embedded::FILES.iter().filter_map(move |(file, _)| file.strip_prefix(&*folder)?.strip_suffix(".toml"))
}

/// Returns the worlds and options of a target that are known before a run. They are not known for a third-party target.
pub fn known(target: &str) -> KnownSettings {
    KnownSettings { worlds: worlds(target).collect(), options: options(target) }
}

/// Returns the options of the executables for a built-in target, each with the placeholder of its value (empty
/// for an option without a value); `None` for a third-party target.
fn options(target: &str) -> Option<Vec<(&'static str, &'static str)>> {
    let (folder, _) = builtin(target)?;
    let lines = text(&format!("{folder}/options.txt")).lines().filter(|line| !line.starts_with('#'));
    let options: Vec<_> = lines.map(|line| line.split_once(' ').unwrap_or((line, ""))).collect();
    // An empty list means that the options of the robot are not known yet.
    Some(options).filter(|options| !options.is_empty())
}

/// Returns the hash of all embedded files.
pub(super) fn hash() -> &'static str {
    embedded::HASH
}

/// Returns the text of the embedded file `name`.
pub(super) fn text(name: &str) -> &'static str {
    let file = embedded::FILES.iter().find(|(file, _)| *file == name);
    file.and_then(|(_, contents)| str::from_utf8(contents).ok()).unwrap_or_default()
}

/// Copy of the sources in the cache.
#[derive(Debug)]
pub(super) struct SourcesCopy {
    /// Folder of the copy.
    pub(super) folder: PathBuf,
}

impl SourcesCopy {
    /// Writes the files that are missing in the cache, and those that differ from the embedded files.
    ///
    /// Unchanged files keep their times, by which cargo recognizes what it has already built. The cache must be locked.
    pub(super) fn unpack(cache: &Cache) -> Result<Self, LinkError> {
        let folder = cache.folder().join(format!("{PREFIX}{}-{}", env!("CARGO_PKG_VERSION"), embedded::HASH));
        if !folder.exists() {
            forget_old_versions(cache)?;
        }
        match write(&folder) {
            Ok(()) => {}
            Err(full @ LinkError::DiskFull(_)) => return Err(full),
            // Writing fails if, for example, a file is in the place of a folder.
            Err(_) => {
                remove(&folder)?;
                write(&folder)?;
            }
        }
        // The folder's time marks its last use. If it cannot be set, the sources are removed too early, which only
        // costs time.
        let _ = File::open(&folder).and_then(|folder| folder.set_modified(SystemTime::now()));
        Ok(Self { folder })
    }
}

/// Returns `true` for the name of a folder of unpacked sources of any version: `src-VERSION-HASH`.
pub(super) fn is_folder(name: &str) -> bool {
    let parts = name.strip_prefix(PREFIX).and_then(|rest| rest.rsplit_once('-'));
    parts.is_some_and(|(version, hash)| {
        version.starts_with(|first: char| first.is_ascii_digit())
            && hash.len() == embedded::HASH.len()
            && hash.bytes().all(|digit| digit.is_ascii_hexdigit())
    })
}

/// Removes the sources of versions that have not been used for a long time. If there are any, also removes all build
/// results: most of these belong to old versions, and a new version has to compile everything anyway.
fn forget_old_versions(cache: &Cache) -> Result<(), LinkError> {
    let is_old = |found: &DirEntry| {
        let used = found.metadata().and_then(|found| found.modified()).ok();
        let age = used.and_then(|used| used.elapsed().ok());
        found.file_name().as_encoded_bytes().starts_with(PREFIX.as_bytes()) && age.is_some_and(|age| age > FORGOTTEN)
    };
    let unreadable = |error| LinkError::cache(cache.folder(), error);
    let found = fs::read_dir(cache.folder()).and_then(Iterator::collect::<io::Result<Vec<_>>>).map_err(unreadable)?;
    let old: Vec<_> = found.iter().filter(|found| is_old(found)).map(DirEntry::path).collect();
    if !old.is_empty() {
        remove(&cache.target())?;
        remove(&cache.plans())?;
    }
    // The sources are removed last, so that the next run continues an interrupted removal.
    old.iter().try_for_each(|old| remove(old))
}

/// Writes missing and changed files to `folder`.
fn write(folder: &Path) -> Result<(), LinkError> {
    embedded::FILES.iter().try_for_each(|(name, contents)| write_if_changed(&folder.join(name), contents).map(|_| ()))
}

/// Table that `build/sources.rs` generates.
mod embedded {
    include!(concat!(env!("OUT_DIR"), "/sources.rs"));
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs::{self, File};
    use std::time::{Duration, SystemTime};

    use super::super::Cache;
    use super::super::tests::cache;
    use mdle_compiler::builtin::alphabets;

    use super::{FORGOTTEN, SourcesCopy, builtin, embedded, text};

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
    fn emulators_are_packed() {
        assert_eq!(super::emulators().collect::<Vec<_>>(), ["atrv", "scout"]);
        for robot in super::emulators() {
            let (folder, package) = super::emulator(robot).unwrap();
            assert!(text(&format!("{folder}/Cargo.toml")).contains(&format!("name = \"{package}\"")));
            assert!(text(&format!("{folder}/src/lib.rs")).contains("pub fn main()"));
        }
        assert_eq!(super::emulator("sim"), None);
    }

    #[test]
    fn nothing_but_what_a_build_needs_is_packed() {
        for (name, _) in embedded::FILES {
            // Of mdlec, only the crates that load the plans of a scenario are packed.
            let is_of_mdlec = name.starts_with("mdlec/");
            let is_loader = ["mdlec/compiler/", "mdlec/files/"].iter().any(|folder| name.starts_with(folder));
            assert!(is_loader || !is_of_mdlec, "{name}");
            assert!(!name.contains("/tests") && !name.starts_with('/'), "{name}");
        }
        assert!(!text("Cargo.toml").contains("tests\""));
        for (name, contents) in embedded::FILES.iter().filter(|(name, _)| name.ends_with("/Cargo.toml")) {
            let manifest = std::str::from_utf8(contents).unwrap();
            assert!(
                ["bench", "test", "example"].iter().all(|kind| !manifest.contains(&format!("[[{kind}]]"))),
                "{name}"
            );
        }
    }

    #[test]
    fn a_damaged_copy_is_mended_and_the_rest_left_alone() {
        let cache = cache("damaged");
        let folder = SourcesCopy::unpack(&cache).unwrap().folder;
        let time = |name: &str| fs::metadata(folder.join(name)).unwrap().modified().unwrap();
        let before = time("Cargo.toml");
        fs::remove_file(folder.join("atoms/Cargo.toml")).unwrap();
        fs::write(folder.join("runtime/core/src/lib.rs"), "cut").unwrap();
        fs::remove_dir_all(folder.join("runtime/host")).unwrap();
        // Garbage of the right length, and a folder in the place of a file.
        fs::write(folder.join("atoms/alphabet.mdle"), text("atoms/alphabet.mdle").replace(' ', "?")).unwrap();
        fs::remove_file(folder.join("Cargo.lock")).unwrap();
        fs::create_dir_all(folder.join("Cargo.lock/garbage")).unwrap();
        assert_unpacked(&cache);
        assert_eq!(time("Cargo.toml"), before);
    }

    #[test]
    fn a_file_where_a_folder_has_to_be_gives_way() {
        let cache = cache("in_the_way");
        let folder = SourcesCopy::unpack(&cache).unwrap().folder;
        fs::remove_dir_all(folder.join("atoms/src")).unwrap();
        fs::write(folder.join("atoms/src"), "garbage").unwrap();
        assert_unpacked(&cache);
        fs::remove_dir_all(&folder).unwrap();
        fs::write(&folder, "garbage").unwrap();
        assert_unpacked(&cache);
    }

    #[test]
    fn versions_that_nobody_uses_are_forgotten_when_a_new_one_comes() {
        let cache = cache("versions");
        let folder = |name: &str, days: u64| {
            let folder = cache.folder().join(name);
            fs::create_dir_all(folder.join("inside")).unwrap();
            let time = SystemTime::now() - Duration::from_secs(days * 24 * 60 * 60);
            File::open(folder).unwrap().set_modified(time).unwrap();
        };
        let names = || {
            let names = fs::read_dir(cache.folder()).unwrap().map(|found| found.unwrap().file_name());
            names.map(|name| name.into_string().unwrap()).collect::<BTreeSet<_>>()
        };
        let new = SourcesCopy::unpack(&cache).unwrap().folder;
        let name = new.file_name().unwrap().to_str().unwrap();
        let fill = || {
            folder("src-0.0.1-0123456789ab", 31);
            folder("src-0.0.2-0123456789ab", 29);
            folder("target", 31);
            folder("plans", 31);
        };
        fill();
        folder(name, 31);
        SourcesCopy::unpack(&cache).unwrap();
        assert_eq!(names().len(), 5, "nothing goes while the same version is used");
        assert!(fs::metadata(&new).unwrap().modified().unwrap().elapsed().unwrap() < FORGOTTEN);

        fs::remove_dir_all(&new).unwrap();
        SourcesCopy::unpack(&cache).unwrap();
        assert_eq!(names(), BTreeSet::from(["src-0.0.2-0123456789ab".to_owned(), name.to_owned()]));
        fill();
        fs::remove_dir_all(cache.folder().join("src-0.0.1-0123456789ab")).unwrap();
        fs::remove_dir_all(&new).unwrap();
        SourcesCopy::unpack(&cache).unwrap();
        assert_eq!(names().len(), 4, "what was compiled stays with a version that may be used");
    }

    fn assert_unpacked(cache: &Cache) {
        let folder = SourcesCopy::unpack(cache).unwrap().folder;
        for (name, contents) in embedded::FILES {
            assert_eq!(fs::read(folder.join(name)).unwrap(), *contents, "{name}");
        }
    }
}
