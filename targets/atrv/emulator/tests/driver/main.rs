//! Tests the driver with the emulated robot on a real pseudo-terminal: signs, units, directions, and the messages about
//! faults on either side.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod room;

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread;
use std::time::Duration;

use mdle_atrv::{Atrv, Clock, Configured, Escape, Fault, Garbled, LineFault, Output, Unreadable};
use mdle_atrv_emulator::atrv::Atrv as Emulated;
use mdle_emulator::Port;
use mdle_host::StopRequest;
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Robot as _, SonarId, Twist};
use room::{PERIOD, STEERING, driven_in, fault_of, with_robot};

fn driven(driver: &mut Atrv, v: f64, omega: f64, periods: usize) -> Output {
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
    let (robot, ()) = with_robot(|driver| {
        let y = driven(driver, 0.2, 0.0, 30);
        assert_near("x", y.pose().x.0, 0.58, 0.03);
        assert_near("y", y.pose().y.0, 0.0, 0.003);
        assert_near("speed", y.velocity().v.0, 0.2, 0.001);
        assert_eq!(y.steering(), STEERING);
        driven(driver, 0.0, 0.0, 10);
        // A quarter turn to the left: the wall that was ahead is now on the right.
        let y = driven(driver, 0.0, 0.36, 44);
        assert_near("turn rate", y.velocity().omega.0, 0.36, 0.002);
        let y = driven(driver, 0.0, 0.0, 20);
        assert_near("heading", y.pose().theta.degrees(), 90.0, 4.0);
        let y = driven(driver, 0.2, 0.0, 20);
        assert_near("y", y.pose().y.0, 0.38, 0.04);
        driven(driver, -0.2, 0.0, 20);
    });
    let pose = robot.pose();
    assert_near("x", pose.x.0, 0.6, 0.05);
    assert_near("y", pose.y.0, 0.06, 0.02);
    assert_near("heading", pose.theta.degrees(), 90.0, 4.0);
}

#[test]
fn each_sonar_looks_where_it_should() {
    with_robot(|driver| {
        let y = driven(driver, 0.0, 0.0, 4);
        for (sonar, wall) in [(0, 2.0), (4, 1.5), (8, 3.0), (12, 1.0)] {
            assert_near(&format!("sonar {sonar}"), heard(&y, sonar), wall - 0.28, 0.01);
        }
        // Pairs of sonars whose ranges `align` compares: they are equal if the robot stands along the walls.
        for (before, behind) in [(3, 5), (13, 11)] {
            assert_near(&format!("sonars {before} and {behind}"), heard(&y, before) - heard(&y, behind), 0.0, 0.01);
        }
    });
}

#[test]
fn contact_is_felt_before_and_behind() {
    with_robot(|driver| {
        assert!(!driven(driver, 0.5, 0.0, 10).pressed());
        assert_eq!(driven(driver, 0.5, 0.0, 60).switches, 0b01);
        assert!(!driven(driver, -0.5, 0.0, 15).pressed());
        assert_eq!(driven(driver, -0.5, 0.0, 120).switches, 0b10);
    });
}

#[test]
fn a_robot_is_braked_once_it_stands() {
    let (robot, ()) = with_robot(|driver| {
        assert_near("speed", driven(driver, 0.5, 0.0, 10).velocity().v.0, 0.5, 0.01);
        driver.stop().unwrap();
    });
    assert_eq!((robot.is_braked(), robot.velocity().v.0), (true, 0.0));
}

#[test]
fn numbers_with_a_1b_in_them_arrive_all_the_same() {
    // 27 and 6976 units contain the byte 1B: 00 00 00 1B and 00 00 1B 40.
    for (v, omega) in [(6976.5 / 139_654.7, 0.0), (0.0, 6976.5 / 49_784.5), (0.1, 27.5 / 49_784.5)] {
        for escape in [Escape::Avoid, Escape::Mark] {
            driven_in(escape, |driver| {
                let velocity = driven(driver, v, omega, 20).velocity();
                assert_near("speed", velocity.v.0, v, 0.002);
                assert_near("turn rate", velocity.omega.0, omega, 0.003);
            });
        }
    }
}

#[test]
fn a_robot_without_commands_stops_by_itself() {
    let (mut robot, ()) = with_robot(|driver| {
        // The driver is dropped while the robot moves, as if the program were killed.
        driven(driver, 0.5, 0.0, 10);
    });
    assert_near("speed", robot.velocity().v.0, 0.5, 0.01);
    let pass = |robot: &mut Emulated, millis| {
        mdle_emulator::Emulated::pass(robot, Duration::from_millis(millis)).unwrap();
        robot.velocity().v.0
    };
    assert_near("speed", pass(&mut robot, 800), 0.5, 0.01);
    assert_near("speed", pass(&mut robot, 800), 0.0, 1e-9);
}

