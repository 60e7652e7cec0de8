//! Tests the lab tour on a Super Scout: the executable that `mdlec --target scout` builds drives the emulated robot
//! over a pseudo-terminal, and is compared with a run of the simulator with the same body.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_emulator::{Pace, Port, serve};
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;

const PERIOD: Duration = Duration::from_millis(100);

/// Returns the tour's executable for the Scout, which is built once.
fn on_scout() -> &'static Path {
    static TOUR: OnceLock<PathBuf> = OnceLock::new();
    TOUR.get_or_init(|| tour("scout"))
}

/// Builds the tour's executable for this target.
fn tour(target: &str) -> PathBuf {
    let folder = folder(&format!("tour_on_{target}"));
    let plan = root().join("plans/lab_tour.mdle");
    let output = run_mdlec(&folder, &[plan.to_str().unwrap(), "--target", target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("lab_tour")
}

/// Returns the lines of a run's report without the times: the atoms in order, and the end of the run.
fn passed(output: &Output) -> Vec<String> {
    let message = String::from_utf8(output.stdout.clone()).unwrap();
    message.lines().map(|line| line.split_once(" s  ").map_or(line, |(_, transition)| transition).to_owned()).collect()
}

/// Runs the executable on an emulated robot. Returns the output, and the pose of the robot at the end.
fn emulated(executable: &Path) -> (Output, Pose) {
    let world = World::office().unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let mut robot = Scout::new(Simulated::with(&make, &world, world.start, PERIOD).unwrap()).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving =
            scope.spawn(|| serve(&mut robot, &port, Pace::Lockstep(PERIOD), &|| !over.load(Ordering::Relaxed)));
        let output = Command::new(executable)
            .arg("--device")
            .arg(port.path())
            .args(["--lockstep", "--timeout", "400", "--plot", "tour.svg", "--trail", "tour.csv"])
            .current_dir(executable.parent().unwrap())
            .output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    });
    (output, robot.pose())
}

#[test]
fn the_tour_ends_on_a_scout_where_it_ends_in_the_simulator() {
    let (scout, pose) = emulated(on_scout());
    assert!(scout.status.success(), "{}", String::from_utf8_lossy(&scout.stderr));
    check_views();

    let in_simulator = tour("sim");
    let trail = in_simulator.with_file_name("trail.csv");
    let mut run = Command::new(in_simulator);
    let run = run.args(["--body", "scout", "--speed", "max", "--trail"]).arg(&trail).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(passed(&scout), passed(&run));
    assert_eq!(passed(&scout).last().map(String::as_str), Some("plan over: completed (lab_tour.mdle:30)"));

    let trail = fs::read_to_string(trail).unwrap();
    let end: Vec<f64> = trail.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    let [_, x, y, heading, ..] = end[..] else { panic!("{end:?}") };
    let away = libm::hypot(pose.x.0 - x, pose.y.0 - y);
    let turned = (pose.theta.degrees() - heading + 180.0).rem_euclid(360.0) - 180.0;
    assert!(away <= 0.15 && turned.abs() <= 5.0, "{away} m and {turned} degrees away from {x}, {y}, {heading}");
}

/// Asserts that the executable draws the run by the robot's own odometry, although it has no world.
fn check_views() {
    let [picture, trail] =
        ["tour.svg", "tour.csv"].map(|file| fs::read_to_string(on_scout().with_file_name(file)).unwrap());
    assert!(picture.contains("robot scout, by odometry") && picture.contains("goAvoid 90 40 20"), "{picture}");
    assert!(trail.lines().count() > 1000, "{} rows", trail.lines().count());
}

/// Returns the output of the executable with these arguments, and its exit status.
fn message(arguments: &[&str]) -> String {
    let output = Command::new(on_scout()).args(arguments).current_dir(on_scout().parent().unwrap()).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    format!("{out}{err}[{}]\n", output.status.code().unwrap())
}

#[test]
fn the_configuration_says_what_holds_and_why() {
    let file = |name: &str, text: &str| fs::write(on_scout().with_file_name(name), text).unwrap();
    file("ours.toml", "watchdog = 2\nring-radius = 0.2\n");
    file("key.toml", "watchdog = 2\nspeed = 1\n");
    file("value.toml", "watchdog = 0\n");
    file("gap.toml", "gap = 15\n");
    file("sonar.toml", "sonars = [0, 16]\n");
    let all = [
        message(&["--print-config"]),
        message(&["--print-config", "--config", "ours.toml", "--device", "tcp:192.168.1.7:65001"]),
        message(&["--config", "key.toml"]),
        message(&["--config", "value.toml"]),
        message(&["--config", "gap.toml"]),
        message(&["--config", "sonar.toml"]),
        message(&["--config", "none.toml"]),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn a_robot_that_is_not_there_is_a_fault() {
    insta::assert_snapshot!([message(&["--device", "/dev/null"]), message(&["--device", "/nowhere"])].join("\n"));
}
