//! Finds the folders of the targets that are built into mdlec, for the build scripts that embed the files of these
//! targets.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Folder below `targets` that contains no robot, but the template for `mdlec new-target`.
const TEMPLATE: &str = "template";

/// Name that a published package uses for the folder of the sources, and for the manifests in this folder.
/// `.ci/package` writes the folder and renames the manifests, because cargo does not publish a subfolder that contains
/// a `Cargo.toml`.
const PACKED: &str = "packed";
const PACKED_MANIFEST: &str = "manifest.toml";

/// Returns the folder of the sources. In a published package, these are the packed sources; otherwise, it is the
/// checkout, at the path `up` relative to the package.
pub(crate) fn checkout(up: &str) -> Result<PathBuf, Box<dyn Error>> {
    let package = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let packed = package.join(PACKED);
    Ok(if packed.is_dir() { packed } else { package.join(up).canonicalize()? })
}

/// Returns the manifest of the package in a folder of the sources; `None` if the folder is not a package.
pub(crate) fn manifest(folder: &Path) -> Option<PathBuf> {
    ["Cargo.toml", PACKED_MANIFEST].map(|name| folder.join(name)).into_iter().find(|path| path.is_file())
}

/// Returns the names of the folders below `targets` that are packages with an alphabet, except the template.
pub(crate) fn targets(root: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut targets = Vec::new();
    for entry in fs::read_dir(root.join("targets"))? {
        let folder = entry?.path();
        let is_robot = !folder.ends_with(TEMPLATE);
        if is_robot && manifest(&folder).is_some() && folder.join("alphabet.mdle").is_file() {
            let name = folder.file_name().and_then(|name| name.to_str());
            targets.push(name.ok_or_else(|| format!("{folder:?} is not UTF-8"))?.to_owned());
        }
    }
    targets.sort();
    Ok(targets)
}
