//! Tests the driver with the emulated robot on a real pseudo-terminal: signs, units, directions, and the messages about
//! faults on either side.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_emulator::{Pace, Port, serve};
use mdle_host::StopRequest;
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing, Steering};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, SonarId, Twist};
use mdle_scout::{Clock, Command, Configured, Fault, LineFault, Output, Scout};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_scout_emulator::wire::{Incoming, Request, answer};
use mdle_simulator::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_millis(100);
/// Room with walls 2 m ahead of the robot, 1.5 m to its left, 1 m to its right and 3 m behind it.
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[2, -1], [2, 1.5], [-3, 1.5], [-3, -1], [2, -1]]";

/// Timeout for an answer, in milliseconds: longer than any machine needs.
const LONG: u64 = 60_000;
/// Timeout for an answer that never arrives, in milliseconds.
const SHORT: u64 = 100;

/// Steering that differs from the default.
const STEERING: Steering = Steering { rotate: 1.0, align: 3.0, avoid: 1.5 };

/// Connects a driver to the robot at this line, with a timeout of `answer` milliseconds for each answer.
fn connected(port: &Port, answer: u64) -> Result<Scout, Fault> {
    let mut config = Configured::read(None, port.path().to_str()).unwrap().config;
    config.answer = answer;
    config.steering = STEERING;
    Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default())
}

/// Guard that ends the robot's thread when a test ends, even if the test fails.
struct Ends<'a>(&'a AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Runs `drive` with a robot in the room, in lockstep, and returns the result.
fn with_robot<T>(drive: impl FnOnce(&mut Scout) -> T) -> T {
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let mut robot = Emulated::new(Simulated::with(&make, &world, world.start, PERIOD).unwrap()).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        let serving =
            scope.spawn(|| serve(&mut robot, &port, Pace::Lockstep(PERIOD), &|| !over.load(Ordering::Relaxed)));
        let ends = Ends(&over);
        let result = connected(&port, LONG).map(|mut driver| drive(&mut driver));
        drop(ends);
        serving.join().unwrap().unwrap();
        result.unwrap()
    })
}

/// Starts a driver and returns the result of one exchange. `answers` simulates the robot: it is called with the number
/// of each request, the request, and the line.
fn exchanged(patience: u64, answers: impl Fn(usize, &Request, &Port) + Sync) -> Result<(), Fault> {
    asked(patience, answers, |driver| driver.exchange(&Twist::default()).map(|_| ()))
}

/// Starts a driver and returns the result of `drive`. `answers` simulates the robot, as in [`exchanged`].
fn asked(
    patience: u64,
    answers: impl Fn(usize, &Request, &Port) + Sync,
    drive: impl FnOnce(&mut Scout) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        scope.spawn(|| {
            let (mut incoming, mut count) = (Incoming::default(), 0);
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    answers(count, &request, &port);
                    count += 1;
                }
            }
        });
        let _ends = Ends(&over);
        drive(&mut connected(&port, patience)?)
    })
}

/// Returns the fault of a driver whose robot answers with the bytes from `answers`.
fn fault_of(answers: impl Fn(usize, &Request) -> Vec<u8> + Sync) -> Fault {
    exchanged(SHORT, |count, request, port| port.write(&answers(count, request)).unwrap()).unwrap_err()
}

/// Returns the frame of an answer of type `kind` with the state of a robot at rest at its start pose.
fn state(kind: u8) -> Vec<u8> {
    answer(kind, &[0; 42])
}

fn driven(driver: &mut Scout, v: f64, omega: f64, periods: usize) -> Output {
    let input = Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) };
    (0..periods).map(|_| driver.exchange(&input).unwrap()).last().unwrap()
}

/// Returns the range of a sonar's last ping, in metres.
fn heard(output: &Output, sonar: u8) -> f64 {
    output.pings(SonarId::new(sonar)).newest_first().next().unwrap().range.unwrap().0
}

fn assert_near(what: &str, found: f64, wanted: f64, by: f64) {
    assert!((found - wanted).abs() <= by, "{what}: {found} instead of {wanted}");
}

#[test]
fn commands_are_executed_and_reported() {
    with_robot(|driver| {
        let y = driven(driver, 0.2, 0.0, 30);
        assert_near("x", y.pose().x.0, 0.58, 0.03);
        assert_near("y", y.pose().y.0, 0.0, 0.003);
        assert_near("speed", y.velocity().v.0, 0.2, 0.005);
        assert_eq!(y.steering(), STEERING);
        driven(driver, 0.0, 0.0, 10);
        // A quarter turn to the left: the wall that was ahead is now on the right.
        let y = driven(driver, 0.0, 0.36, 44);
        assert_near("turn rate", y.velocity().omega.0, 0.36, 0.02);
        let y = driven(driver, 0.0, 0.0, 20);
        assert_near("heading", y.pose().theta.degrees(), 90.0, 4.0);
        let y = driven(driver, 0.2, 0.0, 20);
        assert_near("y", y.pose().y.0, 0.38, 0.04);
    });
}

#[test]
fn each_sonar_looks_where_it_should() {
    with_robot(|driver| {
        let y = driven(driver, 0.0, 0.0, 20);
        for (sonar, wall) in [(0, 2.0), (4, 1.5), (8, 3.0), (12, 1.0)] {
            assert_near(&format!("sonar {sonar}"), heard(&y, sonar), wall - 0.19, 0.04);
        }
    });
}

#[test]
fn contact_is_felt() {
    with_robot(|driver| {
        assert!(!driven(driver, 0.5, 0.0, 10).pressed());
        assert!(driven(driver, 0.5, 0.0, 60).pressed());
        assert!(!driven(driver, -0.5, 0.0, 10).pressed());
    });
}

