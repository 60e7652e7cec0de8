//! Tests the recorder of a session: a record begins and ends while the robot drives.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;

use mdle_tests::executable::{folder, mdle};

use crate::mdle_shell::dialogue;

/// Returns the lines that `mdle log export --csv` prints for a record, without the header.
fn rows(folder: &Path, record: &str) -> Vec<String> {
    let output = Command::new(mdle()).args(["log", "export", "--csv", record]).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().skip(1).map(str::to_owned).collect()
}

#[test]
fn a_record_begins_and_ends_while_the_robot_drives() {
    let folder = folder("recorder");
    fs::write(folder.join("plan.mdle"), "{ Ahead (bumper)\n  (Atom (wait 60s) (go 20 0))\n}\n").unwrap();
    fs::write(folder.join("there.mcap"), "mine").unwrap();
    let commands = "step 3\ncall /recorder/stop\nget /recorder/file\ncall /recorder/start\ncall /recorder/start part\n\
                    call /recorder/start there.mcap\ncall /recorder/start no/part.mcap\n\
                    call /recorder/start part.mcap\nget /recorder/file\nget /recorder/state\nstep 10\n\
                    get /recorder/turns\nget /recorder/dropped\ncall /recorder/start other.mcap\n\
                    call /recorder/stop\nget /recorder/state\nstep 5\ncall /recorder/start end.mcap\nstep 2\n";
    insta::assert_snapshot!(dialogue(&folder, &["--log", "whole.mcap"], commands));
    let whole = rows(&folder, "whole.mcap");
    assert_eq!((rows(&folder, "part.mcap"), rows(&folder, "end.mcap")), (whole[3..13].to_vec(), whole[18..].to_vec()));
    assert_eq!(fs::read_to_string(folder.join("there.mcap")).unwrap(), "mine");
    let replay = Command::new(mdle()).args(["replay", "part.mcap"]).current_dir(&folder).output().unwrap();
    let refused = String::from_utf8(replay.stderr).unwrap();
    assert_eq!(replay.status.code(), Some(2), "{refused}");
    assert!(refused.starts_with("error: the record part.mcap begins in the middle of a run"), "{refused}");
}

#[test]
fn a_robot_with_errors_is_recorded() {
    let folder = folder("recorder_body");
    fs::write(folder.join("plan.mdle"), "{ Ahead (bumper)\n  (Atom (wait 60s) (go 20 0))\n}\n").unwrap();
    let commands = "step 3\ncall /recorder/start part.mcap\nstep 10\ncall /recorder/stop\n";
    let answer = dialogue(&folder, &["--body", "scout", "--seed", "7"], commands);
    assert!(answer.contains("10 turns in part.mcap"), "{answer}");
    assert_eq!(rows(&folder, "part.mcap").len(), 10);
}

#[test]
fn only_an_admin_may_record() {
    let folder = folder("recorder_role");
    fs::write(folder.join("plan.mdle"), "{ Ahead (bumper)\n  (Atom (wait 60s) (go 20 0))\n}\n").unwrap();
    let refused = dialogue(&folder, &["--role", "swap"], "call /recorder/start part.mcap\n");
    assert!(refused.contains("admin") && refused.ends_with("[1]\n") && !folder.join("part.mcap").exists(), "{refused}");
}

/// The recorder counts the turns that are in the file, if the file cannot be written to its end.
#[test]
fn turns_that_the_file_lacks_are_not_counted() {
    let folder = folder("recorder_limit");
    fs::write(folder.join("plan.mdle"), "{ Ahead (bumper)\n  (Atom (wait 60s) (go 0 0.1))\n}\n").unwrap();
    fs::write(folder.join("session"), "call /recorder/start part.mcap\nstep 400\nget /recorder/turns\n").unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -f 128; exec \"$@\"", "sh"]).arg(mdle());
    shell.args(["shell", "plan.mdle", "--target", "sim", "--speed", "max", "--paused", "-c", "session"]);
    let output = shell.current_dir(&folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    let turns: usize = out.lines().last().unwrap().parse().unwrap();
    assert!((1..400).contains(&turns), "{out}{err}");
    let warning = format!("warning: the record part.mcap ends here, with {turns} turns, as it cannot be written: ");
    assert!(err.contains(&warning), "{err}");
    assert_eq!(rows(&folder, "part.mcap").len(), turns);
}
