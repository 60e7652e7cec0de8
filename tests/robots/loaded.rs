//! Compares `mdle run` with the executable of the same plan: report, messages, log and trail are identical byte for
//! byte, and the exit statuses are equal.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;
use mdle_tests::run_output::{
    FILES, RunOutput, called, emulated_run, in_simulator, left, loaded, simulated_run, warnings,
};

/// Runs the plan in a file, loaded and as an executable, with the same options, and compares the output and files of
/// both runs. The warnings about the plan, which `mdlec` prints at build time, are added to the messages of the
/// executable.
fn compare(folder: &Path, file: &str, target: &str, options: &[&str]) -> RunOutput {
    let run = |command| simulated_run(folder, command, options);
    let mut executable = run(Command::new(folder.join("executable")));
    executable.err.insert_str(0, &warnings(folder, file, target));
    let loaded = run(loaded(file, target));
    assert_eq!(loaded, executable, "{file} {target} {options:?}");
    loaded
}

/// Builds the executable of the plan in a file.
fn build(folder: &Path, file: &str, target: &str) {
    let built = run_mdlec(folder, &[file, "--target", target, "-o", "executable"]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
}

/// Returns the plan files of the repository.
fn plans() -> Vec<PathBuf> {
    let folders = ["plans", "plans/paper"].map(|folder| root().join(folder));
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap()).map(|entry| entry.unwrap().path());
    let mut plans: Vec<_> = files.filter(|file| file.extension().is_some_and(|ending| ending == "mdle")).collect();
    plans.sort();
    plans
}

#[test]
fn every_plan_runs_as_its_executable_does() {
    let folder = folder("plans");
    let (mut linked, mut in_an_engine) = (0, 0);
    for plan in plans() {
        let file = plan.to_str().unwrap();
        let checked = run_mdlec(&folder, &["check", file, "--target", "sim"]);
        assert!(checked.status.success(), "{file}: {}", String::from_utf8_lossy(&checked.stderr));
        if fs::read_to_string(&plan).unwrap().contains("sync robot") {
            let built = String::from_utf8(run_mdlec(&folder, &[file, "--target", "sim"]).stderr).unwrap();
            assert!(built.contains("error[E0403]: `sync` needs the state link, and an executable has none"), "{built}");
            let loaded = loaded(file, "sim").current_dir(&folder).output().unwrap();
            let refused = String::from_utf8(loaded.stderr).unwrap();
            assert!(loaded.status.code() == Some(2) && refused.contains("there is no link to it"), "{refused}");
            linked += 1;
            continue;
        }
        if fs::read_to_string(&plan).unwrap().contains("heading module") {
            let built = run_mdlec(&folder, &[file, "--target", "sim"]);
            assert!(String::from_utf8(built.stderr).unwrap().starts_with("error[E0403]"), "{file}");
            let mut command = loaded(file, "sim");
            command.args(["--speed", "max", "--timeout", "20", "--point", "3,0"]).args(["--log", FILES[0]]);
            let run = left(&folder, &called(&command), command.current_dir(&folder).output().unwrap());
            assert_eq!(run.status, Some(4), "{file}: {}", run.err);
            assert!(run.files[0].as_ref().is_some_and(|log| log.contains("goAvoid heading module")), "{file}: {run:?}");
            in_an_engine += 1;
            continue;
        }
        build(&folder, file, "sim");
        for body in ["ideal", "scout", "atrv"] {
            let RunOutput { status, files, out, .. } = compare(&folder, file, "sim", &in_simulator(body, "7"));
            assert!([Some(0), Some(4)].contains(&status), "{file} {body}: {out}");
            assert!(files.iter().all(|file| file.as_ref().is_some_and(|text| text.len() > 1000)), "{file} {body}");
        }
    }
    assert_eq!((linked, in_an_engine), (2, 1), "plans of the paper for several robots, and for an engine");
}

#[test]
fn several_runs_are_those_of_the_executable() {
    let folder = folder("batch");
    let plan = root().join("plans/dock.mdle");
    build(&folder, plan.to_str().unwrap(), "sim");
    let options = ["--runs", "4", "--start-noise", "0.2,5", "--timeout", "30", "--json"];
    compare(&folder, plan.to_str().unwrap(), "sim", &options);
}

#[test]
fn a_run_on_an_emulated_robot_is_that_of_the_executable() {
    let file = root().join("plans/lab_tour.mdle");
    let file = file.to_str().unwrap();
    for target in ["scout", "atrv"] {
        let folder = folder(target);
        build(&folder, file, target);
        let run = |command| emulated_run(&folder, target, command, "200");
        let executable = run(Command::new(folder.join("executable")));
        assert_eq!(run(loaded(file, target)), executable, "{target}");
        assert_eq!(executable.status, Some(0), "{executable:?}");
    }
}
