//! Tests `mdle shell` with safety rules on the emulated robots.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Pace, Port, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, mdle};

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);

/// Returns a folder with a plan that waits, a plan that drives, and safety rules.
fn with_plans(test: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("null.mdle"), "{ Null (bumper)\n  (Atom (null) stop)\n}\n").unwrap();
    fs::write(folder.join("go.mdle"), "{ Go (bumper)\n  (Atom (null) (go 60 0))\n}\n").unwrap();
    let rules = "[limits]\nspeed = \"30cm/s\"\n\n[guards.far]\nwhen = \"x > 1m\"\nthen = \"end\"\n";
    fs::write(folder.join("rules.toml"), rules).unwrap();
    folder
}

/// Returns a simulated robot in the hall.
fn simulated(body: Body, step: Duration) -> Simulated {
    let world = World::named("hall").unwrap().unwrap();
    let make = Make { body, without: Vec::new(), seed: None };
    Simulated::with(&make, &world, world.start, step).unwrap()
}

/// Returns the command `mdle shell` for the robot at this port, with its clock paused.
fn shell(folder: &Path, target: &str, port: &Port) -> Command {
    let mut command = Command::new(mdle());
    command.args(["shell", "null.mdle", "--target", target, "--safety", "rules.toml", "--paused", "-x"]);
    command.arg("--device").arg(port.path()).arg("--lockstep").current_dir(folder);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Returns the dialogue of a session on an emulated robot, and the exit status.
fn dialogue<R: Emulated + Send>(folder: &Path, target: &str, mut robot: R, commands: &str) -> String {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, IN_LOCKSTEP, &|| !over.load(Ordering::Relaxed)));
        let mut child = shell(folder, target, &port).spawn().unwrap();
        child.stdin.take().unwrap().write_all(commands.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output
    });
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{target}\n{out}---\n{err}[{}]\n", output.status.code().unwrap())
}

#[test]
fn plans_and_rules_hold_on_emulated_robots() {
    let folder = with_plans("sessions");
    let begin =
        "load_plan go.mdle\nstep 5\nset /usr/mdle/main Go\nstep 15\nget /usr/mdle/main\nget /usr/robot/input/v\n";
    let order = "get /usr/robot/ranges/r8\nset /usr/robot/sonars 0 1 15\nget /usr/robot/sonars\n\
                 set /usr/robot/sonars 16\nstep 10\nget /usr/robot/ranges/r8\n";
    let end = "set /safety/limits/speed 10cm/s\nstep 10\nget /usr/robot/v\nset /safety/limits/speed 1m/s\n\
               rollback\nstep 10\nget /usr/mdle/main\nget /usr/robot/v\nswap Go\nset /usr/mdle/trial 0s\nwait\n\
               get /usr/mdle/main\n";
    let scout = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
    let step = step(IN_LOCKSTEP);
    let atrv = Atrv::new(simulated(Body::Atrv, step), step, false).unwrap();
    let all = [
        dialogue(&folder, "scout", scout, &[begin, order, end].concat()),
        dialogue(&folder, "atrv", atrv, &[begin, end].concat()),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

#[test]
fn a_robot_that_is_lost_in_mid_swap_ends_the_session() {
    let folder = with_plans("lost");
    let mut robot = Scout::new(simulated(Body::Scout, PERIOD)).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let mut child = shell(&folder, "scout", &port).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
    thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, IN_LOCKSTEP, &|| !over.load(Ordering::Relaxed)));
        input.write_all(b"load_plan go.mdle\nstep 5\nset /usr/mdle/main Go\nstep 2\nswap Null plan\n").unwrap();
        assert_eq!(answers.by_ref().take(10).last().as_deref(), Some("Null takes over when the plan ends"));
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
    });
    drop(port);
    input.write_all(b"step\nget /usr/mdle/main\n").unwrap();
    drop(input);
    let ended = "7 turns, 0.6s, and the run has ended with exit status 3: a fault ended the plan, and the robot may not have \
                 stopped: the Scout's line was cut: check the cable";
    assert_eq!(answers.collect::<Vec<_>>(), ["> step", ended, "> get /usr/mdle/main", "Go"]);
    let output = child.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(3), "{err}");
    insta::assert_snapshot!(err);
}
