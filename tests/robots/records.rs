//! Tests records of runs, in the simulator and on both emulated robots. Each record replays to the bit. A record that
//! was changed or cut short, or whose run was killed, is reported as such.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_record::{ReadError, Records};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::Body;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::driving_plan::random_plan;
use mdle_tests::executable::{folder, mdle, run_mdlec};
use mdle_tests::repository::root;
use mdle_tests::run_output::simulated;

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);

/// A plan with a loop, a memory, a rising condition and a label.
const PLAN: &str = "{ Rounds (wait 60s)
  ((Atom (RISING (r0 < 80cm) OR wait 4s) (go 30 0)) ahead: (Atom (wait 2s OR bumper) (go 0 0.7))
  (Atom (NOT after ahead (wait 2s) OR wait 1s) stop))^inf
}
";

/// Runs `mdle` with these arguments.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(mdle()).args(arguments).current_dir(folder).output().unwrap()
}

/// Returns the report, the messages and the exit status of a replay.
fn replay(folder: &Path, arguments: &[&str]) -> (String, String, Option<i32>) {
    let output = run(folder, &[&["replay"], arguments].concat());
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code())
}

/// Asserts that a record replays to the bit; returns the number of its turns.
fn assert_same(folder: &Path, arguments: &[&str]) -> u64 {
    let (out, err, status) = replay(folder, arguments);
    assert_eq!((err.as_str(), status), ("", Some(0)), "{arguments:?}: {out}");
    let count = out.strip_prefix("the same to the bit, ").and_then(|rest| rest.strip_suffix('\n'));
    // The count may be singular: a plan that ends in its first turn has a record of "1 turn".
    let turns = count.and_then(|count| count.strip_suffix(" turns").or(count.strip_suffix(" turn")));
    turns.expect(&out).parse().unwrap()
}

/// Runs `PLAN` in the simulator, and writes the record `run.mcap` to this folder.
fn recorded(folder: &Path, options: &[&str]) {
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    fs::write(folder.join("rules.toml"), "[limits]\nspeed = \"10cm/s\"\n").unwrap();
    let common = ["run", "rounds.mdle", "--target", "sim", "--world", "hall", "--speed", "max", "--log", "run.mcap"];
    let output = run(folder, &[&common, options].concat());
    assert!(matches!(output.status.code(), Some(0 | 4)), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn runs_of_every_plan_replay_to_the_bit() {
    let folder = folder("plans");
    let plans = fs::read_dir(root().join("plans")).unwrap().map(|entry| entry.unwrap().path());
    let mut records = 0;
    for plan in plans.filter(|plan| plan.extension().is_some_and(|extension| extension == "mdle")) {
        for (body, seed) in [("ideal", "1"), ("scout", "2"), ("atrv", "3")] {
            let plan = plan.to_str().unwrap();
            let common = ["run", plan, "--target", "sim", "--speed", "max", "--timeout", "200", "--log", "run.MCAP"];
            let output = run(&folder, &[&common[..], &["--body", body, "--seed", seed]].concat());
            assert!(matches!(output.status.code(), Some(0 | 4)), "{}", String::from_utf8_lossy(&output.stderr));
            assert!(assert_same(&folder, &["run.MCAP"]) > 40, "{plan} {body}");
            records += 1;
        }
    }
    assert!(records >= 21, "{records}");
}

#[test]
fn runs_of_random_plans_replay_to_the_bit() {
    let folder = folder("random");
    for seed in 0..repeated(8) {
        fs::write(folder.join("random.mdle"), random_plan(&mut Chance::new(seed))).unwrap();
        let body = ["ideal", "scout", "atrv"][seed as usize % 3];
        let options = ["run", "random.mdle", "--target", "sim", "--speed", "max", "--log", "run.mcap", "--body", body];
        let output = run(&folder, &[&options[..], &["--seed", &seed.to_string()]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_same(&folder, &["run.mcap"]);
    }
}

/// Runs a plan on an emulated robot in lockstep.
fn emulated<R: Emulated + Send>(folder: &Path, mut robot: R, target: &str) -> Output {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let mut command = Command::new(mdle());
    command.args(["run", "rounds.mdle", "--target", target, "--lockstep", "--log", "run.mcap", "--device"]);
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, IN_LOCKSTEP, &|| !over.load(Ordering::Relaxed)));
        let output = command.arg(port.path()).current_dir(folder).output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    })
}

