//! The folders of the targets that are part of mdlec, for the build scripts that pack their files.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Folder below `targets` that contains no robot, but the template for `mdlec new-target`.
const TEMPLATE: &str = "template";

/// The folder of the sources in a published package, which `.ci/package` writes, and the name of a manifest there:
/// cargo leaves a folder with a `Cargo.toml` out of a package.
const PACKED: &str = "packed";
const PACKED_MANIFEST: &str = "manifest.toml";

/// Returns the folder of the sources: the packed sources of a published package, or else the checkout, at the path `up`
/// from the package.
pub(crate) fn checkout(up: &str) -> Result<PathBuf, Box<dyn Error>> {
    let package = PathBuf::from(env::var("CARGO_MANIFEST_DIR")?);
    let packed = package.join(PACKED);
    Ok(if packed.is_dir() { packed } else { package.join(up).canonicalize()? })
}

/// Returns the manifest of the package in a folder of the sources, if the folder is a package.
pub(crate) fn manifest(folder: &Path) -> Option<PathBuf> {
    ["Cargo.toml", PACKED_MANIFEST].map(|name| folder.join(name)).into_iter().find(|path| path.is_file())
}

/// The folders below `targets` that are packages with an alphabet, the template aside.
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