#[test]
fn a_robot_with_other_sonars_is_refused() {
    let sixteen = room::refused(|config| config.sonars = 16);
    assert_eq!(sixteen, Fault::Deaf(5));
}

#[test]
fn an_emergency_stop_is_reported() {
    let pressed = AtomicBool::new(false);
    let (robot, result) = room::with_emergency(&pressed, |driver| {
        driven(driver, 0.5, 0.0, 15);
        pressed.store(true, Ordering::Relaxed);
        let go = Twist { v: MetersPerSecond(0.5), ..Twist::default() };
        let result = (0..20).find_map(|_| driver.exchange(&go).err());
        (result, driver.stop())
    });
    assert_eq!(result, (Some(Fault::Braked), Ok(())));
    assert_near("speed", robot.velocity().v.0, 0.0, 1e-9);
    // A stop that is pressed from the beginning is reported at the start.
    pressed.store(true, Ordering::Relaxed);
    assert_eq!(room::refused_in_emergency(&pressed), Fault::Braked);
}

#[test]
fn silence_garbage_and_other_robots_differ() {
    let report = |port, code, data: &[u8]| mdle_atrv_emulator::wire::report(port, 0, code, data, &[]);
    let bad_check = || {
        let mut bytes = report(2, 33, &[0; 25]);
        bytes[10] ^= 1;
        bytes
    };
    // Reports that contain only the positions of the axes, with the given time.
    let axes = |time: u8| {
        let axis = |axis: u8| report(2, 33, &[&[0, 0, 0, 0, 0, 0, 0, time][..], &[axis], &[0; 16]].concat());
        [axis(0), axis(1)].concat()
    };
    let time = AtomicU8::new(0);
    // Each driver waits for seconds, so they wait in parallel.
    thread::scope(|scope| {
        scope.spawn(|| assert_eq!(fault_of(|_| Vec::new()), Fault::Line(LineFault::Silent)));
        scope.spawn(|| {
            assert_eq!(fault_of(|_| b"Noise on the line.".to_vec()), Fault::Garbled(Garbled::Outside(b'N')));
        });
        scope.spawn(|| assert!(matches!(fault_of(|_| bad_check()), Fault::Garbled(Garbled::Check(..)))));
        scope.spawn(|| assert_eq!(fault_of(|_| report(9, 4, &[0; 25])), Fault::Unreadable(Unreadable::Unknown(9, 4))));
        scope.spawn(|| {
            assert_eq!(fault_of(|_| report(2, 33, &[0; 24])), Fault::Unreadable(Unreadable::Short(2, 33, 24)));
        });
        scope.spawn(|| assert_eq!(fault_of(|_| axes(time.fetch_add(1, Ordering::Relaxed))), Fault::Unheard));
        scope.spawn(|| assert_eq!(fault_of(|_| axes(0)), Fault::Repeated));
    });
}

#[test]
fn reports_may_come_in_pieces_and_behind_noise() {
    let result = room::dribbled(PERIOD);
    assert_eq!(result, Ok(()));
}

#[test]
fn a_line_that_is_cut_is_a_fault_at_once() {
    assert_eq!(room::cut(), [Err(Fault::Line(LineFault::Closed)), Err(Fault::Line(LineFault::Closed))]);
}

#[test]
fn who_comes_too_late_finds_the_robot_stopped() {
    let (velocity, result) = room::overslept(|driver, stands| {
        let go = Twist { v: MetersPerSecond(0.3), ..Twist::default() };
        driver.exchange(&go).unwrap();
        // The robot starts to move and then receives no further command.
        while !stands.load(Ordering::Relaxed) {
            thread::park_timeout(Duration::from_millis(10));
        }
        driver.exchange(&go).map(|_| ())
    });
    assert_eq!((velocity, result), (0.0, Err(Fault::Overslept(3000))));
}

#[test]
fn a_device_that_is_none_is_refused() {
    let refused = |device: &str| {
        let config = Configured::read(None, Some(device)).unwrap().config;
        Atrv::connect(config, Clock::Wall, PERIOD, &StopRequest::default()).map(|_| ()).unwrap_err()
    };
    assert!(
        matches!(refused("/nowhere/at/all"), Fault::Line(LineFault::Open(device, _)) if device == "/nowhere/at/all")
    );
    assert_eq!(refused("/dev/null"), Fault::Line(LineFault::NotSerial("/dev/null".to_owned())));
    assert!(matches!(refused("tcp:example:1"), Fault::Line(LineFault::Open(..))));
    let port = Port::open().unwrap();
    let serial = port.path().to_str().unwrap();
    let held = std::fs::File::open(serial).unwrap();
    held.try_lock().unwrap();
    assert_eq!(refused(serial), Fault::Line(LineFault::Busy(serial.to_owned())));
}
