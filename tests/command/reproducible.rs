//! Tests that executables of equal texts are identical byte for byte, regardless of the plan's folder and of earlier
//! builds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};

use mdle_tests::executable::{cache, folder, run_mdlec};

/// Builds a plan that uses another plan, and returns the executable. `name` is the name of the plan; different
/// `milliseconds` give different texts.
fn build(folder: &Path, name: &str, milliseconds: u32) -> Vec<u8> {
    let plan = format!("use \"legs.mdle\"\n{{ Rest (wait {milliseconds}ms) Legs }}\n");
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join(format!("{name}.mdle")), plan).unwrap();
    fs::write(folder.join("legs.mdle"), "{ Legs (Atom (bumper) (go 20 0)) }\n").unwrap();
    let built = run_mdlec(folder, &["build", &format!("{name}.mdle"), "--target", "sim"]);
    assert_eq!(built.status.code(), Some(0), "{}", String::from_utf8_lossy(&built.stderr));
    fs::read(folder.join(name)).unwrap()
}

/// Returns the paths below `folder`, in the cache, that belong to plans with this name.
fn stored(folder: &Path, name: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        let file = path.file_name().unwrap().to_str().unwrap();
        if file.replace('_', "-").starts_with(&format!("plan-{name}-")) {
            found.push(path);
        } else if path.is_dir() {
            found.extend(stored(&path, name));
        }
    }
    found
}

#[test]
fn equal_texts_give_equal_executables() {
    let folder = folder("equal");
    let (left, right) = (folder.join("left"), folder.join("a longer/name for the folder"));
    let first = build(&left, "again", 1);
    assert_ne!(build(&left, "again", 2), first);
    assert_eq!(build(&left, "again", 1), first, "edited back");
    assert_ne!(build(&right, "again", 3), first);
    assert_eq!(build(&right, "again", 1), first, "elsewhere");
}

#[test]
fn an_edit_removes_what_was_built_before() {
    let folder = folder("edit");
    build(&folder, "edited", 1);
    let first = stored(&cache(), "edited");
    build(&folder, "edited", 2);
    let second = stored(&cache(), "edited");
    assert!(first.len() >= 4 && first.len() == second.len(), "{first:?} {second:?}");
    assert!(first.iter().all(|path| !second.contains(path)), "{first:?} {second:?}");
}
