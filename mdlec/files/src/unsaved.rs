//! Stores texts that are read instead of files: texts that an editor has not saved yet, or all files of a plan.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Texts that replace files.
#[derive(Debug, Clone, Default)]
pub struct Unsaved {
    /// The texts. The keys are the canonical paths of the files that they replace.
    texts: BTreeMap<PathBuf, Arc<str>>,
    /// `true` if these texts are the only files. A path is then canonical if it contains no `.` and, where possible, no
    /// `..`.
    are_all: bool,
}

impl Unsaved {
    /// Returns texts that replace all files, so that no file is read. Each text has the path of its file.
    #[must_use]
    pub fn all(texts: impl IntoIterator<Item = (PathBuf, String)>) -> Self {
        let texts = texts.into_iter().map(|(path, text)| (normal(&path), text.into())).collect();
        Self { texts, are_all: true }
    }

    /// Uses `text` instead of the file `path` from now on. If the folder of the path does not exist, the call has no
    /// effect, because no plan can use such a file.
    pub fn insert(&mut self, path: &Path, text: &str) {
        if let Ok(place) = place(path) {
            self.texts.insert(place, text.into());
        }
    }

    /// Returns the text that replaces the file at this canonical path; `None` if there is no such text.
    pub(crate) fn text(&self, place: &Path) -> Option<&str> {
        self.texts.get(place).map(AsRef::as_ref)
    }

    /// Returns the canonical path of a file that exists on the disk or among these texts.
    pub(crate) fn place(&self, path: &Path) -> io::Result<PathBuf> {
        let is_here = |place: &PathBuf| self.texts.contains_key(place);
        if self.are_all {
            return Some(normal(path)).filter(is_here).ok_or_else(|| io::ErrorKind::NotFound.into());
        }
        path.canonicalize().or_else(|error| place(path).ok().filter(is_here).ok_or(error))
    }
}

/// Returns a path without the components `.`. Each `..` that follows the name of a folder is removed together with this
/// name.
#[must_use]
pub fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(normal.components().next_back(), Some(Component::Normal(_))) => {
                normal.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::ParentDir | Component::Normal(_) => {
                normal.push(component);
            }
        }
    }
    normal
}

/// Returns the canonical path of a file. The file need not exist, but its folder must.
///
/// # Errors
/// Fails if there is no such folder.
pub fn place(path: &Path) -> io::Result<PathBuf> {
    path.canonicalize().or_else(|error| match (path.parent(), path.file_name()) {
        (Some(folder), Some(name)) => {
            let folder = if folder == Path::new("") { Path::new(".") } else { folder };
            Ok(folder.canonicalize()?.join(name))
        }
        _ => Err(error),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::fs;

    use super::*;
    use crate::{plan, target};

    const MAIN: &str = "use \"leg.mdle\"\n{ Main (bumper) Leg }\n";

    /// Returns the codes of the diagnostics of the plan file `MAIN` in this folder.
    fn codes(folder: &Path, unsaved: &Unsaved) -> Vec<&'static str> {
        let target = target(None).unwrap();
        let mut input = plan(&folder.join("main.mdle"), MAIN.into(), &target).unwrap().with_unsaved(unsaved.clone());
        input.check(&target.alphabet).iter().map(|found| found.code.name()).collect()
    }

    #[test]
    fn all_texts_are_read_without_any_file() {
        let folder = Path::new("no/such/../folder");
        let leg = "use \"../folder/./foot.mdle\"\n{ Leg Foot }";
        let files = [("main.mdle", MAIN), ("leg.mdle", leg), ("foot.mdle", "{ Foot (Atom (wait 1) stop) }")];
        let texts = files.map(|(name, text)| (folder.join(name), text.to_owned()));
        assert_eq!(codes(folder, &Unsaved::all(texts)), [""; 0]);
        assert_eq!(codes(folder, &Unsaved::all([])), ["E0205"]);
        let outside = [(PathBuf::from("../../leg.mdle"), "{ Leg (Atom (wait 1) stop) }".to_owned())];
        assert_eq!(codes(Path::new("../.."), &Unsaved::all(outside)), [""; 0]);
    }

    #[test]
    fn unsaved_texts_are_read_in_place_of_files() {
        let folder = std::env::temp_dir().join(format!("mdle-unsaved-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let mut unsaved = Unsaved::default();
        assert_eq!(codes(&folder, &unsaved), ["E0205"]);
        unsaved.insert(&folder.join("leg.mdle"), "{ Leg (Atom (wait 1) stop) }");
        assert_eq!(codes(&folder, &unsaved), [""; 0]);
        fs::write(folder.join("leg.mdle"), "{ Foot (Atom (wait 1) stop) }").unwrap();
        assert_eq!(codes(&folder, &unsaved), [""; 0]);
        assert_eq!(codes(&folder, &Unsaved::default()), ["E0201"]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
