//! Tests a session on a robot whose time is the wall clock.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use mdle_emulator::{Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, mdle};

/// Runs the commands of a session on an emulated Scout, which stands; returns the answers.
fn answers(test: &str, commands: &str) -> Vec<String> {
    let folder = folder(test);
    fs::write(folder.join("stand.mdle"), "{ Stand (wait 60s)\n  (Atom (null) stop)\n}\n").unwrap();
    fs::write(folder.join("commands.txt"), commands).unwrap();
    let world = World::named("hall").unwrap().unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let mut robot = Scout::new(Simulated::with(&make, &world, world.start, Pace::Real.step()).unwrap()).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, Pace::Real, &|| !over.load(Ordering::Relaxed)));
        let mut command = Command::new(mdle());
        command.args(["shell", "stand.mdle", "--target", "scout", "-c", "commands.txt", "--device"]);
        let output = command.arg(port.path()).current_dir(&folder).stdin(Stdio::null()).output().unwrap();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output
    });
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

/// Nothing changes between two breaks, so that a reading there needs no turn.
#[test]
fn many_readings_take_few_turns() {
    let readings = "get /clock/period\n".repeat(300);
    let answers = answers("clock_readings", &format!("{readings}get /clock/turns\n"));
    let (turns, readings) = answers.split_last().unwrap();
    assert_eq!(readings, vec!["0.1s"; 300]);
    assert!(turns.parse::<u64>().unwrap() < 100, "{turns}");
}

#[test]
fn a_session_reads_how_late_turns_are() {
    let commands = "wait 1s\nget /clock/late/p50\nget /clock/late/p99\nget /clock/late/max\n\
                    get /clock/missed\n";
    let answers = answers("clock_late", commands);
    let [_, p50, p99, max, missed] = answers.as_slice() else { panic!("{answers:?}") };
    let milliseconds = |text: &String| text.strip_suffix("ms").unwrap().parse::<f64>().unwrap();
    let [p50, p99, max] = [p50, p99, max].map(milliseconds);
    assert!(0.0 < p50 && p50 <= p99 && p99 <= max, "{answers:?}");
    assert!(missed.parse::<u64>().is_ok(), "{answers:?}");
}
