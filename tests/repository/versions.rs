//! Tests that all packages, the CHANGELOG and the book have the version number of the workspace.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::repository::{files, root};
use toml::{Table, Value};

/// Version of the workspace, which is also that of this package.
const NUMBER: &str = env!("CARGO_PKG_VERSION");

/// Packages that users copy or write, and whose versions users choose.
const OF_USERS: [&str; 3] = ["runtime/template/", "targets/template/", "tests/application/"];

/// Files of the editors' packages. In each, the first `"version"` is that of the package.
const EDITORS: [&str; 3] =
    ["editors/test/package.json", "editors/tree-sitter/tree-sitter.json", "editors/vscode/package.json"];

fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap()
}

#[test]
fn all_packages_have_one_version() {
    let mut others = Vec::new();
    for file in files(&["Cargo.toml"]) {
        let manifest: Table = file.text.parse().unwrap();
        let version = |table: Option<&Value>| table.and_then(|table| table.get("version")).cloned();
        let own = manifest.get("package").filter(|_| !OF_USERS.iter().any(|room| file.path.starts_with(room)));
        let mut versions: Vec<_> = version(own).into_iter().filter(Value::is_str).collect();
        if let Some(workspace) = manifest.get("workspace") {
            versions.extend(version(workspace.get("package")));
            let dependencies = workspace.get("dependencies").and_then(Value::as_table).into_iter().flatten();
            let siblings = dependencies.filter(|(_, dependency)| dependency.get("path").is_some());
            versions.extend(siblings.filter_map(|(_, dependency)| version(Some(dependency))));
        }
        let wrong = versions.iter().filter_map(Value::as_str).filter(|version| *version != NUMBER);
        others.extend(wrong.map(|version| format!("{}: {version}", file.path)));
    }
    for path in EDITORS {
        let file = text(path);
        let line = file.lines().find(|line| line.contains("\"version\": ")).expect(path);
        others.extend((!line.contains(&format!("\"{NUMBER}\""))).then(|| format!("{path}: {line}")));
    }
    assert_eq!(others, [""; 0], "the version is {NUMBER}, that of the workspace");
}

#[test]
fn the_newest_version_is_described() {
    let changes = text("CHANGELOG.md");
    let newest = changes.lines().find_map(|line| line.strip_prefix("## ")).expect("a version");
    assert_eq!(newest.split([',', ' ']).next(), Some(NUMBER));
}

#[test]
fn files_of_a_release_have_its_number() {
    let page = text("docs/src/install.md");
    for file in [format!("mdle_{NUMBER}_amd64.deb"), format!("mdle-{NUMBER}-x86_64-linux.tar.gz")] {
        assert!(page.contains(&file), "install.md does not name {file}");
    }
}
