//! Tests the applications of the book whose build scripts compile a plan, built and run by the real cargo.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::{Mutex, PoisonError};

use mdle_tests::book::{Fence, fences, name, pages};
use mdle_tests::executable::folder;
use mdle_tests::outside;
use mdle_tests::repository::root;

/// Locked by a test while it builds the application, because all tests share its folder and its executable.
static BUILDING: Mutex<()> = Mutex::new(());

/// Writes the application of `embedding.md`: that of `tests/application`, but with a manifest of its own.
fn application() -> (PathBuf, Vec<Fence>) {
    written("application", "embedding.md")
}

/// Writes the application of a page, as a reader does. Returns its folder and the blocks of the page.
fn written(test: &str, chapter: &str) -> (PathBuf, Vec<Fence>) {
    let folder = folder(test);
    let page = pages().into_iter().find(|page| name(page) == chapter).expect("a chapter");
    let fences = fences(&page);
    for (file, fence) in fences.iter().filter_map(|fence| Some((fence.file()?, fence))) {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, &fence.text).unwrap();
    }
    // The checkout is not a sibling of the application's folder; it contains this folder.
    let elsewhere = format!("path = \"{}/", root().to_str().unwrap());
    change(&folder.join("Cargo.toml"), "path = \"../mdle/", &elsewhere);
    change(&folder.join("Cargo.toml"), "\n[dependencies]", "\n[workspace]\n\n[dependencies]");
    outside::adopt(&folder);
    (folder, fences)
}

/// Builds and runs the application.
fn run(folder: &Path) -> Output {
    cargo_run(folder, "--quiet", &["--speed", "max"])
}

fn cargo_run(folder: &Path, loudness: &str, arguments: &[&str]) -> Output {
    outside::cargo(folder, &["run", loudness, "--"]).args(arguments).output().expect("cargo runs")
}

/// Returns the output of the application; asserts that the build prints no messages.
fn printed(folder: &Path) -> String {
    let output = run(folder);
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!((output.status.code(), err.as_str()), (Some(0), ""));
    out
}

/// Replaces a text in a file.
fn change(file: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(from), "{text}");
    fs::write(file, text.replace(from, to)).unwrap();
}

#[test]
fn an_application_runs_its_plan_and_is_built_anew_when_a_file_of_it_changes() {
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let (folder, fences) = application();
    let first = printed(&folder);
    let shown = fences.iter().find(|fence| fence.words == ["text", "output"]).expect("what it prints");
    assert_eq!(format!("$ cargo run -- --speed max\n{first}"), shown.text);

    // A file that the plan uses.
    let sides = folder.join("plans/sides.mdle");
    change(&sides, "turn 180", "turn 90");
    let second = printed(&folder);
    assert!(second.contains(" turn 90 ") && !second.contains("180"), "{second}");

    // An error in it stops the build, and nothing else is printed.
    change(&sides, "turn 90", "tern 90");
    let output = run(&folder);
    assert_eq!(output.status.code(), Some(101));
    let message = String::from_utf8(output.stderr).unwrap();
    let (cargo, script) = message.split_once("--- stderr\n").expect(&message);
    assert!(cargo.contains("(exit status: 1)") && !cargo.contains("--- stdout"), "{cargo}");
    insta::assert_snapshot!(script);

    // With the error corrected, only a warning is left, which cargo prints.
    change(&sides, "tern 90", "turn 180");
    change(&sides, "(null)", "(bumper)");
    let output = cargo_run(&folder, "--color=never", &["--speed", "max"]);
    assert_eq!(output.status.code(), Some(0));
    let message = String::from_utf8(output.stderr).unwrap();
    insta::assert_snapshot!(
        message.lines().filter(|line| line.starts_with("warning: ")).collect::<Vec<_>>().join("\n")
    );
}

#[test]
fn an_application_calls_its_plan_from_its_own_loop() {
    let (folder, fences) = written("own_loop", "own_loop.md");
    let output = cargo_run(&folder, "--quiet", &[]);
    let (out, err) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert_eq!((output.status.code(), err.as_str()), (Some(0), ""), "{out}");
    let shown = fences.iter().find(|fence| fence.words == ["text", "output"]).expect("what it prints");
    assert_eq!(format!("$ cargo run\n{out}"), shown.text);
}

#[test]
fn missing_arguments_are_named_for_build_scripts() {
    let _alone = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let (folder, _) = application();
    let mut report = String::new();
    let script = folder.join("build.rs");
    let good = fs::read_to_string(&script).unwrap();
    for wrong in [".target(\"sin\")", "", ".target(\"sim\").plan(\"Rond\")"] {
        fs::write(&script, good.replace(".target(\"sim\")", wrong)).unwrap();
        let message = String::from_utf8(run(&folder).stderr).unwrap();
        let (_, message) = message.split_once("--- stderr\n").expect(&message);
        report += &format!("{wrong}\n{message}\n");
    }
    insta::assert_snapshot!(report);
}
