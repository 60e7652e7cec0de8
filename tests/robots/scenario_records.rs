//! Tests records of scenarios: each robot has its own record, which all commands read like that of a run with a single
//! robot.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use mdle_record::frames::Frames;
use mdle_record::{RecordFile, RecordedChange, RecordedTurn, Records, TurnMade};
use mdle_tests::executable::{folder, mdle};
use mdle_tests::repository::root;

/// A scenario in which two robots meet over a bad line, and `bob` is killed before its plan is over.
const SCENARIO: &str = "world = \"square.toml\"
seed = 3
timeout = \"30s\"

[link]
latency = \"0ms..300ms\"
loss = 0.3
duplication = 0.1

[[robot]]
name = \"ada\"
file = \"meet.mdle\"
plan = \"Ada\"
start = \"0, 0, 0\"
body = \"scout\"

[[robot]]
name = \"bob\"
file = \"meet.mdle\"
plan = \"Bob\"
start = \"1.5, 0, 90\"
body = \"atrv\"
killed = \"15s\"
";
const PLANS: &str = "use \"ahead.mdle\"
{ Ada (wait 20s) (Atom (rendezvous bob) stop) (Atom (wait 3) Follow(bob)) Ahead }
{ Bob (wait 20s) (Atom (wait 2) (go 10 0)) (Atom (rendezvous ada) stop) (Atom (NOT sync ada OR t > 6) (go 20 0.2)) Ahead }
";

/// Runs `mdle` with these arguments; returns its output, its messages and its exit status.
fn run(folder: &Path, arguments: &str) -> (String, String, i32) {
    let output = Command::new(mdle()).args(arguments.split(' ')).current_dir(folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code().unwrap())
}

fn prepared(name: &str) -> PathBuf {
    let folder = folder(&format!("scenario-record-{name}"));
    fs::write(folder.join("meet.mdle"), PLANS).unwrap();
    fs::write(
        folder.join("ahead.mdle"),
        "{ Ahead (bumper) ((Atom (r0 < 60cm OR wait 2) (go 20 0)) (Atom (null) turn 90))^inf }\n",
    )
    .unwrap();
    fs::write(folder.join("square.toml"), "[[wall]]\npoints = [[-3, -3], [5, -3], [5, 3], [-3, 3], [-3, -3]]\n")
        .unwrap();
    fs::write(folder.join("two.toml"), SCENARIO).unwrap();
    folder
}

/// Asserts that a record replays to the bit.
fn assert_same(folder: &Path, record: &str) {
    let (out, err, status) = run(folder, &format!("replay {record}"));
    assert!(out.starts_with("the same to the bit, ") && !out.contains(';') && status == 0, "{record}: {out}{err}");
}

#[test]
fn each_robot_has_a_record() {
    let folder = prepared("each");
    let (report, err, status) = run(&folder, "run two.toml --log run.mcap");
    assert_eq!((err.as_str(), status), ("", 4), "{report}");
    assert_eq!(run(&folder, "run two.toml").0, report, "a record changes nothing");
    // The records can be read without the scenario and the plans.
    for file in ["two.toml", "meet.mdle", "ahead.mdle"] {
        fs::rename(folder.join(file), folder.join(format!("{file}.old"))).unwrap();
    }
    let answers = ["ada", "bob"].map(|robot| {
        let record = format!("run.{robot}.mcap");
        assert_same(&folder, &record);
        let (info, ..) = run(&folder, &format!("log info {record}"));
        let (why, err, status) = run(&folder, &format!("why {record} 2.5"));
        assert_eq!((err.as_str(), status), ("", 0));
        let (table, _, status) = run(&folder, &format!("log export --csv {record}"));
        assert!(table.lines().count() > 100 && status == 0);
        assert_eq!(run(&folder, &format!("plot {record} {robot}.svg")).2, 0);
        let info: Vec<_> =
            info.lines().filter(|line| !line.starts_with("version") && !line.starts_with("command")).collect();
        format!("{}\n\n{why}", info.join("\n"))
    });
    insta::assert_snapshot!(answers.join("----\n"));
    // The record must have the same times as the report.
    let began = |line: &str| line.split_once(" s  ada: ").map(|(time, _)| time.trim().to_owned());
    let times: Vec<String> = report.lines().filter_map(began).collect();
    let bytes = fs::read(folder.join("run.ada.mcap")).unwrap();
    let (_, records) = Records::open(&*bytes).unwrap();
    let turns = records.map(Result::unwrap).flat_map(|turn| vec![turn.t; turn.steps.len()]);
    let recorded: Vec<String> = turns.map(|t| format!("{:.1}", t.seconds())).collect();
    assert_eq!(recorded, times);
}

