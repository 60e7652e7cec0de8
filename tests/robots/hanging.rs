//! Tests robots that repeat their last data: `[stale]` takes effect before the driver reports a fault.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Faulty, Pace, Port, ScheduledFault, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, mdle};

const PERIOD: Duration = Duration::from_millis(100);

/// Returns a simulated robot in the hall.
fn simulated(body: Body, step: Duration) -> Simulated {
    let world = World::named("hall").unwrap().unwrap();
    let make = Make { body, without: Vec::new(), seed: None };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Runs a plan that drives for a minute on a robot that hangs after two seconds. Returns the output and the exit
/// status.
fn ending<R: Emulated + Send>(folder: &Path, robot: R, pace: Pace, options: &[&str]) -> String {
    fs::write(folder.join("go.mdle"), "{ Go (wait 60s) (Atom (null) (go 20 0)) }\n").unwrap();
    fs::write(folder.join("stale.toml"), "[stale]\noutput = \"150ms\"\nthen = \"end\"\n").unwrap();
    let hangs: ScheduledFault = "hang@2".parse().unwrap();
    let mut robot = Faulty::new(robot, &[hangs]).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let mut command = Command::new(mdle());
    command.args(["run", "go.mdle", "--safety", "stale.toml", "--device"]).arg(port.path());
    command.args(options).current_dir(folder);
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let output = command.output().unwrap();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output
    });
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{out}---\n{err}[{}]", output.status.code().unwrap())
}

#[test]
fn stale_data_of_a_scout_end_the_plan() {
    let (folder, pace) = (folder("hanging_scout"), Pace::Lockstep(PERIOD));
    let robot = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
    let options = ["--target", "scout", "--lockstep", "--log", "run.mcap"];
    insta::assert_snapshot!(ending(&folder, robot, pace, &options), @"
    0.6 s  safety: stale ends the plan
    ---
    stopped by the safety rules: stale
    error: the robot may not have stopped: the Scout still moved when its time to stop was over: press its emergency stop
    [3]
    ");
    let replayed = Command::new(mdle()).args(["replay", "run.mcap"]).current_dir(&folder).output().unwrap();
    let text = String::from_utf8_lossy(&replayed.stdout);
    assert!(replayed.status.success() && text.contains("the same to the bit"), "{text}");
}

/// The test runs in real time, where a turn continues with the last report; in lockstep the driver waits for a report
/// in each turn.
#[test]
fn stale_data_of_an_atrv_end_the_plan() {
    let (folder, pace) = (folder("hanging_atrv"), Pace::Real);
    let robot = Atrv::new(simulated(Body::Atrv, step(pace)), step(pace), false).unwrap();
    let ending = ending(&folder, robot, pace, &["--target", "atrv"]);
    assert!(ending.contains("safety: stale ends the plan"), "{ending}");
}
