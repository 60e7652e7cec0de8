//! `--watch`: finds the files on which tests depend, and waits until one of them changes.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

/// Interval between two checks of the files.
const LOOK: Duration = Duration::from_millis(200);

/// Extensions of the files on which tests depend.
const ENDINGS: [&str; 6] = ["mdle", "toml", "csv", "yaml", "pgm", "png"];

/// Modification time and size of each file.
type Looks = BTreeMap<PathBuf, (Option<SystemTime>, u64)>;

/// The files in the folders of the watched test files.
#[derive(Debug)]
pub(super) struct WatchedFiles {
    folders: Vec<PathBuf>,
    last: Looks,
}

impl WatchedFiles {
    /// Watches the folders of these test files.
    pub(super) fn new(files: &[PathBuf]) -> Self {
        let mut folders: Vec<_> = files.iter().map(|file| folder(file)).collect();
        folders.sort();
        folders.dedup();
        let last = look(&folders);
        Self { folders, last }
    }

    /// Waits until a file has changed, and returns this file.
    pub(super) fn changed(&mut self) -> PathBuf {
        loop {
            sleep(LOOK);
            let now = look(&self.folders);
            let is_new = |(path, seen): (&PathBuf, &_)| (self.last.get(path) != Some(seen)).then(|| path.clone());
            let is_gone = |path: &&PathBuf| !now.contains_key(*path);
            let changed = now.iter().find_map(is_new).or_else(|| self.last.keys().find(is_gone).cloned());
            if let Some(path) = changed {
                self.last = now;
                return path;
            }
        }
    }
}

fn folder(file: &Path) -> PathBuf {
    let folder = file.parent().unwrap_or(Path::new(""));
    if folder == Path::new("") { PathBuf::from(".") } else { folder.to_owned() }
}

fn look(folders: &[PathBuf]) -> Looks {
    let entries = folders.iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten();
    let entries = entries.filter(|entry| {
        let path = entry.path();
        let ending = path.extension().unwrap_or_default();
        ENDINGS.iter().any(|known| ending == *known)
    });
    let looks = entries.filter_map(|entry| {
        let about = entry.metadata().ok()?;
        let path = entry.path();
        let path = path.strip_prefix("./").map(Path::to_owned).unwrap_or(path);
        Some((path, (about.modified().ok(), about.len())))
    });
    looks.collect()
}
