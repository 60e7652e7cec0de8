//! The driver and the robot on a real pseudo-terminal: signs, units and directions, and what either of them says of a fault.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, SonarId, Twist};
use mdle_scout::{Clock, Configured, Fault, Output, Scout};
use mdle_scout_emulator::port::Port;
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_scout_emulator::serve::{Pace, serve};
use mdle_scout_emulator::wire::{Incoming, Request, answer};
use mdle_sim::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_millis(100);
/// Walls 2 m before the robot, 1.5 m to its left, 1 m to its right and 3 m behind it.
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[2, -1], [2, 1.5], [-3, 1.5], [-3, -1], [2, -1]]";

/// A driver of what answers at this line.
fn connected(port: &Port) -> Result<Scout, Fault> {
    let mut config = Configured::read(None, port.path().to_str()).unwrap().config;
    config.answer = 100;
    Scout::connect(config, Clock::Stepped(PERIOD), PERIOD)
}

/// Ends the robot's thread when a test ends, also when it fails.
struct Ends<'a>(&'a AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// What `drive` makes of a robot in the room, in lockstep.
fn with_robot<T>(drive: impl FnOnce(&mut Scout) -> T) -> T {
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let mut robot = Emulated::new(Simulated::with(&make, &world, world.start, PERIOD).unwrap()).unwrap();
    let (port, over) = (Port::open(None).unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        let serving =
            scope.spawn(|| serve(&mut robot, &port, Pace::Lockstep(PERIOD), &|| !over.load(Ordering::Relaxed)));
        let ends = Ends(&over);
        let result = connected(&port).map(|mut driver| drive(&mut driver));
        drop(ends);
        serving.join().unwrap().unwrap();
        result.unwrap()
    })
}

/// What a driver says of a robot that answers like this.
fn said_of(answers: impl Fn(usize, &Request) -> Vec<u8> + Sync) -> Fault {
    let (port, over) = (Port::open(None).unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        scope.spawn(|| {
            let (mut incoming, mut count) = (Incoming::default(), 0);
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    port.write(&answers(count, &request)).unwrap();
                    count += 1;
                }
            }
        });
        let (start, _ends) = (Instant::now(), Ends(&over));
        let fault = connected(&port).map(|mut driver| driver.exchange(&Twist::default()).map(|_| ()));
        // An operator who waits is a person.
        assert!(start.elapsed() < Duration::from_secs(10));
        match fault {
            Ok(Ok(())) => panic!("nothing was wrong"),
            Ok(Err(fault)) | Err(fault) => fault,
        }
    })
}

fn driven(driver: &mut Scout, v: f64, omega: f64, periods: usize) -> Output {
    let input = Twist { v: MetersPerSecond(v), omega: RadiansPerSecond(omega) };
    (0..periods).map(|_| driver.exchange(&input).unwrap()).last().unwrap()
}

/// What a sonar heard last, in metres.
fn heard(output: &Output, sonar: u8) -> f64 {
    output.pings(SonarId::new(sonar)).newest_first().next().unwrap().range.unwrap().0
}

fn assert_near(what: &str, found: f64, wanted: f64, by: f64) {
    assert!((found - wanted).abs() <= by, "{what}: {found} instead of {wanted}");
}

#[test]
fn what_is_told_is_done_and_told_back() {
    with_robot(|driver| {
        let y = driven(driver, 0.2, 0.0, 30);
        assert_near("x", y.pose().x.0, 0.58, 0.03);
        assert_near("y", y.pose().y.0, 0.0, 0.003);
        assert_near("speed", y.velocity().v.0, 0.2, 0.005);
        driven(driver, 0.0, 0.0, 10);
        // A quarter of a circle to the left: what was before it is to its right.
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
fn a_robot_that_is_let_go_stands() {
    with_robot(|driver| {
        driven(driver, 0.5, 0.0, 10);
        driver.stop().unwrap();
        let y = driven(driver, 0.0, 0.0, 10);
        assert_near("speed", y.velocity().v.0, 0.0, 1e-9);
    });
}

#[test]
fn silence_garbage_and_other_robots_are_told_apart() {
    let state = |kind: u8| answer(kind, &[0; 42]);
    assert_eq!(said_of(|_, _| Vec::new()), Fault::Silent);
    assert!(matches!(said_of(|_, _| b"Noise on the line.".to_vec()), Fault::Garbled(_)));
    assert_eq!(said_of(|_, _| state(7)), Fault::Wrong { asked: 5, answered: 7 });
    assert_eq!(said_of(|_, request| answer(request.command, &[0; 41])), Fault::Short(41));
    let bad_sum = |kind: u8| {
        let mut bytes = state(kind);
        bytes[46] ^= 1;
        bytes
    };
    assert!(matches!(said_of(|_, request| bad_sum(request.command)), Fault::Garbled(_)));
    let mut stopped = [0; 42];
    stopped[35] = 0b0100_0000;
    assert_eq!(said_of(|_, request| answer(request.command, &stopped)), Fault::EmergencyStop);
    // Later, in a turn, as well as at the start.
    let late = |count: usize, request: &Request| if count < 15 { state(request.command) } else { Vec::new() };
    assert_eq!(said_of(late), Fault::Silent);
}

#[test]
fn a_single_garbled_answer_is_asked_for_again() {
    let state = |kind: u8| answer(kind, &[0; 42]);
    // Every third answer is noise; the robot is found nevertheless, and lost when it falls silent.
    let noisy = |count: usize, request: &Request| match count {
        count if count > 40 => Vec::new(),
        count if count % 3 == 2 => b"???".to_vec(),
        _ => state(request.command),
    };
    let port = Port::open(None).unwrap();
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            let (mut incoming, mut count) = (Incoming::default(), 0);
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    port.write(&noisy(count, &request)).unwrap();
                    count += 1;
                }
            }
        });
        let _ends = Ends(&over);
        let made = connected(&port).map(|mut driver| driver.exchange(&Twist::default()).map(|_| ()));
        assert_eq!(made.unwrap(), Ok(()));
    });
}

#[test]
fn a_line_that_is_cut_is_a_fault_at_once() {
    let port = Port::open(None).unwrap();
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
        config.answer = 100;
        let mut driver = Scout::connect(config, Clock::Stepped(PERIOD), PERIOD).unwrap();
        answering.store(false, Ordering::Relaxed);
        robot.join().unwrap();
        assert_eq!(driver.exchange(&Twist::default()).map(|_| ()), Err(Fault::Closed));
        assert_eq!(driver.stop(), Err(Fault::Closed));
    });
}

#[test]
fn a_device_that_is_none_is_refused() {
    let refused = |device: &str| {
        let config = Configured::read(None, Some(device)).unwrap().config;
        Scout::connect(config, Clock::Wall, PERIOD).map(|_| ()).unwrap_err()
    };
    assert!(matches!(refused("/nowhere/at/all"), Fault::Open(device, _) if device == "/nowhere/at/all"));
    assert_eq!(refused("/dev/null"), Fault::NotSerial("/dev/null".to_owned()));
    assert!(matches!(refused("tcp:example:1"), Fault::Open(..)));
    // Nobody listens on the port that is reserved for nobody.
    assert!(matches!(refused("tcp:127.0.0.1:1"), Fault::Open(..)));
    let port = Port::open(None).unwrap();
    let serial = port.path().to_str().unwrap();
    let held = std::fs::File::open(serial).unwrap();
    held.try_lock().unwrap();
    assert_eq!(refused(serial), Fault::Busy(serial.to_owned()));
}
