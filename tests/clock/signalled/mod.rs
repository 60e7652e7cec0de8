//! Tests every signal that can be caught, at twenty points of a run, on both robots: the robot is at rest, as its last
//! command requires, and the exit status names the signal.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

pub(crate) mod run;
mod suspended;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use mdle_atrv_emulator::atrv::Atrv;
use mdle_emulator::Pace;
use mdle_scout_emulator::scout::Scout;
use mdle_tests::executable::folder;

use self::run::{AT_REST, LOCKSTEP, Ran, Robot, drove, ran, send, try_send};
use super::at_once;

/// Signals that end a program by default and can be caught, including a real-time signal; SIGUSR1, SIGPIPE and SIGXFSZ
/// are left out.
const SIGNALS: [i32; 17] = [1, 2, 3, 5, 6, 7, 12, 14, 15, 16, 24, 26, 27, 29, 30, 31, 40];
/// Number of points of a run at which signals are sent: before the first command, after the last one, and between them.
const MOMENTS: usize = 20;
/// Number of runs at the same time.
const AT_A_TIME: usize = 8;

/// Writes a configuration that makes all sonars of a Scout ping early in the run, and returns its path.
fn config(folder: &Path, robot: &str) -> std::path::PathBuf {
    let file = folder.join(robot);
    std::fs::write(&file, if robot == Scout::NAME { "gap = 4\n" } else { "" }).unwrap();
    file
}

/// Returns a run in which a signal is sent after a number of commands; `None` for a run without a signal.
fn signalled<R: Robot>(config: &Path, pace: Pace, signal: Option<(i32, usize)>) -> Ran<R> {
    let mut left = signal;
    ran::<R>(config, pace, None, &mut |_, received, _| {
        if let Some((signal, _)) = left.take_if(|(_, after)| received.commands >= *after) {
            // A program that has sent its last commands may be over before the robot obeys them.
            try_send(signal, received.process);
        }
    })
}

/// Returns a description of what is wrong with a run, or `None` if nothing is wrong.
fn wrong<R: Robot>(signal: i32, ran: &Ran<R>) -> Option<String> {
    let (status, errors) = (ran.output.status, ran.errors());
    let is_commanded = !ran.received.bytes.is_empty();
    let is_right = match status.code() {
        // Before the first command, a signal has its default effect; after the end of the plan, it has none.
        None => status.signal() == Some(signal) && !is_commanded,
        Some(0) => String::from_utf8_lossy(&ran.output.stdout).contains("plan over: "),
        // Before the robot is opened, a signal without a name in the library also ends the program with this status.
        Some(code) if code == 128 + signal => errors.contains("stopped by SIG") || !is_commanded,
        Some(_) => false,
    };
    let mut wrong = String::new();
    if !is_right {
        let _ = write!(wrong, "{status}, {errors} ");
    }
    if ran.moves > AT_REST {
        let _ = write!(wrong, "it moves on by {} m ", ran.moves);
    }
    let bytes = &ran.received.bytes;
    if is_commanded && !ran.robot.is_secured(bytes) {
        let _ = write!(wrong, "it received {:02X?} last", &bytes[bytes.len().saturating_sub(150)..]);
    }
    (!wrong.is_empty()).then_some(wrong)
}

/// Asserts that every signal at every point of a run stops the robot correctly.
fn every_signal<R: Robot>() {
    let folder = folder(&format!("signalled_{}", R::NAME));
    let config = config(&folder, R::NAME);
    let commands = signalled::<R>(&config, LOCKSTEP, None).received.commands;
    let moments = (0..MOMENTS).map(|moment| moment * commands / (MOMENTS - 1));
    let cases: Vec<(i32, usize)> = moments.flat_map(|after| SIGNALS.map(|signal| (signal, after))).collect();
    let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some((signal, after)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let ran = signalled::<R>(&config, LOCKSTEP, Some((*signal, *after)));
                    let result = (ran.output.status.to_string(), wrong(*signal, &ran));
                    results.lock().unwrap().push((*signal, *after, result));
                }
            });
        }
    });
    let results = results.into_inner().unwrap();
    let wrong: Vec<_> = results.iter().filter(|(.., (_, wrong))| wrong.is_some()).collect();
    assert!(wrong.is_empty(), "{} of {}: {:#?}", wrong.len(), results.len(), &wrong[..wrong.len().min(10)]);
    // The signals were sent before, during and after the run.
    let mut statuses = BTreeMap::<&str, usize>::new();
    results.iter().for_each(|(.., (status, _))| *statuses.entry(status).or_default() += 1);
    let over = statuses.get("exit status: 0").copied().unwrap_or_default();
    assert!(over >= SIGNALS.len() && over < results.len() / 2, "{statuses:?}");
}

#[test]
fn every_signal_at_every_moment_stops_a_scout() {
    every_signal::<Scout>();
}

#[test]
fn every_signal_at_every_moment_stops_an_atrv() {
    every_signal::<Atrv>();
}

/// Asserts that a signal stops a driving robot correctly by the clock.
fn by_the_clock<R: Robot>() {
    let folder = folder(&format!("signalled_by_the_clock_{}", R::NAME));
    let mut left = true;
    let ran = ran::<R>(&config(&folder, R::NAME), Pace::Real, None, &mut |robot, received, _| {
        if left && drove(robot) {
            left = false;
            send(15, received.process);
        }
    });
    assert_eq!((wrong(15, &ran), ran.output.status.code()), (None, Some(143)));
}

#[test]
fn a_signal_stops_both_robots_by_the_clock() {
    at_once(&[by_the_clock::<Scout>, by_the_clock::<Atrv>]);
}

#[test]
fn a_signal_ends_a_start_that_waits_for_the_robot() {
    // While a Scout sets its position to zero, which may take seconds, it does not answer.
    let zero = mdle_scout::Command::Zero;
    let folder = folder("signalled_zeroing");
    for pace in [LOCKSTEP, Pace::Real] {
        let mut left = true;
        let ran = ran::<Scout>(&config(&folder, Scout::NAME), pace, Some(zero.kind()), &mut |_, received, _| {
            if left && received.bytes.ends_with(&zero.frame().bytes()) {
                left = false;
                send(15, received.process);
            }
        });
        assert_eq!((ran.output.status.code(), &*ran.errors()), (Some(143), "stopped by SIGTERM\n"), "{pace:?}");
        assert_eq!(wrong(15, &ran), None);
    }
}
