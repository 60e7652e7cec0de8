//! Tests unusual records and questions: records from pipes, very long records, records of a plan that this version
//! cannot compile, and times outside the run.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs::{self, File};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use mdle_record::frames::Frames;
use mdle_record::{Begin, RecordFile, Records, TurnMade};
use mdle_tests::executable::{folder, mdle};

const PLAN: &str = "{ Square (wait 5min)
  ((Atom (way >= 1m OR r0 < 40cm) (go 20 0)) (Atom (null) turn 90))^4
}
";

/// Runs a command line of the shell in which `mdle` is the program of this workspace. Returns the output, the messages
/// and the exit status.
fn shell(folder: &Path, line: &str) -> (String, String, i32) {
    let programs = std::env::var("PATH").unwrap();
    let programs = format!("{}:{programs}", mdle().parent().unwrap().display());
    let output = Command::new("bash").args(["-c", line]).env("PATH", programs).current_dir(folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (out, err, output.status.code().unwrap())
}

/// Returns a folder with `run.mcap`, the record of a run with these options.
fn recorded(name: &str, options: &str) -> PathBuf {
    let folder = folder(&format!("odd-record-{name}"));
    fs::write(folder.join("square.mdle"), PLAN).unwrap();
    let line =
        format!("mdle run square.mdle --target sim --speed max --body scout --world hall --log run.mcap {options}");
    let (_, err, status) = shell(&folder, &line);
    assert!(matches!(status, 0 | 4), "{err}");
    folder
}

#[test]
fn a_record_may_come_from_a_pipe() {
    let folder = recorded("pipe", "--seed 7");
    let commands = [
        "replay LOG",
        "replay LOG --until 3",
        "why LOG 5.2",
        "why LOG --not turn",
        "log info LOG",
        "log export --csv LOG",
    ];
    for command in commands {
        let file = shell(&folder, &format!("mdle {}", command.replace("LOG", "run.mcap")));
        assert_eq!(file.2, 0, "{command}: {}", file.1);
        let piped = shell(&folder, &format!("cat run.mcap | mdle {}", command.replace("LOG", "-")));
        let named = format!(
            "mkfifo -m 600 run.fifo; cat run.mcap > run.fifo & mdle {}; rm run.fifo",
            command.replace("LOG", "run.fifo")
        );
        let named = shell(&folder, &named);
        for answer in [piped, named] {
            let text = answer.0.replace("why - ", "why run.mcap ").replace("why run.fifo ", "why run.mcap ");
            assert_eq!((text, answer.1.as_str()), (file.0.clone(), ""), "{command}");
        }
    }
    let drawn =
        "cat run.mcap | mdle plot - pipe.svg; mdle plot run.mcap file.svg; diff pipe.svg file.svg | grep -c '^<'";
    assert_eq!(shell(&folder, drawn).0, "2\n", "the pictures differ in the name of the record, which they have twice");
    let (_, err, status) = shell(&folder, "head -c 100000 run.mcap | mdle replay -; mdle replay - < /dev/null");
    assert_eq!((err.lines().count(), status), (1, 2), "{err}");
}

/// Writes a record of `turns` turns to `to`. All turns have the first output of `run.mcap`.
fn long(folder: &Path, turns: u64, to: File) {
    let (begin, mut records) = Records::open(File::open(folder.join("run.mcap")).unwrap()).unwrap();
    let first = records.next().unwrap().unwrap();
    let (mut frames, mut bytes, mut file) = (Frames::default(), Vec::new(), RecordFile::new(to));
    frames.begin(&begin, &first.y, &mut bytes);
    for number in 0..turns {
        let t = mdle_runtime::Nanos(number * 1_000_000_000);
        let y = mdle_runtime::Sensed { at: t, ..first.y };
        let (sent, applied, plan, state) = (first.sent, first.applied, first.plan, first.state);
        let made = TurnMade { number, t, sent, applied, plan, state, changes: &[], overruled: None };
        frames.turn(made, &y, std::iter::empty(), &mut bytes);
        if file.write_all(&std::mem::take(&mut bytes)).is_err() {
            // The reader has closed the pipe.
            return;
        }
    }
    frames.end(&mut bytes);
    file.write_all(&bytes).unwrap();
}

/// Records are read in parts, so a record that is fifty times as long takes no more memory.
#[test]
fn a_long_record_takes_no_more_memory() {
    let folder = recorded("long", "--turns 20");
    let read = |turns: u64, kilobytes: u64| {
        let (reader, writer) = std::io::pipe().unwrap();
        let writer = File::from(std::os::fd::OwnedFd::from(writer));
        let line = format!("ulimit -v {kilobytes}; '{}' log info -", mdle().display());
        let mut command = Command::new("bash");
        let command = command.args(["-c", &line]).current_dir(&folder).stdin(reader);
        let child = command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().unwrap();
        thread::scope(|scope| {
            scope.spawn(|| long(&folder, turns, writer));
            child.wait_with_output().unwrap()
        })
    };
    let least = (2..40).map(|limit| limit * 16_000).find(|limit| read(200, *limit).status.success()).unwrap();
    let output = read(10_000, least + 4_000);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("10000 turns"), "with {least} kB: {text}{}", String::from_utf8_lossy(&output.stderr));
}

/// A time between two turns means the earlier turn; a time outside the run is refused.
#[test]
fn times_outside_of_the_run_are_refused() {
    let folder = recorded("times", "--seed 7 --turns 30");
    let first = |line: &str| {
        let (out, err, status) = shell(&folder, line);
        format!("{line} [{status}]\n{}{err}", out.lines().next().map(|line| format!("{line}\n")).unwrap_or_default())
    };
    let questions = [
        "why run.mcap 0",
        "why run.mcap 50ms",
        "why run.mcap 2.899",
        "why run.mcap 2.9",
        "why run.mcap 2.95",
        "why run.mcap 3",
        "why run.mcap 1h",
    ];
    let more = [
        "log cut run.mcap 1h whole.mcap",
        "log cut run.mcap 50ms one.mcap",
        "replay run.mcap --until 50ms",
        "replay run.mcap --until 1h",
    ];
    let answers = questions.into_iter().chain(more).map(|line| first(&format!("mdle {line}")));
    insta::assert_snapshot!(answers.collect::<String>());
}

/// The plan of a record may use quarks that the alphabet no longer has.
#[test]
fn a_plan_that_the_alphabet_no_longer_fits_is_refused() {
    let folder = recorded("alphabet", "--turns 20");
    let (begin, records) = Records::open(File::open(folder.join("run.mcap")).unwrap()).unwrap();
    let files = vec![("square.mdle".to_owned(), PLAN.replace("turn 90", "spin 90"))];
    let (begin, turns) = (Begin { files, ..begin }, records.map(Result::unwrap).collect::<Vec<_>>());
    let (mut frames, mut bytes) = (Frames::default(), Vec::new());
    frames.begin(&begin, &turns[0].y, &mut bytes);
    frames.end(&mut bytes);
    RecordFile::new(File::create(folder.join("old.mcap")).unwrap()).write_all(&bytes).unwrap();
    let answers = ["replay old.mcap", "why old.mcap 1", "plot old.mcap old.svg", "log info old.mcap"].map(|line| {
        let (out, err, status) = shell(&folder, &format!("mdle {line}"));
        let out: Vec<_> =
            out.lines().filter(|line| !line.starts_with("command") && !line.starts_with("version")).collect();
        format!("{line} [{status}]\n{}\n{err}", out.join("\n"))
    });
    insta::assert_snapshot!(answers.join("\n"));
}
