//! Packages outside the workspace, as readers of the book write them. They are built with the libraries that were
//! compiled for the workspace.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use toml::Table;

use crate::executable::target;
use crate::repository::root;

/// Uncomments the patch in a new target's manifest and points it to this checkout, as a reader of the book does.
///
/// # Panics
///
/// If the manifest cannot be read or written, or has no such patch.
pub fn patch(package: &Path) {
    let manifest = package.join("Cargo.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    assert!(text.contains("# [patch") && text.contains("path = \"../mdle/"), "{text}");
    let text = text.replace("# [patch", "[patch").replace("# mdle-", "mdle-");
    let here = format!("path = \"{}/", root().to_str().unwrap());
    fs::write(manifest, text.replace("path = \"../mdle/", &here)).unwrap();
    adopt(package);
}

/// Copies the lock file and the profile of the workspace into a package, so that most libraries that were compiled for
/// the workspace are not compiled again.
///
/// # Panics
///
/// If the package or the repository cannot be read or written.
pub fn adopt(package: &Path) {
    // With this lock file, no network is needed.
    fs::copy(root().join("Cargo.lock"), package.join("Cargo.lock")).unwrap();
    let manifest = package.join("Cargo.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, format!("{text}\n{}", profile(&needed(package)))).unwrap();
}

/// Returns the names of the packages that the build of a package includes.
fn needed(package: &Path) -> BTreeSet<String> {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let command = command.args(["tree", "--offline", "--prefix", "none", "--format", "{p}"]).current_dir(package);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = String::from_utf8(output.stdout).unwrap();
    lines.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

/// Returns the part of the workspace's development profile that concerns these packages. Packages of this repository
/// are not members of the other workspace, but get the debug information of members.
fn profile(needed: &BTreeSet<String>) -> Table {
    let manifest: Table = fs::read_to_string(root().join("Cargo.toml")).unwrap().parse().unwrap();
    let mut profile = manifest["profile"]["dev"].as_table().unwrap().clone();
    let debug = profile["debug"].clone();
    let packages = profile["package"].as_table_mut().unwrap();
    let dependencies = manifest["workspace"]["dependencies"].as_table().unwrap();
    for (name, _) in dependencies.iter().filter(|(_, dependency)| dependency.get("path").is_some()) {
        let package = packages.entry(name).or_insert_with(|| Table::new().into()).as_table_mut().unwrap();
        package.insert("debug".to_owned(), debug.clone());
    }
    packages.retain(|name, _| name == "*" || needed.contains(name));
    let dev = Table::from_iter([("dev".to_owned(), profile.into())]);
    Table::from_iter([("profile".to_owned(), dev.into())])
}

/// Returns a command of cargo with these arguments for a package, without network access.
#[must_use]
pub fn cargo(package: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args([arguments[0], "--offline", "--target-dir"]).arg(target()).args(&arguments[1..]);
    command.current_dir(package);
    command
}
