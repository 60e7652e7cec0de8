//! Tests each fault on each robot: the output and the exit status of the executable, and the distance that the body
//! still moves. Compares the results with the book's page about faults, or writes this page.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "how long it took is seen with --nocapture")]

mod page;
mod watched;

use std::cell::RefCell;
use std::fs;
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_atrv_emulator::wire::report;
use mdle_emulator::{Ailment, Emulated, Fault, Faulty, MotionOrder, Pace, Port, ScheduledFault, serve};
use mdle_scout_emulator::scout::Scout;
use mdle_scout_emulator::wire::answer;
use mdle_sim::{Body, Make, Simulated, World};
use mdle_tests::executable::{folder, run_mdlec_aside};
use mdle_tests::repository::root;

use self::page::Row;
use self::watched::{BEGINS, Happening, Nature, Watched, Way};

const PERIOD: Duration = Duration::from_millis(100);
const IN_LOCKSTEP: Pace = Pace::Lockstep(PERIOD);
/// Plan of a robot that drives towards a wall and should stop half a metre before it.
const PLAN: &str = "{ Approach (bumper OR wait 20s) (Atom (r0 < 50cm) (go 20 0)) }\n";
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[3, -2], [3, 2], [-2, 2], [-2, -2], [3, -2]]";

/// Faults that `--fault` offers in lockstep, each with its description.
const ON_COMMAND: [(&str, &str); 23] = [
    ("noise", "bytes that mean nothing before each frame"),
    ("dribble", "frames come byte by byte"),
    ("check", "a bit of each frame is wrong"),
    ("lose", "two frames of three are lost"),
    ("double", "each frame comes twice"),
    ("silence", "the line from the robot is cut: it sends nothing, but receives"),
    ("deaf", "the line to the robot is cut: it receives nothing, but sends"),
    ("close", "the line is closed"),
    ("runaway", "the robot keeps its speed and ignores commands"),
    ("stuck-wheel", "the right side does not move"),
    ("dead-sonar", "the sonars in front hear nothing"),
    ("bumper", "a bumper is in contact"),
    ("emergency", "the emergency stop is pressed"),
    ("low-battery", "the battery is low"),
    ("plugged-in", "the charger is plugged in"),
    ("filler", "filler in each frame"),
    ("no-pings", "the sonars no longer ping"),
    ("no-bumpers", "the bumpers are no longer reported"),
    ("no-translation", "the way is no longer reported"),
    ("no-rotation", "the turn is no longer reported"),
    ("no-status", "questions about the brake are no longer answered"),
    ("leap", "each position is 3 m away from the one before"),
    ("hang", "the robot repeats the same data"),
];
/// Events that `--fault` does not offer, each with its description.
const BESIDES: [(Happening, &str); 4] = [
    (Happening::Garbage, "nothing but garbage for a minute"),
    (Happening::WrongAnswers, "answers to other commands"),
    (Happening::DeadForAWhile, "the line dies in mid-frame, and is back after two seconds"),
    (Happening::Killed, "the program is killed (SIGKILL)"),
];

/// Function that creates an emulated robot, with its properties.
type MakeRobot<R> = fn(Pace) -> (R, Nature<R>);
/// A case of the table. The function runs the executable with an event, and returns the row.
type Case<'r> = Box<dyn FnOnce() -> Row + Send + 'r>;

/// The executable of the plan for a target.
struct Robot(PathBuf);

