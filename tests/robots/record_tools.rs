//! Tests `mdle log`, `mdle plot` and `mdle replay --until` on the record of a run in the simulator.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use mdle_tests::executable::{folder, mdle, run_mdlec};
use mdle_tests::repository::root;

const PLAN: &str = "{ Square (wait 5min)
  ((Atom (way >= 1m OR r0 < 40cm) (go 20 0)) (Atom (null) turn 90))^4
}
";

/// Runs `mdle` with these arguments; returns its output, its messages and its exit status.
fn run(folder: &Path, arguments: &str) -> (String, String, i32) {
    let output = Command::new(mdle()).args(arguments.split(' ')).current_dir(folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code().unwrap())
}

/// Returns a folder with the record `square.mcap`.
fn recorded(name: &str) -> PathBuf {
    let folder = folder(&format!("record-tools-{name}"));
    fs::write(folder.join("square.mdle"), PLAN).unwrap();
    let options = "--speed max --body scout --seed 7 --world hall --log square.mcap";
    let (_, err, status) = run(&folder, &format!("run square.mdle --target sim {options}"));
    assert_eq!((err.as_str(), status), ("", 0));
    folder
}

#[test]
fn a_record_tells_what_it_contains() {
    let folder = recorded("info");
    let (out, err, status) = run(&folder, "log info square.mcap");
    assert_eq!((err.as_str(), status), ("", 0));
    assert!(out.contains(concat!("\nversion      ", env!("CARGO_PKG_VERSION"), "\n")), "{out}");
    let is_fixed = |line: &&str| !line.starts_with("command") && !line.starts_with("version");
    let out: Vec<_> = out.lines().filter(is_fixed).collect();
    insta::assert_snapshot!(out.join("\n"));
    let record = fs::read(folder.join("square.mcap")).unwrap();
    fs::write(folder.join("cut.mcap"), &record[..record.len() / 2]).unwrap();
    let (out, _, status) = run(&folder, "log info cut.mcap");
    assert!(out.contains("; the record has no end\n") && status == 0, "{out}");
}

/// A part of a record is itself a record: it replays, and its turns have the same explanations.
#[test]
fn a_part_of_a_record_is_a_record() {
    let folder = recorded("cut");
    assert_eq!(run(&folder, "log cut square.mcap 10 part.mcap"), ("part.mcap: 101 turns\n".into(), String::new(), 0));
    assert_eq!(run(&folder, "replay part.mcap").0, "the same to the bit, 101 turns\n");
    let why = |log: &str| run(&folder, &format!("why {log} 5.2")).0;
    assert_eq!(why("part.mcap"), why("square.mcap"));
    assert_eq!(run(&folder, "replay square.mcap --until 10").0, "the same to the bit, 101 turns\n");
    run(&folder, "log cut square.mcap 1h whole.mcap");
    assert!(fs::read(folder.join("whole.mcap")).unwrap() == fs::read(folder.join("square.mcap")).unwrap());
    let refused =
        ["log cut square.mcap 10 part.mcap", "log cut square.mcap -1 new.mcap", "log cut none.mcap 1 new.mcap"];
    let refused = refused.map(|arguments| run(&folder, arguments));
    assert!(refused.iter().all(|(out, _, status)| out.is_empty() && *status == 2) && !folder.join("new.mcap").exists());
    assert_eq!(refused[0].1, "error: part.mcap exists already\nhelp: remove it, or name another file\n");
}

/// Viewers refuse messages without the keys that the schemas of Foxglove require.
#[test]
fn messages_for_viewers_are_complete() {
    let folder = recorded("viewers");
    let record = fs::read(folder.join("square.mcap")).unwrap();
    let schemas = ["pose", "ranges"].map(|name| {
        let schema = fs::read(root().join(format!("runtime/record/src/schemas/{name}.json"))).unwrap();
        let schema: serde_json::Value = serde_json::from_slice(&schema).unwrap();
        schema["required"].as_array().unwrap().iter().map(|key| key.as_str().unwrap().to_owned()).collect::<Vec<_>>()
    });
    let start = b"{\"timestamp\":{\"sec\":";
    let starts = (0..record.len()).filter(|at| record[*at..].starts_with(start));
    let messages = starts.map(|at| {
        let mut values = serde_json::Deserializer::from_slice(&record[at..]).into_iter::<serde_json::Value>();
        values.next().unwrap().unwrap()
    });
    let (scans, poses): (Vec<_>, Vec<_>) = messages.partition(|message| message["ranges"].is_array());
    assert_eq!((poses.len(), scans.len()), (333, 333));
    for (messages, required) in [(&poses, &schemas[0]), (&scans, &schemas[1])] {
        assert!(messages.iter().all(|message| required.iter().all(|key| message.get(key).is_some())), "{messages:?}");
    }
    // The pose of a scan is that of the robot at the same time.
    assert!(
        poses.iter().zip(&scans).all(|(pose, scan)| pose["pose"] == scan["pose"] && scan["frame_id"] == "odometry")
    );
}

