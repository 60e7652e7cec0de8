//! Runs drivers on a pseudo-terminal, either with the emulated robot in a room or with a test's own answers.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv::{Atrv, Clock, Config, Configured, Escape, Fault};
use mdle_atrv_emulator::atrv::{Atrv as Emulated, step};
use mdle_atrv_emulator::wire::{Incoming, Request};
use mdle_emulator::{Ailment, Pace, Port, serve};
use mdle_host::StopRequest;
use mdle_runtime::capability::Steering;
use mdle_runtime::{Robot as _, Twist};
use mdle_simulator::{Body, Make, Simulated, World};

pub(crate) const PERIOD: Duration = Duration::from_millis(100);
/// Room with walls 2 m ahead of the robot, 1.5 m to its left, 1 m to its right and 3 m behind it.
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[2, -1], [2, 1.5], [-3, 1.5], [-3, -1], [2, -1]]";

/// Timeout for a report, in milliseconds: longer than any machine needs.
const LONG: u64 = 60_000;
/// Timeout for a report that never arrives, in milliseconds.
const SHORT: u64 = 500;

/// Guard that ends the robot's thread when a test ends, even if the test fails.
struct Ends<'a>(&'a AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Steering that differs from the default.
pub(crate) const STEERING: Steering = Steering { rotate: 1.0, align: 3.0, avoid: 1.5 };

/// Returns the configuration of a driver on this line with a timeout of `answer` milliseconds for each report.
fn config(port: &Port, answer: u64) -> Config {
    Config { answer, steering: STEERING, ..Configured::read(None, port.path().to_str()).unwrap().config }
}

/// The robot in a test: the test can press its emergency stop, and is informed when the robot has come to rest.
struct Watched<'a> {
    robot: Emulated,
    emergency: &'a AtomicBool,
    has_moved: bool,
    stands: &'a AtomicBool,
}

impl mdle_emulator::Emulated for Watched<'_> {
    fn push(&mut self, bytes: &[u8]) {
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.emergency = self.emergency.load(Ordering::Relaxed);
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        self.robot.pass(time)?;
        let moves = self.robot.velocity() != Twist::default();
        self.has_moved |= moves;
        self.stands.store(self.has_moved && !moves, Ordering::Relaxed);
        Ok(())
    }

    fn take_frames(&mut self) -> Vec<Vec<u8>> {
        self.robot.take_frames()
    }

    fn can_suffer(_: Ailment) -> bool {
        false
    }

    fn suffer(&mut self, _: Ailment) {}
}

/// Runs `drive` with a driver of a robot in the room, and returns the robot and the result.
fn in_the_room<T>(
    pace: Pace,
    [emergency, stands]: [&AtomicBool; 2],
    change: impl FnOnce(&mut Config),
    drive: impl FnOnce(Result<Atrv, Fault>) -> T,
) -> (Emulated, T) {
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Atrv, without: Vec::new(), seed: None };
    let body = Simulated::with(&make, &world, world.start, step(pace)).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let mut config = config(&port, LONG);
    change(&mut config);
    let mut robot = Emulated::new(body, step(pace), config.escape == Escape::Mark).unwrap();
    if pace == Pace::Real {
        // Only the driver is to stop the robot.
        robot.failsafe = Duration::MAX;
    }
    let mut watched = Watched { robot, emergency, has_moved: false, stands };
    let result = thread::scope(|scope| {
        let serving = scope.spawn(|| serve(&mut watched, &port, pace, &|| !over.load(Ordering::Relaxed)));
        let ends = Ends(&over);
        // In real time, the start is checked so often that no machine is too slow for it.
        let (clock, period) = match pace {
            Pace::Real => (Clock::Wall, Duration::from_millis(2)),
            Pace::Lockstep(period) => (Clock::Stepped(period), period),
        };
        let result = drive(Atrv::connect(config, clock, period, &StopRequest::default()));
        drop(ends);
        serving.join().unwrap().unwrap();
        result
    });
    (watched.robot, result)
}

/// Runs `drive` with a robot in lockstep, and returns the robot and the result.
pub(crate) fn with_robot<T>(drive: impl FnOnce(&mut Atrv) -> T) -> (Emulated, T) {
    with_emergency(&AtomicBool::new(false), drive)
}

/// Runs `drive` with a robot in lockstep whose emergency stop is pressed while `pressed` is set.
pub(crate) fn with_emergency<T>(pressed: &AtomicBool, drive: impl FnOnce(&mut Atrv) -> T) -> (Emulated, T) {
    let off = AtomicBool::new(false);
    let lights = [pressed, &off];
    in_the_room(Pace::Lockstep(PERIOD), lights, |_| {}, |driver| drive(&mut driver.unwrap()))
}

