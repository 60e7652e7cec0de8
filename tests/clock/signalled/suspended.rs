//! Tests that a robot does not start to drive again if its program was suspended while the robot drove or was being
//! opened, and continues much later.

use std::time::Duration;

use mdle_atrv_emulator::atrv::Atrv;
use mdle_emulator::Pace;
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_tests::executable::folder;

use crate::at_once;

use super::run::{AT_REST, Ran, Robot, distance, drove, ran, send};

/// Distance after which the robot counts as driving, in metres.
const DRIVES: f64 = 0.03;
/// Time for which the program is suspended. It is longer than the timeout of any robot's watchdog and the subsequent
/// braking.
const SUSPENDED: Duration = Duration::from_millis(2500);

/// Suspends the program once `begins` returns `true`. Returns the run, and the pose of the robot when the program
/// continued.
fn suspended<R: Robot>(name: &str, begins: fn(&R) -> bool) -> (Ran<R>, Option<Pose>) {
    let folder = folder(&format!("suspended_{name}_{}", R::NAME));
    let config = folder.join("config.toml");
    std::fs::write(&config, "").unwrap();
    let (mut suspended, mut resumed): (Option<Duration>, Option<Pose>) = (None, None);
    let ran = ran::<R>(&config, Pace::Real, None, &mut |robot, received, time| match &mut suspended {
        None if begins(robot) => {
            send(19, received.process);
            suspended = Some(Duration::ZERO);
        }
        None => {}
        Some(passed) => {
            *passed += time;
            if *passed >= SUSPENDED && resumed.is_none() {
                resumed = Some(robot.pose());
                send(18, received.process);
            }
        }
    });
    (ran, resumed)
}

fn is_not_driven_off_again<R: Robot>() {
    let origin = Pose::default();
    let (ran, resumed) = suspended::<R>("driving", |robot| distance(&Pose::default(), &robot.pose()) >= DRIVES);
    assert!(distance(&origin, &resumed.unwrap()) >= DRIVES);
    let way = distance(&resumed.unwrap(), &ran.robot.pose());
    assert!(way < AT_REST && ran.output.status.code() == Some(3), "{way} m, {}", ran.errors());
    assert!(ran.errors().contains("a fault stopped the robot: "), "{}", ran.errors());
}

/// Asserts that a program refuses to drive and prints `words` if it was suspended after its first motion command, which
/// stops the robot.
fn is_not_driven<R: Robot>(words: &str) {
    let (ran, resumed) = suspended::<R>("opening", |robot| robot.orders().last().is_some());
    assert!(resumed.is_some() && !drove(&ran.robot), "{:?}", ran.robot.orders());
    // The error is that of a refused start, and does not say that a running robot was stopped.
    let refused = format!("error: {words} was this computer suspended, or too busy?");
    assert!(ran.output.status.code() == Some(3) && ran.errors().starts_with(&refused), "{}", ran.errors());
}

#[test]
fn a_robot_is_not_driven_after_a_suspension() {
    at_once(&[
        is_not_driven_off_again::<Scout>,
        is_not_driven_off_again::<Atrv>,
        || is_not_driven::<Scout>("the Scout has stopped itself, as no command came for 1 s:"),
        || is_not_driven::<Atrv>("the ATRV was stopped, as no command came for 500 ms:"),
    ]);
}
