//! The folders of the targets that are part of mdlec, for the build scripts that pack their files.

use std::error::Error;
use std::fs;
use std::path::Path;

/// Folder below `targets` that contains no robot, but the template for `mdlec new-target`.
const TEMPLATE: &str = "template";

/// The folders below `targets` that are packages with an alphabet, the template aside.
pub(crate) fn targets(root: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut targets = Vec::new();
    for entry in fs::read_dir(root.join("targets"))? {
        let folder = entry?.path();
        let is_robot = !folder.ends_with(TEMPLATE);
        if is_robot && folder.join("Cargo.toml").is_file() && folder.join("alphabet.mdle").is_file() {
            let name = folder.file_name().and_then(|name| name.to_str());
            targets.push(name.ok_or_else(|| format!("{folder:?} is not UTF-8"))?.to_owned());
        }
    }
    targets.sort();
    Ok(targets)
}