#[test]
fn runs_on_emulated_robots_replay_to_the_bit() {
    let folder = folder("emulated");
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    let step = step(IN_LOCKSTEP);
    let check = |target: &str, output: Output| {
        assert!(output.status.success(), "{target}: {}", String::from_utf8_lossy(&output.stderr));
        assert!(assert_same(&folder, &["run.mcap"]) > 500, "{target}");
    };
    check("scout", emulated(&folder, Scout::new(simulated(Body::Scout, PERIOD)).unwrap(), "scout"));
    check("atrv", emulated(&folder, Atrv::new(simulated(Body::Atrv, step), step, false).unwrap(), "atrv"));
}

#[test]
fn the_record_of_an_executable_needs_the_text_of_its_plan() {
    let folder = folder("executable");
    recorded(&folder, &["--body", "scout", "--seed", "5"]);
    let turns = assert_same(&folder, &["run.mcap"]);
    let built = run_mdlec(&folder, &["rounds.mdle", "--target", "sim", "-o", "rounds"]);
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let options = ["--world", "hall", "--speed", "max", "--body", "scout", "--seed", "5", "--log", "own.mcap"];
    let output = Command::new(folder.join("rounds")).args(options).current_dir(&folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(assert_same(&folder, &["own.mcap", "--plan", "rounds.mdle"]), turns);
    let (_, err, status) = replay(&folder, &["own.mcap"]);
    let expected = "error: the record of an executable does not have the text of its plan\n\
                    help: name its file, as in `mdle replay own.mcap --plan PLAN.mdle`\n";
    assert_eq!((err.as_str(), status), (expected, Some(2)));
}

/// If a record is replayed with another plan, the first turn that differs is named.
#[test]
fn another_plan_differs_in_a_turn() {
    let folder = folder("other");
    recorded(&folder, &["--seed", "5"]);
    fs::write(folder.join("edited.mdle"), PLAN.replace("wait 4s", "wait 3s")).unwrap();
    let (out, err, status) = replay(&folder, &["run.mcap", "--plan", "edited.mdle"]);
    assert_eq!((err.as_str(), status), ("", Some(1)));
    let expected = [
        "turn 30 at 3.0 s differs",
        "transitions\n  recorded: none\n  replayed: 1 to 2 by wait 3",
        "state\n  recorded: 1\n  replayed: 2",
        "input\n  recorded: 0.3 m/s, 0 rad/s\n  replayed: 0 m/s, 0.7 rad/s\n",
    ];
    let (differs, rest) = out.split_once("\nfrom here on").unwrap();
    assert_eq!(differs, expected.join("\n"));
    // The recorded plan does the same as the other plan, a second later.
    let rows: Vec<_> = rest.lines().skip(2).take(3).map(str::trim_end).collect();
    let expected = ["           recorded  edited.mdle", "    3.0 s            go 0 0.7", "    4.0 s  go 0 0.7"];
    assert_eq!(rows, expected);
}

/// Recorded causes have the texts of the recorded plan, not of the plan that replaces it in the replay.
#[test]
fn recorded_causes_have_the_texts_of_their_plan() {
    let folder = folder("own-texts");
    recorded(&folder, &["--seed", "5"]);
    fs::write(folder.join("edited.mdle"), PLAN.replace("wait 4s", "wait 5s")).unwrap();
    let (out, err, status) = replay(&folder, &["run.mcap", "--plan", "edited.mdle"]);
    assert_eq!((err.as_str(), status), ("", Some(1)));
    let expected = "turn 40 at 4.0 s differs\ntransitions\n  recorded: 1 to 2 by wait 4\n  replayed: none\nstate\n";
    assert!(out.starts_with(expected), "{out}");
}

#[test]
fn a_plan_that_uses_others_replays_without_their_files() {
    let folder = folder("used");
    fs::create_dir(folder.join("parts")).unwrap();
    let main = "use \"parts/leg.mdle\"\nuse \"parts/both.mdle\"\n{ Main (bumper) Leg(2s) Rest }\n";
    fs::write(folder.join("main.mdle"), main).unwrap();
    fs::write(folder.join("parts/leg.mdle"), "{ Leg(long: time) (Atom (wait long) (go 20 0)) }\n").unwrap();
    // Uses the same file by another path.
    fs::write(folder.join("parts/both.mdle"), "use \"../parts/./leg.mdle\"\n{ Rest Leg(1s) }\n").unwrap();
    let options = ["run", "main.mdle", "--target", "sim", "--speed", "max", "--log", "run.mcap"];
    assert!(run(&folder, &options).status.success());
    fs::remove_file(folder.join("main.mdle")).unwrap();
    fs::remove_dir_all(folder.join("parts")).unwrap();
    assert_eq!(assert_same(&folder, &["run.mcap"]), 31);
}

/// Returns the position in a record of the first new ping's range in a turn, or `None` if the turn has no such range. A
/// turn begins with its number, its time and the time of its output; both times are equal on a simulated robot.
fn range_of(record: &[u8], turn: u64) -> Option<usize> {
    let t = turn * 100_000_000;
    let start = [turn, t, t].map(u64::to_le_bytes).concat();
    let at = record.windows(start.len()).position(|bytes| bytes == start)? + start.len();
    // The pose, the velocity, the switches, the battery, its flags and the kind of the compass come first.
    let fresh = at + 24 + 16 + 4 + 8 + 1 + 1;
    let has_range = record[fresh..fresh + 4] != [0; 4] && record[fresh + 4] & 2 != 0;
    has_range.then_some(fresh + 5)
}

#[test]
fn a_bit_of_a_range_is_missed_in_its_turn() {
    let folder = folder("bit");
    recorded(&folder, &["--seed", "5", "--safety", "rules.toml"]);
    let record = fs::read(folder.join("run.mcap")).unwrap();
    for from in [1, 123, 456] {
        let (turn, at) = (from..from + 100).find_map(|turn| Some((turn, range_of(&record, turn)?))).unwrap();
        let mut changed = record.clone();
        changed[at] ^= 1;
        fs::write(folder.join("changed.mcap"), changed).unwrap();
        let (out, _, status) = replay(&folder, &["changed.mcap"]);
        let expected =
            format!("the same to the bit, {turn} turns; then turn {turn} was changed after it had been written\n");
        assert_eq!((out, status), (expected, Some(1)));
    }
}

#[test]
fn a_record_that_is_cut_short_replays_to_its_last_second() {
    let folder = folder("cut");
    recorded(&folder, &["--seed", "5"]);
    let record = fs::read(folder.join("run.mcap")).unwrap();
    let whole = assert_same(&folder, &["run.mcap"]);
    let mut last = 0;
    for part in 1..20 {
        fs::write(folder.join("cut.mcap"), &record[..record.len() * part / 20]).unwrap();
        let (out, err, status) = replay(&folder, &["cut.mcap"]);
        if status == Some(2) {
            assert!(err.contains("it is no record of a run"), "{err}");
            continue;
        }
        let turns = out
            .strip_prefix("the same to the bit, ")
            .and_then(|rest| rest.strip_suffix(" turns; the record has no end\n"));
        let turns: u64 = turns.expect(&out).parse().unwrap();
        assert!(turns >= last && turns <= whole && status == Some(0), "{part}: {out}");
        last = turns;
    }
    assert!(whole - last <= whole / 10, "{last} of {whole}");
}

#[test]
fn what_is_no_record_is_refused() {
    let folder = folder("none");
    fs::write(folder.join("empty.mcap"), "").unwrap();
    fs::write(folder.join("plan.mcap"), PLAN).unwrap();
    let messages = ["missing.mcap", "empty.mcap", "plan.mcap", "."].map(|log| {
        let (out, err, status) = replay(&folder, &[log]);
        assert_eq!((out.as_str(), status), ("", Some(2)));
        err
    });
    insta::assert_snapshot!(messages.concat());
}

/// The message names the format of the record, and the version of mdle that can read it.
#[test]
fn a_record_of_another_version_is_refused() {
    let folder = folder("version");
    recorded(&folder, &["--turns", "20"]);
    let mut record = fs::read(folder.join("run.mcap")).unwrap();
    let name = b"mdle.begin.2";
    let at = record.windows(name.len()).position(|bytes| bytes == name).unwrap();
    record[at + name.len() - 1] = b'1';
    fs::write(folder.join("old.mcap"), record).unwrap();
    let (out, err, status) = replay(&folder, &["old.mcap"]);
    let expected = "error: the record old.mcap cannot be read: it is of the format `mdle.begin.1`, and this program reads \
                    `mdle.begin.2`: the version of mdle that wrote it reads it\n";
    assert_eq!((out.as_str(), err.as_str(), status), ("", expected, Some(2)));
}

/// Returns the kind of each record in an MCAP file, with the range of its content.
fn parts(record: &[u8]) -> Vec<(u8, std::ops::Range<usize>)> {
    let (mut at, mut parts) = (8, Vec::new());
    while at + 9 <= record.len() - 8 {
        let length = u64::from_le_bytes(record[at + 1..at + 9].try_into().unwrap()) as usize;
        parts.push((record[at], at + 9..at + 9 + length));
        at += 9 + length;
    }
    parts
}

/// A changed bit anywhere in a record is detected, by the checksum of a turn, of a chunk or of the file.
#[test]
fn a_changed_bit_is_noticed_in_every_part() {
    let folder = folder("bits");
    recorded(&folder, &["--seed", "5", "--safety", "rules.toml", "--turns", "40"]);
    let record = fs::read(folder.join("run.mcap")).unwrap();
    let read = |bytes: &[u8]| -> Result<usize, ReadError> {
        let (_, records) = Records::open(bytes)?;
        records.map(|turn| turn.map(|_| ())).collect::<Result<Vec<_>, _>>().map(|turns| turns.len())
    };
    assert_eq!(read(&record).unwrap(), 40);
    let parts = parts(&record);
    assert!(parts.iter().filter(|(kind, _)| *kind == 6).count() > 4, "{parts:?}");
    let mut chance = Chance::new(0);
    for (kind, range) in parts {
        for _ in 0..repeated(60) {
            let mut changed = record.clone();
            let place = range.start + chance.below(range.len().max(1));
            changed[place] ^= 1 << chance.below(8);
            assert!(
                read(&changed).is_err(),
                "a bit of byte {} in a part of kind {kind}: {range:?}",
                place - range.start
            );
        }
    }
    let viewers = record.windows(10).position(|bytes| bytes == b"\"frame_id\"").unwrap();
    let mut changed = record.clone();
    changed[viewers + 2] ^= 1;
    fs::write(folder.join("changed.mcap"), changed).unwrap();
    let (out, _, status) = replay(&folder, &["changed.mcap"]);
    assert!(
        out.contains("the sum of one of its seconds differs, so that bytes besides its turns were changed"),
        "{out}"
    );
    assert_eq!(status, Some(1));
}

#[test]
fn a_full_disk_ends_the_run() {
    let folder = folder("full");
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    symlink("/dev/full", folder.join("full.mcap")).unwrap();
    let output = run(&folder, &["run", "rounds.mdle", "--target", "sim", "--speed", "max", "--log", "full.mcap"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{message}");
    let expected =
        "error: the run log cannot be written, so the robot was stopped: No space left on device (os error 28)\n";
    assert_eq!(message, expected);
}

/// With `--log-best-effort`, a full disk or a closed pipe ends only the log, and not the run.
#[test]
fn a_log_of_best_effort_ends_without_the_run() {
    let folder = folder("effort");
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    let common =
        ["run", "rounds.mdle", "--target", "sim", "--speed", "max", "--period", "0.02", "--log-best-effort", "--log"];
    for ending in ["mcap", "jsonl"] {
        let (full, pipe) = (format!("full.{ending}"), format!("pipe.{ending}"));
        symlink("/dev/full", folder.join(&full)).unwrap();
        assert!(Command::new("mkfifo").arg(folder.join(&pipe)).status().unwrap().success());
        let mut reader = Command::new("head");
        reader.args(["-c", "9000"]).arg(&pipe).current_dir(&folder).stdout(Stdio::piped());
        let reader = reader.spawn().unwrap();
        let outputs = [full, pipe].map(|log| run(&folder, &[&common[..], &[&log]].concat()));
        assert_eq!(reader.wait_with_output().unwrap().stdout.len(), 9000);
        let errors = ["No space left on device (os error 28)", "Broken pipe (os error 32)"];
        for (output, error) in outputs.into_iter().zip(errors) {
            let message = String::from_utf8(output.stderr).unwrap();
            let time = message.strip_prefix("warning: the log ends before ");
            let time = time.and_then(|rest| rest.split_once(" s of the run, "));
            let (time, reason) = time.expect(&message);
            assert!((0.0..=60.0).contains(&time.parse::<f64>().unwrap()), "{message}");
            assert_eq!(reason, format!("as it cannot be written: {error}\n"));
            assert_eq!(output.status.code(), Some(0), "{ending}");
            assert!(String::from_utf8(output.stdout).unwrap().ends_with("plan over: wait 60s (rounds.mdle:1)\n"));
        }
    }
}

/// The log contains no turn after the time that the warning names.
#[test]
fn a_log_of_best_effort_ends_before_the_time_that_is_named() {
    let folder = folder("effort_time");
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    let options = ["run", "rounds.mdle", "--target", "sim", "--speed", "max", "--log-best-effort", "--log"];
    for log in ["run.mcap", "run.jsonl"] {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -f 64; exec \"$@\"", "sh"]).arg(mdle()).args(options).arg(log);
        let message = String::from_utf8(shell.current_dir(&folder).output().unwrap().stderr).unwrap();
        let named = message.strip_prefix("warning: the log ends before ").and_then(|rest| rest.split_once(" s of"));
        let named: f64 = named.expect(&message).0.parse().unwrap();
        let last: f64 = if log.ends_with("mcap") {
            let mut export = Command::new(mdle());
            let output = export.args(["log", "export", "--csv", log]).current_dir(&folder).output().unwrap();
            let rows = String::from_utf8(output.stdout).unwrap();
            rows.lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap()
        } else {
            let lines = fs::read_to_string(folder.join(log)).unwrap();
            let whole = lines.lines().rfind(|line| line.ends_with('}')).unwrap();
            whole.split_once("\"t\":").unwrap().1.split_once(',').unwrap().0.parse().unwrap()
        };
        assert!(last < named && named <= 60.0, "{log}: {last} {message}");
    }
}

/// As in any run in real time, each second is written to the file at once.
#[test]
fn the_record_of_a_killed_run_can_be_read() {
    let folder = folder("killed");
    fs::write(folder.join("rounds.mdle"), PLAN).unwrap();
    let options = ["run", "rounds.mdle", "--target", "sim", "--speed", "20", "--log", "run.mcap"];
    let mut child = Command::new(mdle()).args(options).current_dir(&folder).stdout(Stdio::null()).spawn().unwrap();
    let length = || fs::metadata(folder.join("run.mcap")).map_or(0, |metadata| metadata.len());
    while length() < 60_000 && child.try_wait().unwrap().is_none() {
        thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let (out, err, status) = replay(&folder, &["run.mcap"]);
    assert!(out.ends_with(" turns; the record has no end\n") && status == Some(0), "{out}{err}");
}

#[test]
fn two_runs_of_one_seed_have_the_same_record() {
    let folder = folder("twice");
    let record = || {
        recorded(&folder, &["--body", "atrv", "--seed", "9"]);
        fs::read(folder.join("run.mcap")).unwrap()
    };
    assert!(record() == record());
}
