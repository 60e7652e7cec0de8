//! The Super Scout and its driver, as the tests of every robot on a line have them.

use std::time::Duration;

use mdle_emulator::Trial;
use mdle_runtime::Pose;
use mdle_scout::{Scout, alphabet};
use mdle_scout_emulator::scout::Scout as Emulated;
use mdle_simulator::{Body, Simulated};

/// The robot of these tests.
pub(crate) enum Robot {}

impl Trial for Robot {
    type Driver = Scout;
    type Alphabet = alphabet::Alphabet;
    type Emulated = Emulated;
    const BODY: Body = Body::Scout;

    fn emulated(body: Simulated, _: Duration) -> Result<Emulated, String> {
        Emulated::new(body)
    }

    fn pose(robot: &Emulated) -> Pose {
        robot.pose()
    }
}
