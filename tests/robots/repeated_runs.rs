//! Tests that `mdle log info` prints a command that repeats the run of a record and contains everything that determines
//! the run.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mdle_tests::executable::{folder, mdle};

const FILES: [(&str, &str); 9] = [
    ("square.mdle", "{ Square (wait 5min)\n  ((Atom (way >= 1m OR r0 < 40cm) (go 20 0)) (Atom (null) turn 90))^4\n}\n"),
    ("slow.toml", "[limits]\nspeed = \"18cm/s\"\n"),
    ("commands", "step 20\nset /safety/limits/speed 15cm/s\nwait 5s\n"),
    (
        "set/mdle.toml",
        "target = \"sim\"\nworld = \"hall\"\n\n[modules]\nears = \"exec python3 ears.py\"\n\n[options]\nbody = \"scout\"\n\
         seed = 7\n",
    ),
    (
        "ears.py",
        "import json, sys\nprint(json.dumps({'publishes': {'range': 'cm'}, 'reads': {'sensors/x': 'cm'}}), flush=True)\n\
         for line in sys.stdin:\n    print(json.dumps({'range': 90}), flush=True)\n",
    ),
    (
        "set/heard.mdle",
        "{ Heard (wait 9s)\n  (Atom (range(ears module) < 1m AND t > 3) (go 20 0))\n  (Atom (null) turn 90)\n}\n",
    ),
    (
        "meet.mdle",
        "{ First (wait 9s) (Atom (rendezvous second) stop) }\n{ Second (wait 9s) (Atom (sync first) stop) }\n",
    ),
    ("it's.mdle", "{ Stop (wait 1s) (Atom (null) stop) }\n"),
    (
        "meet.toml",
        "seed = 1\n[[robot]]\nname = \"first\"\nfile = \"meet.mdle\"\nplan = \"First\"\nstart = \"0,0,0\"\nbody = \"scout\"\n\
         [[robot]]\nname = \"second\"\nfile = \"meet.mdle\"\nplan = \"Second\"\nstart = \"0,2,0\"\n",
    ),
];

/// Runs a command line of the shell in which `mdle` is the program of this workspace.
fn shell(folder: &Path, line: &str) -> Output {
    let line = line.replacen("mdle ", &format!("'{}' ", mdle().display()), 1);
    Command::new("sh").args(["-c", &line]).current_dir(folder).output().unwrap()
}

/// Asserts that the command in a record produces an identical record.
fn assert_repeated(folder: &Path, record: &str, again: &str) {
    let info = Command::new(mdle()).args(["log", "info", record]).current_dir(folder).output().unwrap();
    let info = String::from_utf8(info.stdout).unwrap();
    let command = info.lines().find_map(|line| line.strip_prefix("command")).expect(&info).trim();
    assert!(!command.contains("--log"), "{command}");
    let line = format!("{command} --log again.mcap");
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(matches!(output.status.code(), Some(0 | 4)), "{line}: {error}");
    let [one, other] = [record, again].map(|record| fs::read(folder.join(record)).expect(record));
    assert!(one == other, "`{command}` gives another record");
}

/// The command contains the start, errors, body, world, period, limits, rules, modules, commands and settings of the
/// run.
#[test]
fn the_command_of_a_record_repeats_it() {
    let folder = folder("repeated");
    fs::create_dir_all(folder.join("set")).unwrap();
    for (name, text) in FILES {
        fs::write(folder.join(name), text).unwrap();
    }
    let sim = "square.mdle --target sim --speed max";
    let calls = [
        format!("mdle run {sim} --log run.mcap"),
        format!("mdle run {sim} --body scout --seed 7 --start-noise 0.1,5 --log-best-effort --log=run.mcap"),
        format!("mdle run {sim} --log run.mcap --world hall --start=1.5,5,20 --period 0.05 --timeout 20"),
        format!("mdle run --safety slow.toml {sim} --seed 3 --point 2,1 --log run.mcap --turns 50"),
        format!("mdle shell {sim} --seed 3 --paused --safety slow.toml -c commands --log run.mcap"),
        "mdle run set/heard.mdle --speed max --log run.mcap".to_owned(),
        "mdle run \"it's.mdle\" --target sim --log run.mcap --speed max".to_owned(),
    ];
    for call in calls {
        let output = shell(&folder, &call);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(0 | 4)), "{call}: {error}");
        assert_repeated(&folder, "run.mcap", "again.mcap");
    }
    assert_eq!(shell(&folder, "mdle run meet.toml --seed 5 --log meet.mcap --timeout 8s").status.code(), Some(4));
    for robot in ["first", "second"] {
        assert_repeated(&folder, &format!("meet.{robot}.mcap"), &format!("again.{robot}.mcap"));
    }
}
