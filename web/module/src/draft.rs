//! The plan files of a page, and the robot for which they are written.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use serde::Deserialize;

/// Name of the file that is run.
pub(crate) const FILE: &str = "plan.mdle";

/// The plan files of a page, as the user has typed them.
#[derive(Debug, Clone, Default, Deserialize)]
pub(crate) struct PageFiles {
    /// Text of the file that is run, [`FILE`].
    pub(crate) text: String,
    /// Texts of the other files, by their names; a name may include folders.
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
    /// Name of the file in the editor; empty for [`FILE`].
    #[serde(default)]
    pub(crate) file: String,
    /// Name of the robot for which the plan is checked; empty for `sim`.
    #[serde(default)]
    pub(crate) robot: String,
}

impl PageFiles {
    /// Returns the text of the file with the path `place`, or `None` if there is no such file.
    pub(crate) fn at(&self, place: &str) -> Option<&str> {
        if place == FILE { Some(&self.text) } else { self.files.get(place).map(String::as_str) }
    }

    /// Returns the names of all files.
    pub(crate) fn names(&self) -> Vec<&str> {
        std::iter::once(FILE).chain(self.files.keys().map(String::as_str)).collect()
    }
}

/// Resolves `path` relative to the folder of the file `from`. Returns the joined path, and the same path without `.`
/// and `..`. The second path is `None` if it leads out of the page's folder.
pub(crate) fn looked_up(from: &str, path: &str) -> (String, Option<String>) {
    let whole = Path::new(from).parent().unwrap_or(Path::new("")).join(path);
    let mut parts = Vec::new();
    for part in whole.components() {
        match part {
            Component::Normal(name) => parts.push(name.to_string_lossy().into_owned()),
            Component::CurDir => {}
            Component::ParentDir if parts.pop().is_some() => {}
            Component::ParentDir | Component::RootDir | Component::Prefix(_) => {
                return (whole.display().to_string(), None);
            }
        }
    }
    (whole.display().to_string(), Some(parts.join("/")))
}

#[cfg(test)]
mod tests {
    use super::looked_up;

    #[test]
    fn paths_are_looked_up_from_the_using_file() {
        let place = |from, path| looked_up(from, path).1;
        assert_eq!(place("plan.mdle", "leg.mdle").as_deref(), Some("leg.mdle"));
        assert_eq!(place("lib/leg.mdle", "./foot.mdle").as_deref(), Some("lib/foot.mdle"));
        assert_eq!(place("lib/leg.mdle", "../plan.mdle").as_deref(), Some("plan.mdle"));
        assert_eq!(place("lib/leg.mdle", "../../plan.mdle"), None);
        assert_eq!(place("plan.mdle", "/plan.mdle"), None);
        assert_eq!(looked_up("lib/leg.mdle", "../foot.mdle").0, "lib/../foot.mdle");
    }
}
