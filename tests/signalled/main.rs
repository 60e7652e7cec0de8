//! Every signal that can be caught, at twenty moments of a run on both robots: the robot stands, and the status says why.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod suspended;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock};
use std::thread;
use std::time::{Duration, Instant};

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Ailment, Emulated, Pace, Port, STEP, serve};
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::folder;

/// The signals that end a program by default and can be caught, but for SIGUSR1, SIGPIPE and SIGXFSZ, and one that is real-time.
const SIGNALS: [i32; 17] = [1, 2, 3, 5, 6, 7, 12, 14, 15, 16, 24, 26, 27, 29, 30, 31, 40];
/// The moments: so many, so far apart. A run takes some two seconds.
const MOMENTS: u32 = 20;
const APART: Duration = Duration::from_millis(120);
/// How many runs are made at the same time: they sleep most of the time.
const AT_A_TIME: usize = 32;
/// How often a run is tried: on a busy machine an emulated robot may answer too late, which is a fault of its own.
const TRIES: usize = 4;
/// A robot that moves less than this in a tenth of a second stands, in metres.
const STANDS: f64 = 0.001;
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[9, -9], [9, 9], [-9, 9], [-9, -9], [9, -9]]";

/// A run: on which robot, which signal, and which moment.
#[derive(Debug, Clone, Copy)]
struct Case {
    robot: &'static str,
    signal: i32,
    moment: u32,
}

/// A robot that notes whether it was ever told anything.
struct Told<R> {
    robot: R,
    was_told: bool,
}

impl<R: Emulated> Emulated for Told<R> {
    fn push(&mut self, bytes: &[u8]) {
        self.was_told = true;
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.robot.pass(time)
    }

    fn said(&mut self) -> Vec<Vec<u8>> {
        self.robot.said()
    }

    fn can_suffer(ailment: Ailment) -> bool {
        R::can_suffer(ailment)
    }

    fn suffer(&mut self, ailment: Ailment) {
        self.robot.suffer(ailment);
    }
}

/// What a run came to.
struct Came<R> {
    robot: R,
    output: Output,
    was_told: bool,
    /// How far the robot moved in a tenth of a second after the program had ended, in metres.
    moves: f64,
}

fn body(body: Body, step: Duration) -> Simulated {
    let world = World::parse("room", ROOM).unwrap();
    Simulated::with(&Make { body, without: Vec::new(), seed: None }, &world, world.start, step).unwrap()
}

/// Starts the program on this device, with its configuration in `folder`.
fn started(case: Case, device: &Path, folder: &Path) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ahead"));
    command.env("ROBOT", case.robot).arg("--device").arg(device).arg("--config").arg(folder.join(case.robot));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Sends a signal to a process that may just have ended, and does not wait: a robot goes on meanwhile.
fn send(signal: i32, process: u32) {
    let kill = format!("kill -{signal} {process}");
    thread::spawn(move || Command::new("sh").args(["-c", &kill]).stderr(Stdio::null()).status());
}

/// The distance between two poses, in metres.
fn distance(one: &Pose, other: &Pose) -> f64 {
    libm::hypot(one.x.0 - other.x.0, one.y.0 - other.y.0)
}

/// Makes the run of a case with this robot.
fn run<R: Emulated>(case: Case, folder: &Path, robot: R, pose: fn(&R) -> Pose) -> Came<R> {
    let port = Port::open().unwrap();
    let child = Mutex::new(started(case, port.path(), folder));
    let (begun, sent) = (Instant::now(), OnceLock::new());
    let mut told = Told { robot, was_told: false };
    let goes_on = || {
        let mut child = child.lock().unwrap();
        if begun.elapsed() >= APART * case.moment && sent.set(()).is_ok() && child.try_wait().unwrap().is_none() {
            send(case.signal, child.id());
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "{case:?} never ends");
        child.try_wait().unwrap().is_none()
    };
    serve(&mut told, &port, Pace::Real, &goes_on).unwrap();
    let output = child.into_inner().unwrap().wait_with_output().unwrap();
    let before = pose(&told.robot);
    (0..10).for_each(|_| told.pass(STEP).unwrap());
    let after = pose(&told.robot);
    let moves = distance(&before, &after);
    Came { robot: told.robot, output, was_told: told.was_told, moves }
}

