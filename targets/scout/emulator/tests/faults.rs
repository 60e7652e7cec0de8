//! What the driver makes of each thing that can go wrong on command.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use mdle_emulator::{Faulty, Pace, Port, serve};
use mdle_host::StopRequest;
use mdle_runtime::capability::{Bumpers, Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, Robot as _, SonarId, Twist};
use mdle_scout::{Clock, Config, Configured, Fault, Garbled, LineFault, Output, Scout};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_sim::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_millis(100);
const PACE: Pace = Pace::Lockstep(PERIOD);
/// A wall 4 m before the robot, and others far away.
const ROOM: &str =
    "start = { x = 0.0, y = 0.0, heading = 0.0 }\n[[wall]]\npoints = [[4, -3], [4, 3], [-3, 3], [-3, -3], [4, -3]]";

/// What comes of this fault, three seconds after the robot was switched on, while it drives ahead for five: its last output.
fn driven(fault: &str) -> Result<Output, Fault> {
    let world = World::parse("room", ROOM).unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let body = Simulated::with(&make, &world, world.start, PERIOD).unwrap();
    let faults = [format!("{fault}@3").parse().unwrap()];
    let mut robot = Faulty::new(Emulated::new(body).unwrap(), &faults).unwrap();
    let (port, over) = (Port::open().unwrap(), AtomicBool::new(false));
    let (device, is_closed) = (port.path().to_str().unwrap().to_owned(), fault == "close");
    thread::scope(|scope| {
        let serving = scope.spawn(|| {
            let port = port;
            let served = serve(&mut robot, &port, PACE, &|| !over.load(Ordering::Relaxed));
            assert_eq!(served.is_err(), is_closed, "{served:?}");
        });
        // What is not going to come is waited for longer than any machine takes for what comes.
        let config = Config { answer: 3000, ..Configured::read(None, Some(&device)).unwrap().config };
        let mut driver = Scout::connect(config, Clock::Stepped(PERIOD), PERIOD, &StopRequest::default()).unwrap();
        let go = Twist { v: MetersPerSecond(0.2), ..Twist::default() };
        let said = (0..50).try_fold(None, |_, _| driver.exchange(&go).map(Some)).map(Option::unwrap);
        // As the host does, whatever has come.
        let _ = driver.stop();
        over.store(true, Ordering::Relaxed);
        serving.join().unwrap();
        said
    })
}

fn fails(fault: &str) -> Fault {
    driven(fault).expect_err(fault)
}

#[test]
fn what_can_be_borne_is() {
    for fault in ["dribble", "double", "noise", "noise=1", "noise=400"] {
        let y = driven(fault).expect(fault);
        let way = y.pose().x.0;
        assert!((way - 1.0).abs() < 0.03, "{fault}: {way} m");
    }
}

#[test]
fn what_cannot_be_borne_is_told() {
    assert!(matches!(fails("check"), Fault::Garbled(Garbled::Sum(..))));
    assert_eq!(fails("lose"), Fault::Line(LineFault::Silent));
    assert_eq!(fails("silence"), Fault::Line(LineFault::Silent));
    assert_eq!(fails("close"), Fault::Line(LineFault::Closed));
}

#[test]
fn what_its_body_suffers_is_felt() {
    let heading = |y: Output| y.pose().theta.degrees();
    let ahead = |y: &Output| y.pings(SonarId::new(0)).newest_first().next().unwrap().range;
    let well = driven("low-battery").unwrap();
    assert!(!well.pressed() && ahead(&well).is_some() && heading(well).abs() < 1.0);
    assert!(driven("bumper").unwrap().pressed());
    assert_eq!(ahead(&driven("dead-sonar").unwrap()), None);
    // The right side stands, so that it turns to the right.
    let turned = heading(driven("stuck-wheel").unwrap());
    assert!((-170.0..-20.0).contains(&turned), "{turned}");
    // Whoever drives on would do so without knowing.
    assert_eq!(fails("emergency"), Fault::EmergencyStop);
}