/// Copies a record without the states that the link received.
fn without_peers(folder: &Path, from: &str, to: &str) {
    let (begin, turns) = Records::open(fs::File::open(folder.join(from)).unwrap()).unwrap();
    let (mut frames, mut bytes) = (Frames::default(), Vec::new());
    let turns: Vec<_> = turns.map(Result::unwrap).collect();
    frames.begin(&begin, &turns[0].y, &mut bytes);
    for RecordedTurn { number, t, y, sent, applied, plan, state, steps, changes, .. } in turns {
        let changes: Vec<_> =
            changes.into_iter().filter(|change| !matches!(change, RecordedChange::Peer { .. })).collect();
        let made = TurnMade { number, t, sent, applied, plan, state, changes: &changes, overruled: None };
        frames.turn(made, &y, steps.into_iter(), &mut bytes);
    }
    frames.end(&mut bytes);
    std::io::Write::write_all(&mut RecordFile::new(fs::File::create(folder.join(to)).unwrap()), &bytes).unwrap();
}

/// The states that a robot received from the other robot are part of its record. Without these states, or with a
/// changed bit in them, the replay names the turn.
#[test]
fn knowledge_of_other_robots_is_recorded() {
    let folder = prepared("peers");
    run(&folder, "run two.toml --log run.mcap");
    without_peers(&folder, "run.ada.mcap", "alone.mcap");
    let (out, _, status) = run(&folder, "replay alone.mcap");
    assert!(out.contains(" differs\n") && status == 1, "{out}");
    let record = fs::read(folder.join("run.ada.mcap")).unwrap();
    for turn in [5_u64, 30, 60] {
        let start = [turn, turn * 100_000_000].map(u64::to_le_bytes).concat();
        let begin = record.windows(start.len()).position(|bytes| bytes == start).unwrap();
        // A change of kind 12, followed by the length of the name and the name.
        let peer = [&[12, 3, 0, 0, 0][..], b"bob"].concat();
        let at = begin + record[begin..].windows(peer.len()).position(|bytes| bytes == peer).unwrap() + peer.len();
        let mut changed = record.clone();
        changed[at + 12] ^= 1;
        fs::write(folder.join("changed.mcap"), changed).unwrap();
        let (out, _, status) = run(&folder, "replay changed.mcap");
        assert!(
            out.ends_with(&format!("then turn {turn} was changed after it had been written\n")) && status == 1,
            "{out}"
        );
    }
}

/// The three robots of the book learn a path. Each path that a robot stores is in the robot's record.
#[test]
fn recorded_ways_are_recorded() {
    let folder = folder("scenario-record-ways");
    let plans = root().join("plans/pursuit");
    fs::create_dir_all(folder.join("robot1")).unwrap();
    for file in ["first_robot.mdle", "second_robot.mdle", "third_robot.mdle", "robot1/lastPath.csv", "pursuit.toml"] {
        fs::copy(plans.join(file), folder.join(file)).unwrap();
    }
    assert_eq!(run(&folder, "run pursuit.toml --log run.mcap").2, 0);
    for robot in ["robot1", "robot2", "robot3"] {
        let record = format!("run.{robot}.mcap");
        assert_same(&folder, &record);
        let (_, turns) = Records::open(fs::File::open(folder.join(record)).unwrap()).unwrap();
        let paths =
            turns.flat_map(|turn| turn.unwrap().changes).filter(|change| matches!(change, RecordedChange::Path { .. }));
        let is_recording = robot != "robot2";
        assert_eq!(paths.count() >= 3, is_recording, "{robot}");
    }
}

