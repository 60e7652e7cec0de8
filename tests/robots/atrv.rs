//! Tests the lab tour on an ATRV-mini: the executable that `mdlec --target atrv` builds drives the emulated robot over
//! a pseudo-terminal, and is compared with a run of the simulator with the same body. Also tests the messages about a
//! device without a robot.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_atrv_emulator::wire::{Incoming, report};
use mdle_emulator::{Ailment, Emulated, Pace, Port, serve};
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::repository::root;

/// Pace of the emulator, for which no result depends on the speed of this machine.
const IN_LOCKSTEP: Pace = Pace::Lockstep(Duration::from_millis(100));

/// Returns the tour's executable for the ATRV, which is built once.
fn on_atrv() -> &'static Path {
    static TOUR: OnceLock<PathBuf> = OnceLock::new();
    TOUR.get_or_init(|| tour("atrv"))
}

/// Builds the tour's executable for this target.
fn tour(target: &str) -> PathBuf {
    let folder = folder(&format!("tour_beside_atrv_on_{target}"));
    let plan = root().join("plans/lab_tour.mdle");
    let output = run_mdlec(&folder, &[plan.to_str().unwrap(), "--target", target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.join("lab_tour")
}

/// Returns the lines of a run's report without the times: the atoms in order, and the end of the run.
fn passed(output: &Output) -> Vec<String> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(|line| line.split_once(" s  ").map_or(line, |(_, transition)| transition).to_owned()).collect()
}

/// Returns an emulated robot at the start of the tour.
fn robot(pace: Pace) -> Atrv {
    let world = World::office().unwrap();
    let make = Make { body: Body::Atrv, without: Vec::new(), seed: None };
    let body = Simulated::with(&make, &world, world.start, step(pace)).unwrap();
    Atrv::new(body, step(pace), false).unwrap()
}

/// Runs the executable with these arguments on this robot. Returns the output and the robot.
fn emulated<R: Emulated + Send>(mut robot: R, pace: Pace, arguments: &[&str]) -> (Output, R) {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let executable = on_atrv();
    let output = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let output = Command::new(executable).arg("--device").arg(port.path()).args(arguments).output();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        output.unwrap()
    });
    (output, robot)
}

#[test]
fn the_tour_ends_on_an_atrv_where_it_ends_in_the_simulator() {
    let (atrv, robot) = emulated(robot(IN_LOCKSTEP), IN_LOCKSTEP, &["--lockstep", "--timeout", "400"]);
    assert!(atrv.status.success(), "{}", String::from_utf8_lossy(&atrv.stderr));
    assert!(robot.is_braked());
    let pose = robot.pose();

    let in_simulator = tour("sim");
    let trail = in_simulator.with_file_name("trail.csv");
    let mut run = Command::new(in_simulator);
    let run = run.args(["--body", "atrv", "--speed", "max", "--trail"]).arg(&trail).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(passed(&atrv), passed(&run));
    assert_eq!(passed(&atrv).last().map(String::as_str), Some("plan over: completed (lab_tour.mdle:30)"));

    let trail = fs::read_to_string(trail).unwrap();
    let end: Vec<f64> = trail.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    let [_, x, y, heading, ..] = end[..] else { panic!("{end:?}") };
    let away = libm::hypot(pose.x.0 - x, pose.y.0 - y);
    let turned = (pose.theta.degrees() - heading + 180.0).rem_euclid(360.0) - 180.0;
    println!("{away:.3} m and {turned:.2} degrees away");
    assert!(away <= 0.15 && turned.abs() <= 5.0, "{away} m and {turned} degrees away from {x}, {y}, {heading}");
}

/// Returns the output of the executable with these arguments, without a robot, and its exit status.
fn printed(arguments: &[&str]) -> String {
    let output = Command::new(on_atrv()).args(arguments).current_dir(on_atrv().parent().unwrap()).output().unwrap();
    listed(&output)
}

fn listed(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8(bytes.clone()).unwrap());
    format!("{out}{err}[{}]\n", output.status.code().unwrap())
}