/// What is wrong with what came, if anything is.
fn wrong<R>(case: Case, came: &Came<R>, holds: impl Fn(&R) -> bool) -> Option<String> {
    let Came { robot, output, was_told, moves } = came;
    let (status, errors) = (output.status, String::from_utf8_lossy(&output.stderr));
    let is_right = match status.code() {
        // Before anything was told, a signal does what it always does; behind the end of the plan, nothing.
        None => status.signal() == Some(case.signal) && !was_told,
        Some(0) => String::from_utf8_lossy(&output.stdout).contains("plan over: "),
        // A signal without a name in the library ends the program like this before the robot is opened.
        Some(code) if code == 128 + case.signal => errors.contains("stopped by SIG") || !was_told,
        Some(_) => false,
    };
    let mut wrong = String::new();
    if !is_right {
        let _ = write!(wrong, "{status}, {errors} ");
    }
    if *moves > STANDS {
        let _ = write!(wrong, "it moves on by {moves} m ");
    }
    if *was_told && !holds(robot) {
        wrong += "its brake is not set";
    }
    (!wrong.is_empty()).then_some(wrong)
}

/// Makes the run of a case; the status, and what is wrong.
fn tried(case: Case, folder: &Path) -> (String, Option<String>) {
    if case.robot == "scout" {
        let robot = Scout::new(body(Body::Scout, STEP)).unwrap();
        let came = run(case, folder, robot, Scout::pose);
        (came.output.status.to_string(), wrong(case, &came, |_| true))
    } else {
        let step = step(Pace::Real);
        let robot = Atrv::new(body(Body::Atrv, step), step, false).unwrap();
        let came = run(case, folder, robot, Atrv::pose);
        (came.output.status.to_string(), wrong(case, &came, Atrv::is_braked))
    }
}

#[test]
fn every_signal_at_every_moment_leaves_both_robots_standing() {
    let folder = folder("signalled");
    // The sonars of this one are through in no time.
    std::fs::write(folder.join("scout"), "gap = 4\nanswer = 400\n").unwrap();
    std::fs::write(folder.join("atrv"), "").unwrap();
    let moments = (0..MOMENTS).flat_map(|moment| SIGNALS.map(|signal| (moment, signal)));
    let cases: Vec<Case> =
        moments.flat_map(|(moment, signal)| ["scout", "atrv"].map(|robot| Case { robot, signal, moment })).collect();
    let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let mut tries = (0..TRIES).map(|_| tried(*case, &folder));
                    let first = tries.next().unwrap();
                    let right = |result: &(String, Option<String>)| result.1.is_none();
                    let result = if right(&first) { first } else { tries.find(right).unwrap_or(first) };
                    results.lock().unwrap().push((*case, result));
                }
            });
        }
    });
    let results = results.into_inner().unwrap();
    let wrong: Vec<_> = results.iter().filter(|(_, (_, wrong))| wrong.is_some()).collect();
    assert!(wrong.is_empty(), "{} of {}: {:#?}", wrong.len(), results.len(), &wrong[..wrong.len().min(10)]);
    // The moments lie before, in and behind the run.
    let mut statuses = BTreeMap::<&str, usize>::new();
    results.iter().for_each(|(_, (status, _))| *statuses.entry(status).or_default() += 1);
    let stopped = |(status, count): (&&str, &usize)| if *status == "exit status: 0" { 0 } else { *count };
    let ended: usize = statuses.iter().map(stopped).sum();
    assert!(ended > results.len() / 4 && ended < results.len(), "{statuses:?}");
}
