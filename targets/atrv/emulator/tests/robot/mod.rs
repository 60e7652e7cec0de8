//! The ATRV-mini and its driver, as the tests of every robot on a line have them.

use std::time::Duration;

use mdle_atrv::{Atrv, alphabet};
use mdle_atrv_emulator::atrv::{Atrv as Emulated, step};
use mdle_emulator::{Pace, Trial};
use mdle_runtime::Pose;
use mdle_simulator::{Body, Simulated};

/// The robot of these tests.
pub(crate) enum Robot {}

impl Trial for Robot {
    type Driver = Atrv;
    type Alphabet = alphabet::Alphabet;
    type Emulated = Emulated;
    const BODY: Body = Body::Atrv;

    fn step(pace: Pace) -> Duration {
        step(pace)
    }

    fn emulated(body: Simulated, step: Duration) -> Result<Emulated, String> {
        Emulated::new(body, step, false)
    }

    fn pose(robot: &Emulated) -> Pose {
        robot.pose()
    }
}
