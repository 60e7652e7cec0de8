//! A run of the executable on an emulated robot, over a pseudo-terminal or TCP.

use std::fs::{self, File};
use std::io::{Read, Write};
use std::iter;
use std::net::{Shutdown, TcpListener};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Emulated, Faulty, MotionOrder, OrderLog, Pace, Port, ScheduledFault, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec_aside};
use rustix::fs::OFlags;

use super::timed::Timed;

/// A plan that drives, stops for a while, and is over.
const PLAN: &str = "{ Drive (bumper OR wait 6s) (Atom (wait 4s) (go 20 0)) (Atom (null) stop) }\n";
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[4, -2], [4, 2], [-2, 2], [-2, -2], [4, -2]]";
/// Time of the robot's world at which faults begin. The robot drives at this time and for about two more seconds.
pub(crate) const BEGINS: Duration = Duration::from_millis(3500);
/// Time after which a test fails. A run takes less on any machine.
const SLOW: Duration = Duration::from_secs(30);
/// Delay of the emulator from which a run does not count, because a driver waits only 300 ms for an answer, and may
/// then rightly report that the robot does not answer.
const LATE: Duration = Duration::from_millis(100);
/// Maximum number of runs until one counts. The last one counts in any case.
const ATTEMPTS: usize = 5;

/// An emulated robot with the properties that a test reads.
pub(crate) trait Robot: Emulated + Send + Sized {
    const TARGET: &'static str;

    fn new() -> Self;
    fn orders(&self) -> &OrderLog;
    fn stands(&self) -> bool;
}

fn body(body: Body, step: Duration) -> Simulated {
    let world = World::parse("room", ROOM).unwrap();
    Simulated::with(&Make { body, without: Vec::new(), seed: None }, &world, world.start, step).unwrap()
}

impl Robot for Scout {
    const TARGET: &'static str = "scout";

    fn new() -> Self {
        Self::new(body(Body::Scout, Pace::Real.step())).unwrap()
    }

    fn orders(&self) -> &OrderLog {
        self.orders()
    }

    fn stands(&self) -> bool {
        self.stands()
    }
}

impl Robot for Atrv {
    const TARGET: &'static str = "atrv";

    fn new() -> Self {
        Self::new(body(Body::Atrv, step(Pace::Real)), step(Pace::Real), false).unwrap()
    }

    fn orders(&self) -> &OrderLog {
        self.orders()
    }

    fn stands(&self) -> bool {
        self.velocity().v.0 == 0.0
    }
}

/// Returns the executable of the plan for this robot, which is built once.
pub(crate) fn executable<R: Robot>() -> &'static Path {
    static BUILT: [OnceLock<PathBuf>; 2] = [OnceLock::new(), OnceLock::new()];
    BUILT[usize::from(R::TARGET == "atrv")].get_or_init(|| {
        let folder = folder(&format!("stands_on_{}", R::TARGET));
        fs::write(folder.join("drive.mdle"), PLAN).unwrap();
        let output = run_mdlec_aside(&folder, &["drive.mdle", "--target", R::TARGET]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        folder.join("drive")
    })
}

/// The result of a run.
pub(crate) struct Ran<R> {
    /// Report and messages of the program.
    output: String,
    status: Option<i32>,
    /// Time from the beginning of the fault to the end of the run.
    took: Duration,
    /// Maximum time by which the emulator was late.
    late: Duration,
    pub(crate) robot: R,
}

impl<R: Robot> Ran<R> {
    /// Returns the orders that the robot received, without consecutive repetitions.
    fn last_orders(&self) -> Vec<MotionOrder> {
        let mut orders: Vec<MotionOrder> = self.robot.orders().iter().map(|(_, order)| order).collect();
        orders.dedup();
        orders
    }

