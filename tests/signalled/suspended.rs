//! A program that is suspended while its robot drives, and goes on much later: the robot is not driven off again.

use std::time::Duration;

use mdle_atrv_emulator::atrv::{Atrv, step};
use mdle_emulator::{Ailment, Emulated, Pace, Port, STEP, serve};
use mdle_runtime::Pose;
use mdle_scout_emulator::scout::Scout;
use mdle_sim::Body;
use mdle_tests::executable::folder;

use crate::{Case, STANDS, body, distance, send, started};

/// It drives once it has gone so far, in metres.
const DRIVES: f64 = 0.03;
/// How long the program is suspended: longer than any of the robots' watchdogs waits and than they take to stand.
const SUSPENDED: Duration = Duration::from_millis(2500);

/// A robot whose program is suspended once it drives.
struct Suspending<R> {
    robot: R,
    pose: fn(&R) -> Pose,
    process: u32,
    begun: Option<Pose>,
    /// For how long the program has been suspended by the time of the world, and where the robot was at the end of that.
    suspended: Option<Duration>,
    stood: Option<Pose>,
}

impl<R: Emulated> Emulated for Suspending<R> {
    fn push(&mut self, bytes: &[u8]) {
        self.robot.push(bytes);
    }

    fn obey(&mut self) -> Option<bool> {
        self.robot.obey()
    }

    fn pass(&mut self, time: Duration) -> Result<(), String> {
        let passed = self.robot.pass(time);
        let here = (self.pose)(&self.robot);
        let begun = *self.begun.get_or_insert(here);
        match &mut self.suspended {
            None if distance(&begun, &here) >= DRIVES => {
                send(19, self.process);
                self.suspended = Some(Duration::ZERO);
            }
            None => {}
            Some(suspended) => {
                *suspended += time;
                if *suspended >= SUSPENDED && self.stood.is_none() {
                    self.stood = Some(here);
                    send(18, self.process);
                }
            }
        }
        passed
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

/// How far this robot goes after its program goes on, in metres, with the status and the errors of that.
fn goes_on<R: Emulated>(name: &'static str, robot: R, pose: fn(&R) -> Pose) -> (f64, Option<i32>, String) {
    let folder = folder(&format!("suspended_{name}"));
    std::fs::write(folder.join(name), "").unwrap();
    let port = Port::open().unwrap();
    let case = Case { robot: name, signal: 0, moment: 0 };
    let child = std::sync::Mutex::new(started(case, port.path(), &folder));
    let process = child.lock().unwrap().id();
    let mut robot = Suspending { robot, pose, process, begun: None, suspended: None, stood: None };
    serve(&mut robot, &port, Pace::Real, &|| child.lock().unwrap().try_wait().unwrap().is_none()).unwrap();
    let output = child.into_inner().unwrap().wait_with_output().unwrap();
    (0..10).for_each(|_| robot.pass(STEP).unwrap());
    let way = distance(&robot.stood.unwrap(), &pose(&robot.robot));
    (way, output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_robot_is_not_driven_off_again_after_a_suspension() {
    let (way, status, errors) = goes_on("scout", Scout::new(body(Body::Scout, STEP)).unwrap(), Scout::pose);
    assert!(way < STANDS && status == Some(3), "{way} m, {status:?}, {errors}");
    assert!(errors.contains("error: a fault stopped the robot: it had no command for "), "{errors}");
    let step = step(Pace::Real);
    let atrv = Atrv::new(body(Body::Atrv, step), step, false).unwrap();
    let (way, status, errors) = goes_on("atrv", atrv, Atrv::pose);
    assert!(way < STANDS && status == Some(3), "{way} m, {status:?}, {errors}");
}