/// A negative time is not parsed as an option.
#[test]
fn times_before_the_run_have_a_help() {
    let folder = recorded("negative");
    let calls =
        ["log cut square.mcap -5 new.mcap", "log cut square.mcap -5s new.mcap", "replay square.mcap --until -5"];
    for call in calls.into_iter().chain(["why square.mcap -5"]) {
        let (out, err, status) = run(&folder, call);
        let time = if call.contains("-5s") { "-5s" } else { "-5" };
        let help = "help: a time of the run is 0 or more, as in `12.3` or `2min`";
        assert_eq!((err, status), (format!("error: `{time}` is before the start of the run\n{help}\n"), 2), "{call}");
        assert!(out.is_empty() && !folder.join("new.mcap").exists());
    }
}

/// The reader of the output may close the pipe, as in `mdle log export --csv square.mcap | head -1`.
#[test]
fn a_reader_that_has_gone_is_no_error() {
    let folder = recorded("closed");
    let calls = ["log export --csv", "log export --script", "log info", "replay", "replay --step"]
        .map(|call| format!("{call} square.mcap"));
    for call in calls.into_iter().chain(["why square.mcap 5".to_owned(), "why square.mcap --not turn".to_owned()]) {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(mdle()).args(call.split(' ')).current_dir(&folder).stdout(writer).output().unwrap();
        assert_eq!(
            (String::from_utf8(output.stderr).unwrap(), output.status.code()),
            (String::new(), Some(0)),
            "{call}"
        );
    }
}

#[test]
fn a_damaged_record_is_not_cut() {
    let folder = recorded("damaged");
    let mut record = fs::read(folder.join("square.mcap")).unwrap();
    // Start of turn 100: its number, its time, and the time of its output; its pose follows.
    let start = [100, 10_000_000_000, 10_000_000_000].map(u64::to_le_bytes).concat();
    let turn = record.windows(start.len()).position(|bytes| bytes == start).unwrap();
    record[turn + start.len()] ^= 1;
    fs::write(folder.join("changed.mcap"), record).unwrap();
    for arguments in ["log cut changed.mcap 1h new.mcap", "log info changed.mcap", "log export --csv changed.mcap"] {
        let (_, err, status) = run(&folder, arguments);
        let expected =
            "error: the record changed.mcap cannot be read: turn 100 was changed after it had been written\n";
        assert_eq!((err.as_str(), status), (expected, 1), "{arguments}");
    }
    assert!(!folder.join("new.mcap").exists());
}

#[test]
fn a_record_becomes_a_table() {
    let folder = recorded("export");
    let (out, err, status) = run(&folder, "log export --csv square.mcap");
    assert_eq!((err.as_str(), status), ("", 0));
    let lines: Vec<_> = out.lines().collect();
    let columns = lines[0].split(',').count();
    assert_eq!((lines.len(), columns), (334, 30));
    assert_eq!(lines[53].split(',').take(2).collect::<Vec<_>>(), ["52", "5.2"]);
    let cause = r#","way = 1.017 m >= 1m (square.mdle:2, of ""way >= 1m OR r0 < 40cm"")""#;
    assert!(lines[53].ends_with(cause), "{}", lines[53]);
    assert!(lines[52].split(',').count() == columns && lines[52].ends_with(','), "{}", lines[52]);
    run(&folder, "log export --csv square.mcap -o table.csv");
    assert_eq!(fs::read_to_string(folder.join("table.csv")).unwrap(), out);
}

