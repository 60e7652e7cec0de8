//! Tests a signal during a scenario: the scenario ends properly, and all files written so far are complete.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mdle_tests::executable::{folder, mdle};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

/// Two robots that drive in circles for days.
const SCENARIO: &str = "timeout = \"1000000s\"
[[robot]]
name = \"ada\"
file = \"round.mdle\"
start = \"0, 0, 0\"
[[robot]]
name = \"bob\"
file = \"round.mdle\"
start = \"3, 0, 0\"
";

#[test]
fn a_signal_ends_a_crowd_in_order() {
    let folder = folder("crowd");
    fs::write(folder.join("round.mdle"), "{ Round (wait 900000) (Atom (bumper) (go 20 0.5)) }").unwrap();
    let crowd = "timeout = \"1000000s\"\n[crowd]\nrobots = 9\nfile = \"round.mdle\"\n";
    fs::write(folder.join("crowd.toml"), crowd).unwrap();
    for (signal, status) in [(Signal::INT, 130), (Signal::TERM, 143)] {
        let mut command = Command::new(mdle());
        let command = command.args("run crowd.toml --trail trail.csv".split(' ')).current_dir(&folder);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let trail = folder.join("trail.csv");
        let begun = Instant::now();
        while fs::metadata(&trail).map_or(0, |file| file.len()) < 10_000 {
            assert!(begun.elapsed() < Duration::from_secs(60), "the crowd does not begin");
            sleep(Duration::from_millis(20));
        }
        kill_process(Pid::from_child(&child), signal).unwrap();
        let Output { status: ended, stdout, stderr } = child.wait_with_output().unwrap();
        let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(ended.code(), Some(status), "{out}{err}");
        assert!(err.ends_with("stopped by SIGINT\n") || err.ends_with("stopped by SIGTERM\n"), "{err}");
        assert!(out.starts_with("9 robots for ") && out.contains("plans that are over: 0\n"), "{out}");
        let poses = fs::read_to_string(&trail).unwrap();
        assert!(poses.ends_with('\n') && (poses.lines().count() - 1).is_multiple_of(9), "the last turn is whole");
        fs::remove_file(trail).unwrap();
    }
}

#[test]
fn a_signal_ends_a_scenario_in_order() {
    let folder = folder("scenario");
    fs::write(folder.join("round.mdle"), "{ Round (wait 900000) (Atom (bumper) (go 20 0.5)) }").unwrap();
    fs::write(folder.join("s.toml"), SCENARIO).unwrap();
    for (signal, status) in [(Signal::INT, 130), (Signal::TERM, 143)] {
        let mut command = Command::new(mdle());
        let command = command.args("run s.toml --log s.jsonl --plot s.svg".split(' ')).current_dir(&folder);
        let child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let log = folder.join("s.jsonl");
        let begun = Instant::now();
        while fs::metadata(&log).map_or(0, |file| file.len()) < 10_000 {
            assert!(begun.elapsed() < Duration::from_secs(60), "the scenario does not begin");
            sleep(Duration::from_millis(20));
        }
        kill_process(Pid::from_child(&child), signal).unwrap();
        let Output { status: ended, stdout, stderr } = child.wait_with_output().unwrap();
        let [out, err] = [stdout, stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        assert_eq!(ended.code(), Some(status), "{out}{err}");
        assert!(err.ends_with("stopped by SIGINT\n") || err.ends_with("stopped by SIGTERM\n"), "{err}");
        assert!(out.contains("ada: still runs go 20 0.5\n") && out.contains("bob: still runs"), "{out}");
        assert!(out.contains("least gap between robots: "), "{out}");
        let turns: Vec<Value> =
            fs::read_to_string(&log).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(turns.last().unwrap()["robot"], "bob", "the last turn is whole");
        assert!(fs::read_to_string(folder.join("s.svg")).unwrap().ends_with("</svg>\n"));
        fs::remove_file(log).unwrap();
    }
}