impl Robot {
    /// Returns the Scout and the ATRV-mini, which are built once for all tests.
    fn both() -> &'static [Self; 2] {
        static BUILT: OnceLock<[Robot; 2]> = OnceLock::new();
        BUILT.get_or_init(|| ["scout", "atrv"].map(Self::new))
    }

    fn new(target: &str) -> Self {
        let folder = folder(&format!("faults_on_{target}"));
        fs::write(folder.join("approach.mdle"), PLAN).unwrap();
        let output = run_mdlec_aside(&folder, &["approach.mdle", "--target", target]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Self(folder.join("approach"))
    }

    /// Starts the executable with this device.
    fn started(&self, device: &Path, pace: Pace) -> RefCell<Child> {
        let mut command = Command::new(&self.0);
        let command = command.arg("--device").arg(device).args((pace == IN_LOCKSTEP).then_some("--lockstep"));
        RefCell::new(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    /// Returns the row for a device that is not a serial port, or to which no robot is connected.
    fn without(&self, device: &Path) -> Row {
        let still = Way { metres: 0.0, time: Duration::ZERO };
        Row::of(self.started(device, IN_LOCKSTEP).into_inner().wait_with_output().unwrap(), still, None)
    }

    /// Returns the row for an event on a connected robot, and the time from the beginning of the event to the end of
    /// the executable.
    fn with<R: Emulated>(
        &self,
        made: MakeRobot<R>,
        pace: Pace,
        fault: Option<Fault>,
        happening: Happening,
    ) -> (Row, Duration) {
        let port = Port::open().unwrap();
        let child = self.started(port.path(), pace);
        let faults = fault.map(|fault| ScheduledFault { fault, time: BEGINS });
        let (robot, nature) = made(pace);
        let mut watched = Watched::new(Faulty::new(robot, faults.as_slice()).unwrap(), happening, nature, &child);
        let served = serve(&mut watched, &port, pace, &|| child.borrow_mut().try_wait().unwrap().is_none());
        assert_eq!(served.is_err(), fault == Some(Fault::Close), "{served:?}");
        drop(port);
        child.borrow_mut().wait().unwrap();
        let took = watched.begun.map_or(Duration::ZERO, |begun| begun.elapsed());
        let order = watched.order();
        let way = watched.left_alone();
        (Row::of(child.into_inner().wait_with_output().unwrap(), way, order), took)
    }
}

fn body(body: Body, step: Duration) -> Simulated {
    let world = World::parse("room", ROOM).unwrap();
    Simulated::with(&Make { body, without: Vec::new(), seed: None }, &world, world.start, step).unwrap()
}

fn scout(pace: Pace) -> (Scout, Nature<Scout>) {
    // The driver waits up to 300 ms after its command; this answer has a type that was not requested.
    let wrong = |frame: &[u8]| answer(20, &frame[4..frame.len() - 2]);
    let waits = if pace == IN_LOCKSTEP { 3 } else { 0 };
    let nature = Nature { pose: Scout::pose, orders: Scout::orders, wrong, waits, step: pace.step() };
    (Scout::new(body(Body::Scout, pace.step())).unwrap(), nature)
}

fn atrv(pace: Pace) -> (Atrv, Nature<Atrv>) {
    // The driver waits up to 300 ms after the last report; this report is about a part that the robot does not have.
    let wrong = |_: &[u8]| report(9, 0, 4, &[0; 25], &[]);
    let waits = if pace == IN_LOCKSTEP { 2 } else { 0 };
    let nature = Nature { pose: Atrv::pose, orders: Atrv::orders, wrong, waits, step: pace.step() };
    (Atrv::new(body(Body::Atrv, step(pace)), step(pace), false).unwrap(), nature)
}

/// Returns all cases with their descriptions, in the order of the table. `on_another` is the case in which the device
/// belongs to another robot.
fn cases<R: Emulated + 'static>(
    robot: &Robot,
    made: MakeRobot<R>,
    on_another: fn(&Robot) -> Row,
) -> Vec<(String, Case<'_>)> {
    let mut cases: Vec<(String, Case<'_>)> = vec![
        ("no such device".to_owned(), Box::new(|| robot.without(Path::new("/dev/ttyNone")))),
        ("no serial port".to_owned(), Box::new(|| robot.without(Path::new("/dev/null")))),
        ("another program has the device".to_owned(), Box::new(|| busy(robot))),
        ("nobody answers".to_owned(), Box::new(|| robot.without(Port::open().unwrap().path()))),
        ("another robot is there".to_owned(), Box::new(move || on_another(robot))),
    ];
    for (kind, what) in ON_COMMAND {
        let ScheduledFault { fault, .. } = kind.parse().unwrap();
        if !matches!(fault, Fault::Body(ailment) if !R::can_suffer(ailment)) {
            let of = move || robot.with(made, IN_LOCKSTEP, Some(fault), Happening::OnCommand).0;
            cases.push((format!("{what} (`{kind}`)"), Box::new(of)));
        }
    }
    for (happening, what) in BESIDES {
        cases.push((what.to_owned(), Box::new(move || robot.with(made, IN_LOCKSTEP, None, happening).0)));
    }
    cases
}

/// Returns the rows of these cases. They run at the same time, because a driver without an answer waits for long.
fn rows(cases: Vec<(String, Case<'_>)>) -> Vec<(String, Row)> {
    thread::scope(|scope| {
        let rows: Vec<_> = cases.into_iter().map(|(what, of)| (what, scope.spawn(of))).collect();
        rows.into_iter().map(|(what, row)| (what, row.join().unwrap())).collect()
    })
}

fn busy(robot: &Robot) -> Row {
    let port = Port::open().unwrap();
    let held = fs::File::open(port.path()).unwrap();
    held.try_lock().unwrap();
    robot.without(port.path())
}

pub(crate) fn each_fault_stops_the_robot_or_is_borne() {
    let [on_scout, on_atrv] = Robot::both();
    let mut of_scout = cases(on_scout, scout, |scout| scout.with(atrv, IN_LOCKSTEP, None, Happening::Nothing).0);
    let count = of_scout.len();
    of_scout.extend(cases(on_atrv, atrv, |atrv| atrv.with(scout, IN_LOCKSTEP, None, Happening::Nothing).0));
    let mut of_scout = rows(of_scout);
    let of_atrv = of_scout.split_off(count);
    for (what, row) in of_scout.iter().chain(&of_atrv) {
        let is_one_sentence = !row.message.is_empty() && !row.message.contains('\n');
        let is_over = row.status == Some(0) && row.message.starts_with("plan over: ");
        assert!(is_over || row.status == Some(3) && is_one_sentence || row.status.is_none(), "{what}: {row:?}");
        // If the robot could receive a command, the last command was one to stop.
        let is_cut = ["deaf", "close", "killed", "dies in mid-frame"].iter().any(|word| what.contains(word));
        assert!(is_cut || row.order != Some(MotionOrder::Drive), "{what}: {row:?}");
    }
    let text = page::text(PLAN, &[("The Super Scout", of_scout), ("The ATRV-mini", of_atrv)]);
    let path = root().join("docs/src/faults.md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        fs::write(&path, &text).unwrap();
    }
    let committed = fs::read_to_string(path).unwrap_or_default();
    assert!(committed == text, "INSTA_UPDATE=always writes docs/src/faults.md\n{text}");
}

/// Maximum additional distance, in metres, that a body moves by the clock, compared with lockstep. By the clock, a
/// fault and the command before it may each come a turn later after the last answer.
const FURTHER: f64 = 0.05;
/// Maximum time from a fault to the end of the program, in seconds.
const SOON: f64 = 1.5;

/// A fault and an event that end a run, the maximum time until the end in seconds, and the maximum additional distance
/// in metres that the body moves by the clock, compared with lockstep.
type End = (Option<Fault>, Happening, f64, f64);

/// Faults and events that end a run on both robots, each in a different way.
const ENDS: [End; 6] = [
    (Some(Fault::Silence), Happening::OnCommand, SOON, FURTHER),
    (Some(Fault::Check), Happening::OnCommand, SOON, FURTHER),
    (Some(Fault::Close), Happening::OnCommand, SOON, FURTHER),
    (None, Happening::Garbage, SOON, FURTHER),
    (None, Happening::WrongAnswers, SOON, FURTHER),
    (None, Happening::DeadForAWhile, SOON, FURTHER),
];
/// Faults that an ATRV's driver notices later: missing bumper reports after a second, and unanswered questions after
/// two seconds, because the last question may have been answered just before the fault.
const LATER: [End; 3] = [
    (Some(Fault::Body(Ailment::NoBumpers)), Happening::OnCommand, 2.0, 0.1),
    (Some(Fault::Body(Ailment::NoStatus)), Happening::OnCommand, 3.0, 0.25),
    (Some(Fault::Body(Ailment::Deaf)), Happening::OnCommand, 3.0, FURTHER),
];

/// Asserts that the executable ends in time. By the clock, the minimum of a few attempts counts, because a busy machine
/// can only increase the time.
fn assert_ends<R: Emulated>(robot: &Robot, made: MakeRobot<R>, (fault, happening, soon, further): End) {
    let by_the_clock = || robot.with(made, Pace::Real, fault, happening);
    let (in_lockstep, first) = thread::scope(|scope| {
        let first = scope.spawn(by_the_clock);
        let (in_lockstep, _) = robot.with(made, IN_LOCKSTEP, fault, happening);
        (in_lockstep, first.join().unwrap())
    });
    let mut least = (f64::INFINITY, f64::INFINITY);
    let again = iter::repeat_with(by_the_clock).take(4);
    for (row, took) in iter::once(first).chain(again) {
        assert_eq!(row.status, Some(3), "{row:?}");
        least = (least.0.min(took.as_secs_f64()), least.1.min(row.way.metres - in_lockstep.way.metres));
        if least.0 <= soon && least.1 <= further {
            println!("after {:.2} s, {:.3} m further than in lockstep: {}", least.0, least.1, row.message);
            return;
        }
    }
    panic!("after {} s, {} m further than in lockstep: {}", least.0, least.1, in_lockstep.message);
}

pub(crate) fn by_the_clock_a_fault_ends_the_program_in_time() {
    let [on_scout, on_atrv] = Robot::both();
    thread::scope(|scope| {
        for end in ENDS {
            scope.spawn(move || assert_ends(on_scout, scout, end));
        }
        for end in ENDS.into_iter().chain(LATER) {
            scope.spawn(move || assert_ends(on_atrv, atrv, end));
        }
    });
}