#[test]
fn a_robot_is_let_go_once_it_stands() {
    with_robot(|driver| {
        assert_near("speed", driven(driver, 0.5, 0.0, 10).velocity().v.0, 0.5, 0.01);
        driver.stop().unwrap();
        let y = driven(driver, 0.0, 0.0, 1);
        assert_near("speed", y.velocity().v.0, 0.0, 1e-9);
    });
}

#[test]
fn a_robot_whose_wheels_jitter_stands() {
    let stopped = |speed: u8| {
        // Both wheels jitter, one forward and one backward.
        let mut state = [0; 42];
        (state[27], state[29], state[30]) = (speed, speed, 0x80);
        let answers = |_: usize, request: &Request, port: &Port| port.write(&answer(request.command, &state)).unwrap();
        asked(LONG, answers, Scout::stop)
    };
    assert_eq!([stopped(0), stopped(4), stopped(5)], [Ok(()), Ok(()), Err(Fault::Moves)]);
}

#[test]
fn silence_garbage_and_other_robots_differ() {
    assert_eq!(fault_of(|_, _| Vec::new()), Fault::Line(LineFault::Silent));
    assert!(matches!(fault_of(|_, _| b"Noise on the line.".to_vec()), Fault::Garbled(_)));
    assert_eq!(fault_of(|_, _| state(7)), Fault::Wrong { asked: 5, answered: 7 });
    assert_eq!(fault_of(|_, _| answer(8, &[])), Fault::Refused(5));
    assert_eq!(fault_of(|_, request| answer(request.command, &[0; 41])), Fault::Short(41));
    let bad_sum = |kind: u8| {
        let mut bytes = state(kind);
        bytes[46] ^= 1;
        bytes
    };
    assert!(matches!(fault_of(|_, request| bad_sum(request.command)), Fault::Garbled(_)));
    let mut stopped = [0; 42];
    stopped[35] = 0b0100_0000;
    assert_eq!(fault_of(|_, request| answer(request.command, &stopped)), Fault::EmergencyStop);
    // The robot falls silent in a turn, not during the start, which takes four commands, ten sonar checks and a zero
    // command.
    let late = |count: usize, request: &Request| if count < 15 { state(request.command) } else { Vec::new() };
    assert_eq!(fault_of(late), Fault::Line(LineFault::Silent));
}

#[test]
fn an_answer_may_come_in_pieces_and_behind_noise_and_another_one() {
    let answered = exchanged(LONG, |count, request, port| {
        let before = if count % 3 == 1 { vec![0xFF] } else { Vec::new() };
        let another = if count % 4 == 2 { state(request.command ^ 0x40) } else { Vec::new() };
        for piece in [before, another, state(request.command)].concat().chunks(5) {
            port.write(piece).unwrap();
            // As on a line with 38400 baud.
            thread::sleep(Duration::from_millis(1));
        }
    });
    assert_eq!(answered, Ok(()));
}

#[test]
fn a_line_that_is_cut_is_a_fault_at_once() {
    let port = Port::open().unwrap();
    let (path, answering) = (port.path().to_owned(), AtomicBool::new(true));
    thread::scope(|scope| {
        let robot = scope.spawn(|| {
            let port = port;
            let mut incoming = Incoming::default();
            while answering.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    port.write(&answer(request.command, &[0; 42])).unwrap();
                }
            }
        });
        let mut config = Configured::read(None, path.to_str()).unwrap().config;
        config.answer = LONG;
        let mut driver = Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default()).unwrap();
        answering.store(false, Ordering::Relaxed);
        robot.join().unwrap();
        assert_eq!(driver.exchange(&Twist::default()).map(|_| ()), Err(Fault::Line(LineFault::Closed)));
        assert_eq!(driver.stop(), Err(Fault::Line(LineFault::Closed)));
    });
}

#[test]
fn a_device_that_is_none_is_refused() {
    let refused = |device: &str| {
        let config = Configured::read(None, Some(device)).unwrap().config;
        Scout::connect(config, Clock::Wall, PERIOD, &StopRequest::default()).map(|_| ()).unwrap_err()
    };
    assert!(
        matches!(refused("/nowhere/at/all"), Fault::Line(LineFault::Open(device, _)) if device == "/nowhere/at/all")
    );
    assert_eq!(refused("/dev/null"), Fault::Line(LineFault::NotSerial("/dev/null".to_owned())));
    assert!(matches!(refused("tcp:example:1"), Fault::Line(LineFault::Open(..))));
    // No program listens on port 1, which is reserved.
    assert!(matches!(refused("tcp:127.0.0.1:1"), Fault::Line(LineFault::Open(..))));
    let port = Port::open().unwrap();
    let serial = port.path().to_str().unwrap();
    let held = std::fs::File::open(serial).unwrap();
    held.try_lock().unwrap();
    assert_eq!(refused(serial), Fault::Line(LineFault::Busy(serial.to_owned())));
}

#[test]
fn a_start_that_is_asked_to_end_stops_the_robot() {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let config = Configured::read(None, port.path().to_str()).unwrap().config;
    let report = thread::scope(|scope| {
        let robot = scope.spawn(|| {
            let (mut incoming, mut report) = (Incoming::default(), Vec::new());
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    report.push(request.command);
                    port.write(&answer(request.command, &[0; 42])).unwrap();
                }
            }
            report
        });
        let config = mdle_scout::Config { answer: LONG, ..config };
        let started = Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::at_once());
        assert_eq!(started.map(|_| ()), Err(Fault::Ended(None)));
        over.store(true, Ordering::Relaxed);
        robot.join().unwrap()
    });
    let [stop, limp] = [Command::Stop, Command::Limp].map(|command| Some(command.kind()));
    assert_eq!((report.first().copied(), report.last().copied()), (stop, limp), "{report:?}");
}
