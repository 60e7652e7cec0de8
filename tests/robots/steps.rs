//! Tests `mdle replay --step`, which shows the turns of a record one by one, forward and back.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use mdle_tests::executable::{folder, mdle};

/// Returns a folder with the record of a session under a safety rule.
fn recorded(test: &str) -> PathBuf {
    let folder = folder(&format!("steps-{test}"));
    fs::write(
        folder.join("go.mdle"),
        "{ Go (wait 2s)\n  ((Atom (wait 300ms) (go 60 0)) (Atom (wait 200ms) stop))^inf\n}\n",
    )
    .unwrap();
    fs::write(folder.join("rules.toml"), "[limits]\nspeed = \"40cm/s\"\n").unwrap();
    let commands = "step 8\nset /safety/limits/speed 20cm/s\nset /usr/mdle/main { Typed (wait 1s) (Atom (null) (go 0 0.5)) }\nwait\n";
    fs::write(folder.join("commands"), commands).unwrap();
    let run =
        "shell go.mdle --target sim --world hall --speed max --safety rules.toml --paused -c commands --log run.mcap";
    let output = Command::new(mdle()).args(run.split(' ')).current_dir(&folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder
}

/// Returns the answers to these commands, and the exit status.
fn dialogue(folder: &Path, arguments: &str, commands: &str) -> String {
    let mut command = Command::new(mdle());
    command.args(arguments.split(' ')).current_dir(folder);
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(commands.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}---\n{err}[{}]\n", output.status.code().unwrap())
}

#[test]
fn turns_are_shown_forth_and_back() {
    let folder = recorded("shown");
    insta::assert_snapshot!(dialogue(
        &folder,
        "replay --step run.mcap",
        "step\n\nnext\nback 2\nback 100\nto 0.55\nto 800ms\nnext\nstep 100\nback\nhelp\nquit\nstep\n"
    ));
    assert_eq!(
        dialogue(&folder, "replay --step run.mcap --until 0", "next\n"),
        "turn 0 at 0.0 s  go 60 0
  request: call /clock/step 8
  safety: limited: speed
  asked for 0.6 m/s, 0 rad/s; speed changed it
  sent 0.4 m/s, 0 rad/s
no turn follows up to that time
turn 0 at 0.0 s  go 60 0
  request: call /clock/step 8
  safety: limited: speed
  asked for 0.6 m/s, 0 rad/s; speed changed it
  sent 0.4 m/s, 0 rad/s
---
[0]
"
    );
}

#[test]
fn wrong_commands_of_steps_are_refused() {
    let folder = recorded("refused");
    insta::assert_snapshot!(dialogue(
        &folder,
        "replay --step run.mcap",
        "stepp\nstep 0\nback x\nto\nto now\nnext 3\nhelp me\n"
    ));
    let both = dialogue(&folder, "replay --step -", "step\n");
    assert!(both.ends_with("[2]\n"), "{both}");
    fs::write(folder.join("steps"), "step\nquit\n").unwrap();
    let file = dialogue(&folder, "replay --step run.mcap -c steps", "");
    assert!(file.starts_with("turn 0 at 0.0 s") && file.ends_with("\n---\n[0]\n"), "{file}");
    assert!(file.contains("\nturn 1 at 0.1 s"), "{file}");
}

/// Each step is compared with the record: if another plan differs in a turn, the exit status is 1.
#[test]
fn a_step_says_what_differs() {
    let folder = recorded("differs");
    fs::write(
        folder.join("other.mdle"),
        "{ Go (wait 2s)\n  ((Atom (wait 300ms) (go 60 0)) (Atom (wait 200ms) (go 0 1)))^inf\n}\n",
    )
    .unwrap();
    let text = dialogue(&folder, "replay --step run.mcap --plan other.mdle", "next\n");
    assert!(text.contains("\n  differs: input: recorded 0 m/s, 0 rad/s, replayed 0 m/s, 1 rad/s\n"), "{text}");
    assert!(text.ends_with("[1]\n"), "{text}");
}