/// Runs `drive` with a robot in lockstep; `escape` is the treatment of bytes with the value 1B on both sides.
pub(crate) fn driven_in(escape: Escape, drive: impl FnOnce(&mut Atrv)) {
    let off = AtomicBool::new(false);
    let lights = [&off; 2];
    in_the_room(Pace::Lockstep(PERIOD), lights, |config| config.escape = escape, |driver| drive(&mut driver.unwrap()));
}

/// Returns the fault with which a driver fails to start after `change` has changed its configuration.
pub(crate) fn refused(change: impl FnOnce(&mut Config)) -> Fault {
    let off = AtomicBool::new(false);
    let lights = [&off; 2];
    in_the_room(Pace::Lockstep(PERIOD), lights, change, |driver| driver.map(|_| ()).unwrap_err()).1
}

/// Returns the fault with which a driver fails to start while the emergency stop is pressed.
pub(crate) fn refused_in_emergency(pressed: &AtomicBool) -> Fault {
    let off = AtomicBool::new(false);
    let lights = [pressed, &off];
    in_the_room(Pace::Lockstep(PERIOD), lights, |_| {}, |driver| driver.map(|_| ()).unwrap_err()).1
}

/// Runs `drive` with a robot in real time, and with a flag that is set when the robot has come to rest. Returns the
/// robot's speed at the end, in m/s, and the result of `drive`.
pub(crate) fn overslept<T>(drive: impl FnOnce(&mut Atrv, &AtomicBool) -> T) -> (f64, T) {
    let (emergency, stands) = (AtomicBool::new(false), AtomicBool::new(false));
    let (robot, result) = in_the_room(
        Pace::Real,
        [&emergency, &stands],
        // Longer than any machine suspends a test.
        |config| config.watchdog = 3000,
        |driver| drive(&mut driver.unwrap(), &stands),
    );
    (robot.velocity().v.0, result)
}

/// Returns the fault with which a driver fails to start if the robot answers each command with the bytes from
/// `answers`.
pub(crate) fn fault_of(answers: impl Fn(&Request) -> Vec<u8> + Sync) -> Fault {
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        scope.spawn(|| {
            let mut incoming = Incoming::new(false);
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| incoming.push(bytes)).unwrap();
                while let Some(request) = incoming.next_request() {
                    port.write(&answers(&request)).unwrap();
                }
            }
        });
        let _ends = Ends(&over);
        Atrv::connect(config(&port, SHORT), Clock::Stepped(PERIOD), PERIOD, &StopRequest::default())
            .map(|_| ())
            .unwrap_err()
    })
}

/// Returns the result of 20 turns with a robot whose reports arrive in fragments, after noise.
pub(crate) fn dribbled(period: Duration) -> Result<(), Fault> {
    let world = World::parse("room", ROOM).unwrap();
    let body = Make { body: Body::Atrv, without: Vec::new(), seed: None };
    let pace = Pace::Lockstep(period);
    let body = Simulated::with(&body, &world, world.start, step(pace)).unwrap();
    let mut robot = Emulated::new(body, step(pace), false).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    thread::scope(|scope| {
        scope.spawn(|| {
            use mdle_emulator::Emulated as _;
            while !over.load(Ordering::Relaxed) {
                port.read(Duration::from_millis(10), &mut |bytes| robot.push(bytes)).unwrap();
                while let Some(turns) = robot.obey() {
                    if turns {
                        robot.pass(period).unwrap();
                    }
                    let frames = robot.take_frames().concat();
                    let noise: &[u8] = if frames.is_empty() { &[] } else { &[0xFF, 0x1B] };
                    for piece in [noise, &frames].concat().chunks(5) {
                        port.write(piece).unwrap();
                        thread::yield_now();
                    }
                }
            }
        });
        let _ends = Ends(&over);
        let mut driver = Atrv::connect(config(&port, LONG), Clock::Stepped(period), period, &StopRequest::default())?;
        (0..20).try_for_each(|_| driver.exchange(&Twist::default()).map(|_| ()))
    })
}

/// Returns the results of an exchange and of a stop after the line was cut.
pub(crate) fn cut() -> [Result<(), Fault>; 2] {
    let port = Port::open().unwrap();
    let (path, over) = (port.path().to_owned(), AtomicBool::new(false));
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Atrv, without: Vec::new(), seed: None };
    let pace = Pace::Lockstep(PERIOD);
    let body = Simulated::with(&make, &world, world.start, step(pace)).unwrap();
    let mut robot = Emulated::new(body, step(pace), false).unwrap();
    thread::scope(|scope| {
        let serving = scope.spawn(|| {
            let port = port;
            serve(&mut robot, &port, pace, &|| !over.load(Ordering::Relaxed))
        });
        let _ends = Ends(&over);
        let config = Config { answer: LONG, ..Configured::read(None, path.to_str()).unwrap().config };
        let mut driver = Atrv::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default()).unwrap();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap().unwrap();
        [driver.exchange(&Twist::default()).map(|_| ()), driver.stop()]
    })
}
