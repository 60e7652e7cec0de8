//! Tests a run's output: the lines on standard output and the run log.

use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use mdle_runtime::Cause::{Completed, Fired};

use super::plan::ToyPlan;
use super::toy::{Act, AsText, Run, Stage};
use crate::{Pace, Refusal, Time};

/// Returns a stage for a tour through the plan: one interrupt, a completion in the same turn, and the end of a
/// behavior.
fn tour() -> Stage {
    Stage::script([
        Act::Senses(vec![]),
        Act::Senses(vec![(0, Fired(1)), (1, Completed(2))]),
        Act::Senses(vec![]),
        Act::Senses(vec![(2, Fired(1))]),
        Act::Senses(vec![(3, Fired(1))]),
    ])
}

/// Returns a path for a log at which no file exists yet.
fn fresh() -> PathBuf {
    static LOGS: AtomicU32 = AtomicU32::new(0);
    let name = format!("mdle-host-{}-{}.jsonl", std::process::id(), LOGS.fetch_add(1, Ordering::Relaxed));
    std::env::temp_dir().join(name)
}

/// Returns a run with these options, and its log.
fn logged(stage: Stage, options: &[&str]) -> (Run, String) {
    let path = fresh();
    let run = stage.run(&[options, &["--log", path.to_str().unwrap()]].concat());
    let log = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(path).unwrap();
    (run, log)
}

