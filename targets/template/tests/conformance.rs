//! Checks that the robot does what the capabilities in its alphabet require of any robot. Run it with `cargo test`.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use mdle_conformance::{Room, Stage, Suite};
use mdle_host::clap::Command;
use mdle_host::{StopRequest, Target as _};
use mdle_runtime::{Nanos, Pose, Radians, Robot as _};
use template_target::{Hardware, Input, Target, alphabet};

/// Stage of the conformance suite: places the robot and observes it.
struct Floor {
    began: Pose,
}

impl Stage for Floor {
    type Robot = Hardware;
    type Alphabet = alphabet::Alphabet;
    const PERIOD: Nanos = alphabet::PERIOD;

    /// REPLACE: restart the robot, make sure that the walls are where `room` places them, and put the robot at the pose
    /// `at` among them. A simulated robot without walls is wherever it is placed.
    fn robot(&mut self, _room: &Room, at: Pose) -> Result<Hardware, String> {
        self.began = at;
        let options = Target::arguments(Command::new("conformance")).get_matches_from(["conformance"]);
        Target::connect(&options, Duration::from_nanos(Self::PERIOD.0), &StopRequest::default())
            .map_err(|refusal| format!("{refusal:?}"))
    }

    /// REPLACE: return the robot's true pose, as measured by a test bench, a simulator or a camera.
    fn truth(&self, robot: &Hardware) -> Pose {
        let (imagined, began) = (robot.imagined(), self.began);
        let left = Radians(began.theta.0 + FRAC_PI_2);
        let place = began.towards(began.theta, imagined.x).towards(left, imagined.y);
        Pose { theta: Radians(began.theta.0 + imagined.theta.0), ..place }
    }

    /// REPLACE: wait for this number of periods. A simulated robot moves only with commands.
    fn left_alone(&mut self, robot: &mut Hardware, periods: u32) {
        for _ in 0..periods {
            let _ = robot.exchange(&Input::default()).unwrap();
        }
    }
}

#[test]
fn the_robot_conforms() {
    let mut floor = Floor { began: Pose::ORIGIN };
    // Call a method for each capability of the alphabet; there are also `.bumper()`, `.sonar()` and `.paths()`.
    let report = Suite::on(&mut floor).diff_drive().odometry().report();
    assert!(report.holds(), "{report}");
}
