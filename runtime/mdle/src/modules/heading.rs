//! The module `heading`, which publishes the bearing and the range of a point in odometry coordinates.

use mdle_engine::{Declare, Fault, In, Module, Out, Relevance, Turn};
use mdle_runtime::{Meters, Radians, Sensed};

/// The module that publishes the direction and the distance to a point.
pub(super) struct Heading {
    x: In<Meters>,
    y: In<Meters>,
    bearing: Out<Radians>,
    range: Out<Meters>,
}

impl Heading {
    /// Declares the module for the point `(x, y)`, given in metres by odometry.
    pub(super) fn declare(declare: &mut Declare, (x, y): (f64, f64)) -> Self {
        let heading = Self {
            x: declare.setting("x", Meters(x)),
            y: declare.setting("y", Meters(y)),
            bearing: declare.publishes("bearing"),
            range: declare.publishes("range"),
        };
        declare.doc("Publishes bearing and range of a point.");
        declare.describe("x", "m", "Position of the point along the first axis of odometry.");
        declare.describe("y", "m", "Position of the point along the second axis of odometry.");
        declare.describe("bearing", "deg", "Direction to the point, from where the robot heads.");
        declare.describe("range", "m", "Distance of the point.");
        declare.relevance(Relevance::WhenRead);
        heading
    }
}

impl Module<Sensed> for Heading {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let here = turn.y.odometry;
        let (Some(Meters(x)), Some(Meters(y))) = (turn.get(self.x), turn.get(self.y)) else { return Ok(()) };
        let (x, y) = (x - here.x.0, y - here.y.0);
        turn.publish(self.bearing, Radians(libm::atan2(y, x) - here.theta.0).wrapped());
        turn.publish(self.range, Meters(libm::hypot(x, y)));
        Ok(())
    }
}
