//! Tests that the README and ARCHITECTURE.md agree with the repository: the first plan, the first command, links and
//! rooms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::book::links;
use mdle_tests::repository::{TextFile, files, root};

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).unwrap()
}

#[test]
fn its_first_plan_is_the_one_in_plans() {
    let readme = readme();
    let shown = readme.split("```\n").nth(1).expect("a block of code");
    let plan = fs::read_to_string(root().join("plans/dock.mdle")).unwrap();
    assert_eq!(code(shown), code(&plan));
}

/// Returns the lines of a plan without comments and empty lines.
fn code(plan: &str) -> Vec<&str> {
    let lines = plan.lines().map(|line| line.split("//").next().unwrap_or_default().trim_end());
    lines.filter(|line| !line.is_empty()).collect()
}

#[test]
fn its_first_command_is_the_tour_that_is_tested() {
    let readme = readme();
    assert!(readme.contains("plans/lab_tour.mdle --target sim"));
    assert!(root().join("plans/lab_tour.mdle").is_file());
}

#[test]
fn a_release_is_tested_with_the_command_that_the_readme_begins_with() {
    let command = "mdle run dock.mdle --target sim";
    assert!(readme().contains(&format!("`{command} --watch`")));
    assert!(fs::read_to_string(root().join(".ci/installed")).unwrap().contains(&format!("{command} --speed max")));
}

#[test]
fn it_is_two_screens_long() {
    let lines = readme().lines().count();
    assert!((60..=110).contains(&lines), "{lines} lines");
}

#[test]
fn links_of_documents_outside_the_book_lead_to_files() {
    let documents = files(&[".md"]).into_iter().filter(|file| !file.path.starts_with("docs/src/"));
    let mut count = 0;
    for document in documents {
        for link in links(&document).into_iter().filter(|link| !link.starts_with("https://")) {
            let path = link.split('#').next().unwrap_or_default();
            assert!(folder(&document).join(path).exists(), "{}: {link}", document.path);
            count += 1;
        }
    }
    assert!(count > 10, "{count} links");
}

/// Returns the folder to which a document's links are relative.
fn folder(document: &TextFile) -> std::path::PathBuf {
    root().join(&document.path).parent().unwrap().to_owned()
}

#[test]
fn rooms_of_the_architecture_exist() {
    let map = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let rooms: Vec<_> = map.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    assert!(rooms.len() > 20, "{rooms:?}");
    let missing: Vec<_> = rooms.iter().filter(|room| !root().join(room).exists()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn the_architecture_names_every_room_of_the_compiler() {
    let map = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    for folder in ["mdlec/src", "mdlec/compiler/src", "mdlec/theory/src"] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let room = if name.ends_with(".rs") { format!("`{folder}/{name}`") } else { format!("`{folder}/{name}/`") };
            let is_room = !["lib.rs", "main.rs", "samples.rs", "diagnostic.rs"].contains(&name.as_str());
            assert!(!is_room || map.contains(&room), "{room} is missing in ARCHITECTURE.md");
        }
    }
}
