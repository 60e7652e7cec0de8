//! Tests plans that use other files, through the real binary: paths are relative to the file that names them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::PathBuf;

use mdle_tests::executable::{folder, run_mdlec};

const MAIN: &str = "use \"parts/legs.mdle\"\n{ Main Leg(2) }\n";
const LEGS: &str = "use \"deep/turns.mdle\"\n{ Leg (n: count) ExecPlan n { Corner } }\n";
const TURNS: &str = "\u{feff}{ Corner (Atom (null) turn 90) }\n";

fn with_files(test: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = folder(test);
    for (name, text) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// Returns standard output and standard error of mdlec in this folder, and its exit status.
fn message(folder: &std::path::Path, arguments: &[&str]) -> String {
    let output = run_mdlec(folder, arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    format!("{}{}exit status {}\n", text(output.stdout), text(output.stderr), output.status.code().unwrap())
}

#[test]
fn files_in_folders_make_one_plan() {
    let files = [("main.mdle", MAIN), ("parts/legs.mdle", LEGS), ("parts/deep/turns.mdle", TURNS)];
    let folder = with_files("used", &files);
    let plan =
        "{ Main\n  { Leg\n    ExecPlan 2 {\n      { Corner\n        (Atom (null) turn 90)\n      }\n    }\n  }\n}\n";
    assert_eq!(message(&folder, &["main.mdle", "--emit", "plan"]), format!("{plan}exit status 0\n"));
    // From another folder the plan is the same, and each of its plans can be selected.
    let above = folder.parent().unwrap();
    let main = format!("{}/main.mdle", folder.file_name().unwrap().to_str().unwrap());
    assert_eq!(message(above, &[&main, "--emit", "plan"]), format!("{plan}exit status 0\n"));
    let corner = message(&folder, &["main.mdle", "--emit", "plan", "--plan", "Corner"]);
    assert_eq!(corner, "{ Corner\n  (Atom (null) turn 90)\n}\nexit status 0\n");
    assert_eq!(message(&folder, &["check", "main.mdle", "parts/legs.mdle"]), "exit status 0\n");
}

#[test]
fn files_that_cannot_be_used() {
    let files = [
        ("main.mdle", "use \"no.mdle\" use \"parts\" use \"parts/latin.mdle\" use \"loop.mdle\"\n{ Main Leg }\n"),
        ("loop.mdle", "use \"./parts/../main.mdle\"\n{ Loop (Atom (wait 1) stop) }\n"),
        ("parts/latin.mdle", ""),
    ];
    let folder = with_files("unusable", &files);
    fs::write(folder.join("parts/latin.mdle"), b"{ \xE9 }").unwrap();
    insta::assert_snapshot!(message(&folder, &["check", "main.mdle"]));
}

#[test]
fn a_file_of_plans_with_parameters_can_be_checked_and_not_run() {
    let folder = with_files("library", &[("legs.mdle", "{ Leg (n: count) (Atom (wait 1) stop)^n }\n")]);
    assert_eq!(message(&folder, &["check", "legs.mdle"]), "exit status 0\n");
    insta::assert_snapshot!(
        message(&folder, &["legs.mdle", "--emit", "plan"])
            + &message(&folder, &["legs.mdle", "--emit", "plan", "--plan", "Leg"])
    );
}
