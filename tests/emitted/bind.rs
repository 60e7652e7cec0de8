//! Tests `mdlec bind`, through the real binary: a target must match its alphabet, and a plan must match both.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::{files, root};

const ALPHABET: &str = include_str!("../rover/alphabet.mdle");
const MANIFEST: &str = "[workspace]\n\n[package]\nname = \"mdle-rover\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
                        [dependencies]\nmdle-runtime = \"0.2\"\nmdle-host = \"0.2\"\n";
const PLAN: &str = "{ Main (low 11) (Atom (low 13) count -3) (Atom (low) count 5) }\n";

/// Returns a folder with a plan and, beside it, the target `rover` with this alphabet and without bindings.
fn with_rover(test: &str, alphabet: &str) -> PathBuf {
    let folder = folder(test);
    fs::create_dir_all(folder.join("rover/src")).unwrap();
    let write = |file: &str, text: &str| fs::write(folder.join(file), text).unwrap();
    write("plan.mdle", PLAN);
    write("rover/alphabet.mdle", alphabet);
    write("rover/Cargo.toml", MANIFEST);
    write("rover/src/lib.rs", include_str!("../rover/lib.rs"));
    write("rover/src/quarks.rs", include_str!("../rover/quarks.rs"));
    folder
}

fn bind(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    message(&run_mdlec(folder, &[&["bind", "rover/alphabet.mdle"], arguments].concat()))
}

fn built(folder: &Path) -> (Option<i32>, String) {
    message(&run_mdlec(folder, &["plan.mdle", "--target", "rover"]))
}

fn message(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn the_alphabets_of_this_repository_are_bound() {
    // The test below binds the rover, in its own folder.
    let own = files(&["alphabet.mdle"]).into_iter().filter(|file| !file.path.starts_with("tests/rover/"));
    let own: Vec<_> = own.collect();
    assert!(own.len() >= 2 && own.iter().any(|file| file.path == "atoms/alphabet.mdle"), "{own:?}");
    for file in own {
        let (status, message) = message(&run_mdlec(&root(), &["bind", "--check", &file.path]));
        assert_eq!(status, Some(0), "{message}");
    }
}

#[test]
fn a_bound_target_runs_plans() {
    let folder = with_rover("bound", ALPHABET);
    assert_eq!(bind(&folder, &[]), (Some(0), "rover/src/alphabet.rs is written\n".into()));
    assert_eq!(bind(&folder, &[]), (Some(0), "rover/src/alphabet.rs is up to date\n".into()));
    let (status, message) = built(&folder);
    assert_eq!(status, Some(0), "{message}");
    let ran = Command::new(folder.join("plan")).output().unwrap();
    let printed = String::from_utf8(ran.stdout).unwrap();
    insta::assert_snapshot!(printed, @r"
    0.05 s  count 5 (plan.mdle:1)  <- low 13 (plan.mdle:1)
    0.15 s  plan over: low 11 (plan.mdle:1)
    ");
}

#[test]
fn a_target_that_is_not_bound_or_bound_to_another_alphabet_is_not_built() {
    let folder = with_rover("unbound", ALPHABET);
    let mut report = vec![("bind --check", bind(&folder, &["--check"])), ("plan", built(&folder))];
    assert_eq!(bind(&folder, &[]).0, Some(0));
    let changed = ALPHABET.replace("10.8", "11.5");
    fs::write(folder.join("rover/alphabet.mdle"), changed).unwrap();
    report.extend([("bind --check", bind(&folder, &["--check"])), ("plan", built(&folder))]);
    let report: Vec<_> =
        report.iter().map(|(what, (status, message))| format!("$ {what}: {status:?}\n{message}")).collect();
    insta::assert_snapshot!(report.join("\n"));
    assert!(!folder.join("plan").exists());
}

#[test]
fn an_alphabet_that_lies_fails_the_build_of_its_target() {
    let folder = with_rover("lie", &ALPHABET.replace("limit: voltage V", "limit: length m"));
    assert_eq!(bind(&folder, &[]).0, Some(0));
    fs::write(folder.join("plan.mdle"), "{ Main (low 11) (Atom (low 13) count -3) }").unwrap();
    let (status, message) = built(&folder);
    assert_eq!(status, Some(2), "{message}");
    let sentence = "error: the target crate `mdle_rover` does not compile; this is not a fault of your plan:\n";
    assert!(message.contains(sentence), "{message}");
    for report in
        ["error[E0308]: mismatched types", "src/alphabet.rs", "Low::new(limit)", "expected `Volts`, found `Meters`"]
    {
        assert!(message.contains(report), "{report}:\n{message}");
    }
}

#[test]
fn a_wrong_plan_has_its_place_in_both_files() {
    let folder = with_rover("misfit", ALPHABET);
    fs::write(folder.join("plan.mdle"), "{ Main (low 2s) (Atom (null) count 0.5) }").unwrap();
    let (status, message) = built(&folder);
    assert_eq!(status, Some(1));
    insta::assert_snapshot!(message);
}

#[test]
fn what_cannot_be_bound_is_an_error() {
    let folder = with_rover("no_target", "target rover : crate mdle_rover;\ncontrol f(a: speed parsec);\n");
    let broken = bind(&folder, &[]);
    fs::remove_file(folder.join("rover/alphabet.mdle")).unwrap();
    let report: Vec<_> = [broken, bind(&folder, &[])].map(|(status, message)| format!("{status:?}\n{message}")).into();
    insta::assert_snapshot!(report.join("\n"));
    assert!(!folder.join("rover/src/alphabet.rs").exists());
}
