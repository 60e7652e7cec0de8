//! Tests that modules have no circular dependencies: modules of a folder that use each other, directly or through other
//! modules, can only be understood together.
//!
//! A module includes its submodules, and tests in a file do not count. If a module uses a name from its parent and the
//! parent takes this name from a third module, the first module depends on the third. A name that the parent defines
//! itself causes no circle, because the modules of a folder share the types of their parent.

use std::collections::{BTreeMap, BTreeSet};

use mdle_tests::repository::{TextFile, files, names_from};

/// The modules of a folder. Each has its own text and the texts of its submodules, each with its depth below the
/// module.
type Modules = BTreeMap<String, Vec<(usize, String)>>;

#[test]
fn modules_use_each_other_in_no_circle() {
    let sources: Vec<_> = files(&[".rs"]).into_iter().filter_map(without_tests).collect();
    let mut folders = BTreeSet::new();
    for file in &sources {
        let parts: Vec<_> = file.path.split('/').collect();
        let source = parts.iter().position(|part| *part == "src").unwrap_or(parts.len());
        folders.extend((source + 1..parts.len()).map(|end| parts[..end].join("/")));
    }
    let found: Vec<_> = folders.iter().flat_map(|folder| circles(folder, &sources)).collect();
    assert_eq!(found, [""; 0], "move what both need into a module of its own, or into the parent");
}

/// Returns the file without its tests, or `None` for a test file and for a file outside the `src` of all packages.
fn without_tests(file: TextFile) -> Option<TextFile> {
    let is_test =
        file.path.ends_with("/tests.rs") || file.path.contains("/tests/") || file.path.ends_with("/samples.rs");
    let text = file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().to_owned();
    (file.path.contains("/src/") && !is_test).then_some(TextFile { text, ..file })
}

/// Returns the circular dependencies among the modules of a folder.
fn circles(folder: &str, sources: &[TextFile]) -> Vec<String> {
    let mut modules = Modules::new();
    let mut parent = String::new();
    let own =
        [format!("{folder}.rs"), format!("{folder}/mod.rs"), format!("{folder}/lib.rs"), format!("{folder}/main.rs")];
    for file in sources {
        if own.contains(&file.path) {
            parent += &file.text;
        } else if let Some(inside) = file.path.strip_prefix(&format!("{folder}/")) {
            let inside = inside.trim_end_matches(".rs").trim_end_matches("/mod");
            let name = inside.split('/').next().unwrap_or_default().to_owned();
            modules.entry(name).or_default().push((inside.matches('/').count(), file.text.clone()));
        }
    }
    // Names that the parent takes from each of its modules.
    let shared: BTreeMap<_, _> = modules.keys().map(|name| (name.as_str(), names_from(&parent, name))).collect();
    let root = folder.split_once("src").map_or("", |(_, inside)| inside).replace('/', "::");
    let uses: BTreeMap<_, BTreeSet<_>> = modules
        .iter()
        .map(|(module, texts)| {
            let names: BTreeSet<_> = texts
                .iter()
                .flat_map(|(depth, text)| {
                    let above = ["super"].repeat(depth + 1).join("::");
                    [names_from(text, &above), names_from(text, &format!("crate{root}"))].concat()
                })
                .collect();
            let is_used =
                |other: &&str| names.contains(*other) || shared[*other].iter().any(|name| names.contains(name));
            (module.as_str(), shared.keys().copied().filter(|other| other != module).filter(is_used).collect())
        })
        .collect();
    let reached: BTreeMap<_, _> = uses.keys().map(|module| (*module, reached(module, &uses))).collect();
    let circle = |module: &&&str| -> Vec<&str> {
        let others = reached[**module].iter().filter(|other| reached[**other].contains(**module));
        others.copied().collect()
    };
    let circles: BTreeSet<_> = uses.keys().map(|module| circle(&module)).filter(|circle| circle.len() > 1).collect();
    circles.into_iter().map(|circle| format!("{folder}: {}", circle.join(", "))).collect()
}

/// Returns the modules that a module uses, directly or through other modules.
fn reached<'m>(from: &str, uses: &BTreeMap<&'m str, BTreeSet<&'m str>>) -> BTreeSet<&'m str> {
    let mut reached = BTreeSet::new();
    let mut left: Vec<_> = uses[from].iter().copied().collect();
    while let Some(module) = left.pop() {
        if reached.insert(module) {
            left.extend(&uses[module]);
        }
    }
    reached
}

#[test]
fn a_circle_is_found_by_way_of_the_parent() {
    let file = |path: &str, text: &str| TextFile { path: path.to_owned(), text: text.to_owned() };
    let sources = [
        file("a/src/lib.rs", "mod one;\nmod two;\nmod three;\npub use one::One;"),
        file("a/src/one.rs", "use crate::two::Two;"),
        file("a/src/two/mod.rs", "mod inner;"),
        file("a/src/two/inner.rs", "use super::super::One;"),
        file("a/src/three.rs", "use crate::One;"),
    ];
    assert_eq!(circles("a/src", &sources), ["a/src: one, two"]);
    assert_eq!(circles("a/src/two", &sources), [""; 0]);
}