#[test]
fn the_configuration_says_what_holds_and_why() {
    let file = |name: &str, text: &str| fs::write(on_atrv().with_file_name(name), text).unwrap();
    file("ours.toml", "sonars = 16\nunits-per-metre = 194232.294\nbumpers = \"bits\"\n");
    file("key.toml", "sonar = 16\n");
    file("value.toml", "reach = 0\n");
    file("sonars.toml", "sonars = 12\n");
    file("escape.toml", "escape = \"stuff\"\n");
    file("bumpers.toml", "bumpers = \"one\"\n");
    file("reports.toml", "reports = 200\nanswer = 150\n");
    file("watchdog.toml", "watchdog = 150\n");
    let all = [
        printed(&["--print-config"]),
        printed(&["--print-config", "--config", "ours.toml", "--device", "tcp:192.168.1.7:65001"]),
        printed(&["--config", "key.toml"]),
        printed(&["--config", "value.toml"]),
        printed(&["--config", "sonars.toml"]),
        printed(&["--config", "escape.toml"]),
        printed(&["--config", "bumpers.toml"]),
        printed(&["--config", "reports.toml"]),
        printed(&["--config", "watchdog.toml"]),
        printed(&["--config", "none.toml"]),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// A device that answers every command with the same bytes.
struct Answers(Incoming, Vec<u8>, Vec<Vec<u8>>);

impl Answers {
    fn with(bytes: Vec<u8>) -> Self {
        Self(Incoming::default(), bytes, Vec::new())
    }
}

impl Emulated for Answers {
    fn push(&mut self, bytes: &[u8]) {
        self.0.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.0.next_request()?;
        self.2.push(self.1.clone());
        Some(false)
    }

    fn pass(&mut self, _: Duration) -> Result<(), String> {
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        std::mem::take(&mut self.2)
    }

    fn can_suffer(_: Ailment) -> bool {
        false
    }

    fn suffer(&mut self, _: Ailment) {}
}

#[test]
fn a_robot_that_is_none_is_a_fault() {
    let of = |bytes: Vec<u8>| listed(&emulated(Answers::with(bytes), IN_LOCKSTEP, &["--lockstep"]).0);
    let busy = Port::open().unwrap();
    let held = fs::File::open(busy.path()).unwrap();
    held.try_lock().unwrap();
    let busy = busy.path().to_str().unwrap();
    let mut emergency = robot(IN_LOCKSTEP);
    emergency.emergency = true;
    // The drivers run at the same time, because in lockstep a driver waits for long.
    let answers = thread::scope(|scope| {
        let noise = b"Noise on the line.".to_vec();
        let answers = [Vec::new(), noise, report(9, 0, 4, &[0; 25], &[]), report(2, 0, 33, &[0; 24], &[])];
        answers.map(|bytes| scope.spawn(move || of(bytes))).map(|answer| answer.join().unwrap())
    });
    let all = [
        printed(&["--device", "/dev/null"]),
        printed(&["--device", "/nowhere"]),
        printed(&["--device", busy]).replace(busy, "/dev/pts/N"),
        answers.join("\n"),
        listed(&emulated(emergency, IN_LOCKSTEP, &["--lockstep"]).0),
    ];
    insta::assert_snapshot!(all.join("\n"));
}

/// A robot to which an event happens once it moves. The event returns `true` to silence the robot; the last field is
/// `true` once the robot is silent.
struct Then(Atrv, fn(&mut Atrv) -> bool, bool);

impl Emulated for Then {
    fn push(&mut self, bytes: &[u8]) {
        self.0.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.0.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.0.pass(time)
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        let frames = self.0.take_frames();
        self.2 |= self.0.velocity().v.0 > 0.1 && (self.1)(&mut self.0);
        if self.2 { Vec::new() } else { frames }
    }

    fn can_suffer(_: Ailment) -> bool {
        false
    }

    fn suffer(&mut self, _: Ailment) {}
}

#[test]
fn a_robot_that_fails_on_its_way_is_stopped() {
    let on_its_way = |happens: fn(&mut Atrv) -> bool| {
        let (output, Then(mut robot, ..)) =
            emulated(Then(robot(IN_LOCKSTEP), happens, false), IN_LOCKSTEP, &["--lockstep"]);
        assert!(robot.is_braked());
        robot.pass(Duration::from_millis(300)).unwrap();
        assert_eq!(robot.velocity().v.0, 0.0);
        let listed = listed(&output);
        let end = listed.find("error:").map(|place| listed.split_at(place).1);
        end.unwrap_or(&listed).to_owned()
    };
    // The robot sends nothing more, though it still receives; or its emergency stop is pressed.
    let silent = on_its_way(|_| true);
    let stopped = on_its_way(|robot| {
        robot.emergency = true;
        false
    });
    insta::assert_snapshot!([silent, stopped].join("\n"));
}

#[test]
fn a_line_that_is_cut_ends_the_run() {
    let port = Port::open().unwrap();
    let mut robot = robot(IN_LOCKSTEP);
    let path = port.path().to_owned();
    let moves = AtomicBool::new(false);
    let output = thread::scope(|scope| {
        let run =
            scope.spawn(|| Command::new(on_atrv()).arg("--lockstep").arg("--device").arg(&path).output().unwrap());
        let seen = &moves;
        let mut watched = Moves(&mut robot, seen);
        serve(&mut watched, &port, IN_LOCKSTEP, &|| !seen.load(Ordering::Relaxed)).unwrap();
        drop(port);
        run.join().unwrap()
    });
    insta::assert_snapshot!(listed(&output));
}

/// A robot that sets a flag once it moves.
struct Moves<'a>(&'a mut Atrv, &'a AtomicBool);

impl Emulated for Moves<'_> {
    fn push(&mut self, bytes: &[u8]) {
        self.0.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.0.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.0.pass(time)?;
        self.1.fetch_or(self.0.velocity().v.0 > 0.1, Ordering::Relaxed);
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        self.0.take_frames()
    }

    fn can_suffer(_: Ailment) -> bool {
        false
    }

    fn suffer(&mut self, _: Ailment) {}
}
