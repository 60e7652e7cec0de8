//! The module `template`: it publishes the way back to where the robot began.

use mdle::engine::{Declare, Fault, Module, Out, Turn};
use mdle_runtime::{Meters, Pose, Radians, Sensed};

/// Publishes the direction and the distance to the place of the first turn.
pub struct WayBack {
    start: Option<Pose>,
    bearing: Out<Radians>,
    range: Out<Meters>,
}

impl WayBack {
    /// Declares the attributes of the module, and returns it as it is before its first turn.
    pub fn declare(declare: &mut Declare) -> Self {
        let module = Self { start: None, bearing: declare.publishes("bearing"), range: declare.publishes("range") };
        declare.describe("bearing", "deg", "Direction to the start, from where the robot heads.");
        declare.describe("range", "m", "Distance of the start.");
        module
    }
}

impl Module<Sensed> for WayBack {
    /// Makes a turn. All values are in metres, seconds and radians.
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let here = turn.y.odometry;
        let start = *self.start.get_or_insert(here);
        let (x, y) = (start.x.0 - here.x.0, start.y.0 - here.y.0);
        turn.publish(self.bearing, Radians(libm::atan2(y, x) - here.theta.0).wrapped());
        turn.publish(self.range, Meters(libm::hypot(x, y)));
        Ok(())
    }
}
