//! Texts that an editor has not saved yet, which are read instead of the files.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Texts of an editor, by the canonical paths of their files.
#[derive(Debug, Clone, Default)]
pub struct Unsaved(BTreeMap<PathBuf, Arc<str>>);

impl Unsaved {
    /// Uses `text` instead of the file `path` from now on. A path whose folder does not exist has no effect,
    /// since no plan can use it.
    pub fn insert(&mut self, path: &Path, text: &str) {
        if let Ok(place) = place(path) {
            self.0.insert(place, text.into());
        }
    }

    /// Returns the text for this canonical path, if the editor has one.
    pub(crate) fn text(&self, place: &Path) -> Option<&str> {
        self.0.get(place).map(AsRef::as_ref)
    }

    /// Returns the canonical path of a file that is on the disk or among these texts.
    pub(crate) fn place(&self, path: &Path) -> io::Result<PathBuf> {
        path.canonicalize().or_else(|error| place(path).ok().filter(|place| self.0.contains_key(place)).ok_or(error))
    }
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

    /// Returns the codes of the diagnostics of `MAIN` in this folder.
    fn codes(folder: &Path, unsaved: &Unsaved) -> Vec<&'static str> {
        let target = target(None).unwrap();
        let mut input = plan(&folder.join("main.mdle"), MAIN.into(), &target).unwrap().with_unsaved(unsaved.clone());
        input.check(&target.alphabet).iter().map(|found| found.code.name()).collect()
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
