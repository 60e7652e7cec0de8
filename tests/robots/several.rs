//! Tests two Scouts in one world, each with its own executable, in lockstep. They detect and touch each other, with the
//! same result in every run.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use mdle_emulator::{Embodied, Pace, Port, Seat, Several};
use mdle_runtime::{Meters, Pose, Radians};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Footprint, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};

const PERIOD: Duration = Duration::from_millis(100);
/// A room in which, for two robots that are 3 m apart, nothing is nearer than the other robot.
const ROOM: &str =
    "start = { x = -1.5, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[4, -3], [4, 3], [-4, 3], [-4, -3], [4, -3]]";
const APPROACH: &str = "{ Approach (bumper OR wait 30s) (Atom (r0 < 60cm) (go 20 0)) }\n";
const MEET: &str = "{ Meet (bumper OR wait 30s) (Atom (null) (go 20 0)) }\n";
const STAY: &str = "{ Stay (wait 3s) (Atom (null) stop) }\n";

/// Builds the executable of a plan for the Scout, and returns its path.
fn executable(folder: &Path, name: &str, plan: &str) -> PathBuf {
    let file = format!("{name}.mdle");
    fs::write(folder.join(&file), plan).unwrap();
    let output = run_mdlec(folder, &[&file, "--target", "scout"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join(name)
}

/// Returns a robot with its line. The robot is 1.5 m from the middle of the room, and faces the middle.
fn seat(is_left: bool) -> Seat<Scout> {
    let world = World::parse("room", ROOM).unwrap();
    let there = Pose { x: Meters(1.5), theta: Radians::from_degrees(180.0), ..world.start };
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let body = Simulated::with(&make, &world, if is_left { world.start } else { there }, PERIOD).unwrap();
    Seat { robot: Scout::new(body).unwrap(), port: Port::open().unwrap() }
}

/// Runs two executables, each on its own robot. Returns their outputs and the final footprints of the robots.
fn together(executables: [&Path; 2]) -> ([String; 2], [Footprint; 2]) {
    let mut robots = Several::of(vec![seat(true), seat(false)]).unwrap();
    let mut started = executables.iter().zip(robots.seats()).map(|(executable, seat)| {
        let mut command = Command::new(executable);
        let command = command.args(["--lockstep", "--device"]).arg(seat.port.path());
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    });
    let children: RefCell<[Child; 2]> = RefCell::new([started.next().unwrap(), started.next().unwrap()]);
    drop(started);
    let goes_on = || children.borrow_mut().iter_mut().any(|child| child.try_wait().unwrap().is_none());
    robots.serve(Pace::Lockstep(PERIOD), &goes_on).unwrap();
    let message = children.into_inner().map(|child| {
        let output = child.wait_with_output().unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        format!("{out}{err}[{}]", output.status.code().unwrap())
    });
    let footprints = [0, 1].map(|seat: usize| robots.seats()[seat].robot.footprint());
    (message, footprints)
}

fn gap([one, other]: [Footprint; 2]) -> f64 {
    one.gap(&other)
}

#[test]
fn a_robot_stops_before_another_one_whose_driver_has_gone() {
    let folder = folder("several_stop");
    let (approach, stay) = (executable(&folder, "approach", APPROACH), executable(&folder, "stay", STAY));
    let (message, footprints) = together([&approach, &stay]);
    assert!(
        message[0].contains("plan over: r0 = ")
            && message[0].contains(" m < 60cm (approach.mdle:1)")
            && message[0].ends_with("[0]"),
        "{}",
        message[0]
    );
    assert!(message[1].contains("plan over: wait 3") && message[1].ends_with("[0]"), "{}", message[1]);
    // After the ping that ended the plan, the robot has driven on for at most one round of its sonars.
    assert!((0.35..0.6).contains(&gap(footprints)), "{}", gap(footprints));
    assert_eq!(together([&approach, &stay]), (message, footprints));
}

#[test]
fn robots_that_meet_touch_each_other() {
    let folder = folder("several_meet");
    let meet = executable(&folder, "meet", MEET);
    let (message, footprints) = together([&meet, &meet]);
    for message in &message {
        assert!(message.contains("plan over: bumper") && message.ends_with("[0]"), "{message}");
    }
    assert!((0.0..0.005).contains(&gap(footprints)), "{}", gap(footprints));
    assert_eq!(together([&meet, &meet]), (message, footprints));
}