/// On the script of a record, two machines make the plan behave as in the run, so that the debugger can step through
/// the run.
#[test]
fn a_record_becomes_a_script() {
    let folder = recorded("script");
    fs::copy(root().join("plans/lab_tour.mdle"), folder.join("tour.mdle")).unwrap();
    for (plan, world) in [("square", "hall"), ("tour", "office")] {
        let options = format!("--speed max --body scout --seed 7 --world {world}");
        for log in ["jsonl", "mcap"] {
            let _ = fs::remove_file(folder.join(format!("{plan}.mcap")));
            let (_, err, _) = run(&folder, &format!("run {plan}.mdle --target sim {options} --log {plan}.{log}"));
            assert_eq!(err, "");
        }
        let script = format!("{plan}.script");
        assert_eq!(run(&folder, &format!("log export --script {plan}.mcap -o {script}")), Default::default());
        let log = fs::read_to_string(folder.join(format!("{plan}.jsonl"))).unwrap();
        let plan = format!("{plan}.mdle");
        for machine in ["tree", "counted"] {
            let arguments = ["trace", &plan, "--target", "sim", "--script", &script, "--machine", machine];
            let output = run_mdlec(&folder, &arguments);
            assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
            assert_eq!(String::from_utf8(output.stdout).unwrap(), log, "{plan}, {machine}");
        }
    }
}

#[test]
fn what_no_script_can_say_is_refused() {
    let folder = recorded("untold");
    fs::write(folder.join("twice.mdle"), "{ Twice (wait 5min)\n  ((Atom (null) turn 90))^2\n}\n").unwrap();
    run(&folder, "run twice.mdle --target sim --speed max --log twice.mcap");
    let (out, err, status) = run(&folder, "log export --script twice.mcap");
    let lines = out.lines().count();
    let expected = format!(
        "error: turn {lines} of the record twice.mcap, at {}.{} s, is none for a script: `turn 90` ends an atom and begins \
         again in the same turn, which a script cannot say; the script ends before it\n",
        lines / 10,
        lines % 10
    );
    assert_eq!((err, status), (expected, 2));
}

#[test]
fn a_record_is_drawn() {
    let folder = recorded("plot");
    for arguments in ["plot square.mcap path.svg", "plot square.mcap time.svg --signal r0,v --signal omega"] {
        assert_eq!(run(&folder, arguments), (String::new(), String::new(), 0));
    }
    let [path, time] = ["path.svg", "time.svg"].map(|file| fs::read_to_string(folder.join(file)).unwrap());
    for picture in [&path, &time] {
        assert!(picture.contains("go 20 0") && picture.contains("turn 90"), "{picture}");
    }
    assert!(path.contains("class=\"way0\"") && path.contains("class=\"echo\""), "{path}");
    // Each of the two atoms is entered four times.
    let stays = ["class=\"disc0\"", "class=\"disc1\""].map(|class| time.matches(class).count());
    assert_eq!(stays, [4, 4]);
    assert!(["r0 [m]", "v [cm/s]", "omega [rad/s]", "0 s", "30 s"].iter().all(|words| time.contains(words)), "{time}");
    let (_, err, status) = run(&folder, "plot square.mcap other.svg --signal omgea");
    let expected = "error: a record has no signal `omgea`; did you mean `omega`?\nhelp: its signals are v, omega, x, y, theta, \
                    battery, and r0 to r15\n";
    assert_eq!((err.as_str(), status), (expected, 2));
    assert!(!folder.join("other.svg").exists());
}

/// Pictures are written as SVG only.
#[test]
fn a_picture_is_svg_alone() {
    let folder = recorded("format");
    let (out, err, status) = run(&folder, "plot square.mcap path.png");
    let message = "invalid value 'path.png' for '<FILE>': this option writes SVG, not PNG; name the file `path.svg`";
    assert!(err.starts_with(&format!("error: {message}\n")), "{err}");
    assert_eq!((out.as_str(), status), ("", 2));
    assert!(!folder.join("path.png").exists());
}

#[test]
fn a_rule_that_changed_an_input_is_named() {
    let folder = recorded("safety");
    fs::write(folder.join("rules.toml"), "[limits]\nspeed = \"10cm/s\"\n").unwrap();
    let options = "--world hall --speed max --safety rules.toml --turns 60 --log safe.mcap";
    assert_eq!(run(&folder, &format!("run square.mdle --target sim {options}")).2, 4);
    let (out, err, status) = run(&folder, "why safe.mcap 5");
    assert_eq!((err.as_str(), status), ("", 0));
    let expected = "  the plan asked for 0.2 m/s, 0 rad/s, and 0.1 m/s, 0 rad/s was sent  <- safety limited: speed\n";
    assert!(out.contains(expected), "{out}");
}