    /// Asserts that the run ended with this exit status, that its output contains these words, and that the robot
    /// received these orders last.
    pub(crate) fn assert(&self, status: i32, words: &[&str], orders: &[MotionOrder]) {
        println!("{} s after the fault: {}", self.took.as_secs_f64(), self.output);
        assert_eq!(self.status, Some(status), "{} The emulator was late by {:?}.", self.output, self.late);
        assert!(words.iter().all(|word| self.output.contains(word)), "{}", self.output);
        assert!(self.last_orders().ends_with(orders), "{:?}", self.last_orders());
        assert!(self.took < SLOW, "{:?}", self.took);
    }
}

/// Runs the executable on a robot with these faults, until the machine was not too busy for the emulator. `meanwhile`
/// is called with the running program and the time at which the robot was switched on.
pub(crate) fn ran<R: Robot>(
    faults: &[&str],
    arguments: &[&str],
    way: Way,
    meanwhile: impl Fn(&Child, Instant),
) -> Ran<R> {
    let mut runs = iter::repeat_with(|| ran_once(faults, arguments, way, &meanwhile));
    let counts = |ran: &Ran<R>| ran.late < LATE;
    runs.by_ref().take(ATTEMPTS - 1).find(counts).or_else(|| runs.next()).unwrap()
}

fn ran_once<R: Robot>(faults: &[&str], arguments: &[&str], way: Way, meanwhile: &impl Fn(&Child, Instant)) -> Ran<R> {
    let at = |fault: &&str| format!("{fault}@{}", BEGINS.as_secs_f64()).parse().unwrap();
    let faults: Vec<ScheduledFault> = faults.iter().map(at).collect();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let executable = executable::<R>();
    let device = match way {
        Way::Terminal => port.path().to_str().unwrap().to_owned(),
        Way::Tcp | Way::HalfClosed => bridged(port.path(), way),
    };
    let mut robot = Timed::new(Faulty::new(R::new(), &faults).unwrap());
    let (output, took) = thread::scope(|scope| {
        let begun = Instant::now();
        let serving = scope.spawn(|| serve(&mut robot, &port, Pace::Real, &|| !over.load(Ordering::Relaxed)));
        let mut command = Command::new(executable);
        let command = command.arg("--device").arg(device).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let child = command.spawn().unwrap();
        meanwhile(&child, begun);
        let output = child.wait_with_output().unwrap();
        let took = begun.elapsed().saturating_sub(BEGINS);
        // Gives the emulator time to receive the last bytes.
        thread::sleep(Duration::from_millis(200));
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        (output, took)
    });
    let Output { status, stdout, stderr } = output;
    let output = String::from_utf8(stdout).unwrap() + &String::from_utf8(stderr).unwrap();
    Ran { output, status: status.code(), took, late: robot.late, robot: robot.robot.into_robot() }
}

/// The connection of the program to the robot.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Way {
    /// A pseudo-terminal.
    Terminal,
    /// TCP.
    Tcp,
    /// TCP. When faults begin, the direction from the robot is closed; the robot still receives.
    HalfClosed,
}

/// Returns a TCP address that leads to this device, for a single connection.
fn bridged(device: &Path, way: Way) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let alone = OFlags::NOCTTY.bits() as i32;
    let device = File::options().read(true).write(true).custom_flags(alone).open(device).unwrap();
    thread::spawn(move || {
        let (stream, _) = listener.accept().unwrap();
        let (from, to) = (device.try_clone().unwrap(), stream.try_clone().unwrap());
        let limit = if way == Way::HalfClosed { BEGINS } else { Duration::MAX };
        thread::spawn(move || {
            pumped(from, &to, limit);
            // This fails if the program has ended, which is not an error.
            let _ = to.shutdown(Shutdown::Write);
        });
        pumped(stream, device, Duration::MAX);
    });
    format!("tcp:{address}")
}

/// Copies bytes until either end is closed, or until `limit` has passed.
fn pumped(mut from: impl Read, mut to: impl Write, limit: Duration) {
    let (begun, mut chunk) = (Instant::now(), [0; 256]);
    while let Ok(count @ 1..) = from.read(&mut chunk) {
        if begun.elapsed() >= limit || to.write_all(&chunk[..count]).is_err() {
            return;
        }
    }
}