#[test]
fn each_transition_is_a_line() {
    insta::assert_snapshot!(tour().run(&[]).out, @r#"
    0.1 s  rotate 90 (Turn)  <- atIsection 0100
    0.1 s  stop (Turn)  <- completed
    0.3 s  null  <- wait 10 (Turn)
    0.4 s  plan over: heard "stop"
    "#);
}

#[test]
fn the_log_is_a_trace() {
    let (run, log) = logged(tour(), &[]);
    assert_eq!((run.status, &*run.err), (0, ""));
    insta::assert_snapshot!(log, @r#"
    {"turn":0,"t":0.0,"state":1,"law":"go 20 0","fired":[]}
    {"turn":1,"t":0.1,"state":3,"law":"stop","fired":[{"from":1,"level":1,"by":"atIsection 0100","operands":[]},{"from":2,"level":2,"by":"completed","operands":[]}]}
    {"turn":2,"t":0.2,"state":3,"law":"stop","fired":[]}
    {"turn":3,"t":0.3,"state":4,"law":"null","fired":[{"from":3,"level":1,"by":"wait 10","operands":[]}]}
    {"turn":4,"t":0.4,"state":5,"law":null,"fired":[{"from":4,"level":1,"by":"heard \"stop\"","operands":[]}]}
    "#);
}

#[test]
fn a_cut_turn_sends_the_null_input_and_has_no_law() {
    let stage = Stage { plan: ToyPlan::restless(), ..Stage::default() };
    let (run, log) = logged(stage, &["--turns", "2"]);
    assert_eq!(run.journal, "exchange 0, exchange 0, exchange 0, stop, finish");
    assert_eq!(run.out.lines().count(), 2 * 4096);
    let second = log.lines().nth(1).unwrap();
    assert!(second.starts_with(
        r#"{"turn":1,"t":0.1,"state":1,"law":null,"fired":[{"from":1,"level":1,"by":"always","operands":[]},"#
    ));
    assert_eq!(second.matches("always").count(), 4096);
}

#[test]
fn a_log_that_cannot_be_opened_opens_no_robot() {
    let run = Stage::default().run(&["--log", "/nowhere/at/all"]);
    assert_eq!((run.status, &*run.journal), (2, ""));
    assert!(run.err.starts_with("error: the run log /nowhere/at/all cannot be written: "), "{}", run.err);
}

#[test]
fn a_plan_that_replays_paths_opens_no_robot_that_cannot() {
    let run = Stage { plan: ToyPlan::lab().replaying(), ..tour() }.run(&[]);
    assert_eq!((run.status, run.journal.as_str(), run.out.as_str()), (2, "", ""));
    insta::assert_snapshot!(run.err, @"error: the plan replays paths, and the crate of the robot toy does not say how: it needs `Target::PATHS`");
}

#[test]
fn a_refused_start_leaves_the_log_as_it_was() {
    let path = fresh();
    let refused = |options: &[&str], refusal| {
        let run = Stage { refusal, ..tour() }.run(&[options, &["--log", path.to_str().unwrap()]].concat());
        assert_ne!((run.status, &*run.journal), (0, ""), "{}", run.err);
    };
    let all = || {
        refused(&["--device", "/dev/null"], None);
        refused(&[], Some(Refusal::Usage("the start pose is inside a wall".to_owned())));
        refused(&[], Some(Refusal::Fault("nothing answers".to_owned())));
    };
    all();
    assert!(!path.exists());
    std::fs::write(&path, "an old log\n").unwrap();
    all();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "an old log\n");
    std::fs::remove_file(path).unwrap();
}

#[test]
fn a_log_takes_the_place_of_an_older_one() {
    let path = fresh();
    std::fs::write(&path, "an older and longer log\n".repeat(100)).unwrap();
    let run = tour().run(&["--log", path.to_str().unwrap()]);
    assert_eq!(run.status, 0);
    assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 5);
    std::fs::remove_file(path).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_log_that_cannot_begin_stops_the_robot_that_was_opened() {
    let file = rustix::fs::memfd_create("log", rustix::fs::MemfdFlags::ALLOW_SEALING).unwrap();
    rustix::io::write(&file, b"an old log\n").unwrap();
    rustix::fs::fcntl_add_seals(&file, rustix::fs::SealFlags::SHRINK).unwrap();
    let run = tour().run(&["--log", &format!("/proc/self/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&file))]);
    assert_eq!((run.status, &*run.journal), (3, "exchange 0, stop, finish"));
    assert!(run.err.starts_with("error: the run log cannot be written, so the robot was stopped: "), "{}", run.err);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_stops_the_robot() {
    let run = Stage { time: Time::Stepped(Pace::Times(1.0)), ..tour() }.run(&["--log", "/dev/full"]);
    assert_eq!((run.status, &*run.journal), (3, "exchange 0, exchange 0, stop, finish"));
    assert!(run.err.starts_with("error: the run log cannot be written, so the robot was stopped: "), "{}", run.err);
    assert_eq!(run.err.lines().count(), 1, "{}", run.err);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_that_shows_at_the_end_is_a_fault_too() {
    let run = tour().run(&["--log", "/dev/full"]);
    assert_eq!(run.status, 3);
    assert!(run.journal.ends_with("stop, finish"), "{}", run.journal);
    assert!(run.err.starts_with("error: the run log cannot be written: "), "{}", run.err);
}

/// A standard output that takes some bytes and then fails.
struct Failing {
    left: usize,
    kind: io::ErrorKind,
    taken: Vec<u8>,
}

impl Write for Failing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(self.kind.into());
        }
        let count = bytes.len().min(self.left);
        self.left -= count;
        self.taken.extend_from_slice(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl AsText for Failing {
    fn text(&self) -> String {
        self.taken.text()
    }
}

#[test]
fn a_run_goes_on_when_nobody_reads_it() {
    let whole = tour().run(&[]);
    let gone = tour().run_to(&[], Failing { left: 20, kind: io::ErrorKind::BrokenPipe, taken: vec![] });
    assert_eq!((gone.status, &*gone.err), (0, ""));
    assert_eq!(gone.journal, whole.journal);
}

#[test]
fn a_run_goes_on_when_its_report_cannot_be_written_and_says_so() {
    let whole = tour().run(&[]);
    let full = tour().run_to(&[], Failing { left: 20, kind: io::ErrorKind::StorageFull, taken: vec![] });
    assert_eq!(full.status, 0);
    assert!(full.err.starts_with("warning: standard output could not be written: "), "{}", full.err);
    assert_eq!(full.journal, whole.journal);
}

#[test]
fn help_need_not_be_read() {
    let run = Stage::default().run_to(&["--help"], Failing { left: 0, kind: io::ErrorKind::BrokenPipe, taken: vec![] });
    assert_eq!((run.status, &*run.err), (0, ""));
}
