//! The program `mdle` with a module that publishes the way to a point.

use std::process::ExitCode;

use mdle::engine::{Declare, Fault, In, Module, Out, Turn};
use mdle_runtime::{Meters, Radians, Sensed};

/// Publishes the direction and the distance to a point ahead of where the robot began.
struct Heading {
    ahead: In<Meters>,
    bearing: Out<Radians>,
    range: Out<Meters>,
}

impl Heading {
    fn declare(declare: &mut Declare) -> Self {
        let heading = Self {
            ahead: declare.setting("ahead", Meters(3.0)),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
        };
        declare.describe("ahead", "m", "Distance of the point from where the robot began.");
        declare.describe("bearing", "deg", "Direction to the point, from where the robot heads.");
        heading
    }
}

impl Module<Sensed> for Heading {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let here = turn.y.odometry;
        let Some(Meters(ahead)) = turn.get(self.ahead) else { return Ok(()) };
        let (x, y) = (ahead - here.x.0, -here.y.0);
        turn.publish(self.bearing, Radians(libm::atan2(y, x) - here.theta.0).wrapped());
        turn.publish(self.range, Meters(libm::hypot(x, y)));
        Ok(())
    }
}

fn main() -> ExitCode {
    mdle::main_with(|library| library.registered("heading", Heading::declare))
}
