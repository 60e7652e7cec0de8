//! Tests `mdlec emulator`: the real binary builds a robot emulator and becomes its process, and executables run on it.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use mdle_tests::executable::{command, folder, run_mdlec};
use rustix::process::{Pid, Signal, kill_process};

const PLAN: &str = "{ Ahead (bumper)\n  (Atom (wait 3s) (go 20 0))\n}\n";

/// Starts an emulator whose device has the link `line` in `folder`. Returns the emulator and its first line of output.
fn started(folder: &Path, robot: &str) -> (Child, String) {
    let arguments = ["emulator", robot, "--", "--link", "line", "--lockstep", "100ms"];
    let mut emulator = command(folder, &arguments).stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    // The line is empty if the emulator ends first.
    BufReader::new(emulator.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    (emulator, line)
}

fn assert_emulated(robot: &str, name: &str) {
    let folder = folder(&format!("emulator_{robot}"));
    fs::write(folder.join("plan.mdle"), PLAN).unwrap();
    let built = run_mdlec(&folder, &["plan.mdle", "--target", robot]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let (mut emulator, line) = started(&folder, robot);
    let plan = Command::new(folder.join("plan")).args(["--device", "line", "--lockstep"]).current_dir(&folder).output();
    let plan = plan.unwrap();
    // The started process is now the emulator, which ends successfully and removes its link.
    kill_process(Pid::from_child(&emulator), Signal::INT).unwrap();
    assert!(emulator.wait().unwrap().success());
    assert!(line.starts_with(&format!("{name} is at /dev/")), "{line}");
    assert!(fs::symlink_metadata(folder.join("line")).is_err());
    assert_eq!(String::from_utf8_lossy(&plan.stdout), "3.0 s  plan over: wait 3s (plan.mdle:2)\n");
    assert!(plan.status.success(), "{}", String::from_utf8_lossy(&plan.stderr));
}

#[test]
fn plans_run_on_the_emulated_scout() {
    assert_emulated("scout", "the Scout");
}

#[test]
fn plans_run_on_the_emulated_atrv() {
    assert_emulated("atrv", "the ATRV");
}

#[test]
fn arguments_are_those_of_the_emulator() {
    let folder = folder("emulator_arguments");
    let help = run_mdlec(&folder, &["emulator", "atrv", "--", "--help"]);
    let text = String::from_utf8(help.stdout).unwrap();
    assert!(help.status.success() && text.contains("Usage: atrv-emulator [OPTIONS]"), "{text}");
    assert!(text.contains("--marks") && text.contains("--lockstep"), "{text}");
    let version = run_mdlec(&folder, &["emulator", "atrv", "--", "--version"]);
    assert_eq!(String::from_utf8(version.stdout).unwrap(), concat!("atrv-emulator ", env!("CARGO_PKG_VERSION"), "\n"));
    let refused = run_mdlec(&folder, &["emulator", "scout", "--", "--world", "moon"]);
    assert_eq!(refused.status.code(), Some(2), "{}", String::from_utf8_lossy(&refused.stderr));
    assert_eq!(fs::read_dir(folder).unwrap().count(), 0, "the executable stays in the cache");
}
