//! Tests in real time: a robot that answers late, and a driver that pauses for too long.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::thread;
use std::time::Duration;

use mdle_emulator::{Driven, Faulty, MotionOrder, Pace, driven};
use mdle_host::StopRequest;
use mdle_runtime::{MetersPerSecond, Robot as _, Twist};
use mdle_scout::{Clock, Config, Configured, Fault, Scout};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_simulator::{Body, Make, Simulated, World};

const PERIOD: Duration = Duration::from_millis(100);
const AHEAD: Twist = Twist { v: MetersPerSecond(0.2), omega: mdle_runtime::RadiansPerSecond(0.0) };

/// Runs `drive` in real time with a robot that has these faults; returns the result of `drive`, and the robot.
fn with_robot<T>(faults: &[&str], drive: impl FnOnce(&mut Scout) -> T) -> (T, Faulty<Emulated>) {
    let world = World::office().unwrap();
    let make = Make { body: Body::Scout, without: Vec::new(), seed: None };
    let body = Simulated::with(&make, &world, world.start, Pace::Real.step()).unwrap();
    let faults: Vec<_> = faults.iter().map(|fault| fault.parse().unwrap()).collect();
    let robot = Faulty::new(Emulated::new(body).unwrap(), &faults).unwrap();
    let Driven { result, served, robot } = driven(robot, Pace::Real, |device| {
        // Longer than any machine needs.
        let config = Config { answer: 20_000, gap: 8, ..Configured::read(None, device.to_str()).unwrap().config };
        drive(&mut Scout::connect(config, Clock::Wall, PERIOD, &StopRequest::default()).unwrap())
    })
    .unwrap();
    served.unwrap();
    (result, robot)
}

#[test]
fn a_robot_that_answers_late_is_stopped_in_good_order() {
    let (stop, robot) = with_robot(&["late=300"], |driver| {
        driver.exchange(&AHEAD).unwrap();
        driver.stop()
    });
    let robot = robot.robot();
    assert_eq!((stop, robot.stands()), (Ok(()), true));
    assert_eq!(robot.orders().last().unwrap().1, MotionOrder::LetGo);
}

#[test]
fn a_command_after_the_robot_has_stopped_itself_is_not_sent() {
    let (results, robot) = with_robot(&[], |driver| {
        driver.exchange(&AHEAD).unwrap();
        // The robot's watchdog waits for a second.
        thread::sleep(Duration::from_millis(1100));
        [driver.exchange(&AHEAD).map(drop), driver.stop()]
    });
    let [too_late, stop] = results;
    assert!(too_late.is_err_and(|fault: Fault| fault.to_string().contains("stopped itself")));
    let orders: Vec<MotionOrder> = robot.robot().orders().iter().map(|(_, order)| order).collect();
    assert_eq!(orders.iter().filter(|order| **order == MotionOrder::Drive).count(), 1, "{orders:?}");
    assert_eq!((stop, robot.robot().stands()), (Ok(()), true));
}