#[test]
fn records_of_a_killed_scenario_can_be_read() {
    let folder = prepared("killed");
    fs::write(folder.join("meet.mdle"), "{ Round (wait 2h) (Atom (bumper) (go 0 0.5)) }").unwrap();
    let text = SCENARIO.replace("30s", "2h").replace("killed = \"15s\"\n", "");
    fs::write(folder.join("two.toml"), text.replace("plan = \"Ada\"\n", "").replace("plan = \"Bob\"\n", "")).unwrap();
    let mut command = Command::new(mdle());
    let command = command.args(["run", "two.toml", "--log", "run.mcap"]).current_dir(&folder).stdout(Stdio::null());
    let mut child = command.spawn().unwrap();
    let length = |robot| fs::metadata(folder.join(format!("run.{robot}.mcap"))).map_or(0, |metadata| metadata.len());
    let begun = Instant::now();
    while length("ada").min(length("bob")) < 60_000 {
        assert!(begun.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none());
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    for robot in ["ada", "bob"] {
        let (out, err, status) = run(&folder, &format!("replay run.{robot}.mcap"));
        assert!(out.ends_with(" turns; the record has no end\n") && status == 0, "{out}{err}");
    }
}

/// A full disk ends the scenario with a message that names the file. A log in another format is refused with the names
/// to type.
#[test]
fn records_that_cannot_be_written_end_a_scenario() {
    let folder = prepared("full");
    symlink("/dev/full", folder.join("run.bob.mcap")).unwrap();
    let (_, err, status) = run(&folder, "run two.toml --log run.mcap");
    let expected = "error: run.bob.mcap cannot be written: No space left on device (os error 28)\n";
    assert_eq!((err.as_str(), status), (expected, 3));
    assert_same(&folder, "run.ada.mcap");
    let (_, err, status) = run(&folder, "run two.toml --log run.svg");
    assert!(
        err.contains("name the file `run.jsonl` for JSON lines, or `run.mcap` for records") && status == 2,
        "{err}"
    );
    let (_, err, status) = run(&folder, "run two.toml --log none/run.mcap");
    assert!(err.starts_with("error: none/run.ada.mcap cannot be written: ") && status == 2, "{err}");
}

/// A robot that is killed before its first turn has a record without turns.
#[test]
fn a_robot_without_turns_has_a_record() {
    let folder = prepared("no-turns");
    fs::write(folder.join("two.toml"), SCENARIO.replace("15s", "0s").replace("30s", "1s")).unwrap();
    run(&folder, "run two.toml --log run.mcap");
    let (out, err, status) = run(&folder, "log info run.bob.mcap");
    assert!(out.starts_with("plan         Bob (meet.mdle, ahead.mdle)\n") && status == 0, "{out}{err}");
    let (out, err, status) = run(&folder, "replay run.bob.mcap");
    assert_eq!((out.as_str(), status), ("the same to the bit, 0 turns\n", 0), "{err}");
}

/// A run that cannot begin leaves no records.
#[test]
fn a_refused_scenario_leaves_no_records() {
    let folder = prepared("refused");
    fs::create_dir(folder.join("run.bob.mcap")).unwrap();
    let (_, err, status) = run(&folder, "run two.toml --log run.mcap");
    assert!(err.starts_with("error: run.bob.mcap cannot be written: ") && status == 2, "{err}");
    assert!(!folder.join("run.ada.mcap").exists());
    let (_, err, status) = run(&folder, "run two.toml --log log.mcap --trail none/trail.csv");
    assert!(err.starts_with("error: none/trail.csv cannot be written: ") && status == 2, "{err}");
    assert!(!folder.join("log.ada.mcap").exists());
}

/// In the report, a fault's message and its help are on separate lines; the record ends with the message alone.
#[test]
fn a_fault_with_help_has_two_lines() {
    let folder = prepared("two-lines");
    let plan = "{ Near (range(ears module) < 50cm OR wait 9) (Atom (null) (go 20 0)) }\n";
    fs::write(folder.join("near.mdle"), plan).unwrap();
    let scenario = "timeout = \"6s\"\n[[robot]]\nname = \"ada\"\nfile = \"near.mdle\"\nstart = \"0, 0, 0\"\n";
    fs::write(folder.join("near.toml"), scenario).unwrap();
    let (out, err, status) = run(&folder, "run near.toml --log run.mcap");
    let sentence = "the plan reads /usr/ears/range, which no module has published within 2 s";
    let report = format!("2.0 s  ada: error: {sentence}\nhelp: no module `ears` is loaded: ");
    assert!(out.starts_with(&report) && status == 3, "{out}{err}");
    let record = fs::read(folder.join("run.ada.mcap")).unwrap();
    let end = format!("\"kind\":\"end\",\"text\":\"failed: {sentence}\"}}");
    assert!(record.windows(end.len()).any(|bytes| bytes == end.as_bytes()), "the end is another one");
}
