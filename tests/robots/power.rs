//! Tests that a plan that depends on the battery and the charger behaves equally on each emulated robot that has them.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::fs;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Faulty, Pace, Port, ScheduledFault, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};

const PERIOD: Duration = Duration::from_millis(100);
const PACE: Pace = Pace::Lockstep(PERIOD);
/// A plan that drives until the battery is low, and then stops until the robot is plugged in.
const PLAN: &str = "{ Home (charger OR wait 30s) (Atom (lowBattery OR battery < 5V) (go 10 0)) (Atom (null) stop) }\n";

/// Faults of a robot: its battery is low after 5 s, and it is plugged in after 10 s.
const FAULTS: [&str; 2] = ["low-battery@5", "plugged-in@10"];

/// Runs a plan on this robot with these faults, and returns its report without times.
fn reported<R: Emulated + Send>(target: &str, plan: &str, faults: &[&str], robot: R) -> Vec<String> {
    let folder = folder(&format!("power_on_{target}_{}", faults.len()));
    fs::write(folder.join("home.mdle"), plan).unwrap();
    let output = run_mdlec(&folder, &["home.mdle", "--target", target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let faults: Vec<ScheduledFault> = faults.iter().map(|text| text.parse().expect("a fault")).collect();
    let mut robot = Faulty::new(robot, &faults).expect("a robot");
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, PACE, &|| !over.load(Ordering::Relaxed)));
        let output = Command::new(folder.join("home")).arg("--device").arg(port.path()).arg("--lockstep").output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    });
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    transitions(&output.stdout)
}

/// Returns the lines of a report without their times.
fn transitions(report: &[u8]) -> Vec<String> {
    let report = String::from_utf8(report.to_vec()).unwrap();
    report.lines().map(|line| line.split_once(" s  ").map_or(line, |(_, transition)| transition).to_owned()).collect()
}

/// A floor with a charger ahead of the start; `DOCK` is a plan that drives until the robot is on the charger.
const FLOOR: &str = "charger = { at = [1, 0], heading = 0, reach = 0.15 }\n";
const DOCK: &str = "{ Dock (wait 1min) (Atom (charger) (go 10 0)) (Atom (wait 2s) stop) }\n";

#[test]
fn every_robot_finds_the_charger_of_its_world() {
    let world = World::parse("floor", FLOOR).unwrap();
    let body = |body, step| {
        Simulated::with(&Make { body, without: Vec::new(), seed: None }, &world, world.start, step).unwrap()
    };
    let scout = reported("scout", DOCK, &[], Scout::new(body(Body::Scout, PERIOD)).unwrap());
    let step = step(PACE);
    let atrv = reported("atrv", DOCK, &[], Atrv::new(body(Body::Atrv, step), step, false).unwrap());
    assert_eq!(scout, ["stop (home.mdle:1)  <- charger (home.mdle:1)", "plan over: wait 2s (home.mdle:1)"]);
    assert_eq!(atrv, scout);
    let folder = folder("dock_of_sim");
    fs::write(folder.join("home.mdle"), DOCK).unwrap();
    fs::write(folder.join("floor.toml"), FLOOR).unwrap();
    let output = run_mdlec(&folder, &["home.mdle", "--target", "sim"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output =
        Command::new(folder.join("home")).args(["--speed", "max", "--world"]).arg(folder.join("floor.toml")).output();
    assert_eq!(transitions(&output.unwrap().stdout), scout);
}

#[test]
fn a_robot_stops_when_its_battery_is_low_and_is_done_when_it_is_plugged_in() {
    let body = |body, step| {
        let (world, make) = (World::office().unwrap(), Make { body, without: Vec::new(), seed: None });
        Simulated::with(&make, &world, world.start, step).unwrap()
    };
    let scout = reported("scout", PLAN, &FAULTS, Scout::new(body(Body::Scout, PERIOD)).unwrap());
    let step = step(PACE);
    let atrv = reported("atrv", PLAN, &FAULTS, Atrv::new(body(Body::Atrv, step), step, false).unwrap());
    assert_eq!(
        scout,
        [
            "stop (home.mdle:1)  <- lowBattery (home.mdle:1, of \"lowBattery OR battery < 5V\")",
            "plan over: charger (home.mdle:1, of \"charger OR wait 30s\")",
        ]
    );
    assert_eq!(atrv, scout);
}
