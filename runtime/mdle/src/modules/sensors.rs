//! The module `sensors`, which publishes readings of the robot. Modules that have no access to the robot's output need
//! it, such as child processes.

use mdle_engine::{Declare, Fault, Module, Out, Relevance, Turn};
use mdle_runtime::capability::{Bumpers as _, SonarRing as _};
use mdle_runtime::{Meters, MetersPerSecond, Radians, RadiansPerSecond, Sensed, SonarId};

/// Number of sonars.
const SONARS: u8 = 16;

/// The module that publishes the readings of the robot.
pub(super) struct Sensors {
    x: Out<Meters>,
    y: Out<Meters>,
    theta: Out<Radians>,
    v: Out<MetersPerSecond>,
    omega: Out<RadiansPerSecond>,
    bumper: Out<bool>,
    ranges: Vec<(SonarId, Out<Meters>)>,
}

impl Sensors {
    /// Declares the module.
    pub(super) fn declare(declare: &mut Declare) -> Self {
        let robot = Self {
            x: declare.publishes("x"),
            y: declare.publishes("y"),
            theta: declare.publishes("theta"),
            v: declare.publishes("v"),
            omega: declare.publishes("omega"),
            bumper: declare.publishes("bumper"),
            ranges: (0..SONARS).map(|sonar| (SonarId::new(sonar), declare.publishes(&format!("r{sonar}")))).collect(),
        };
        declare.doc("Publishes the readings of the robot.");
        declare.describe("theta", "deg", "Heading by odometry.");
        declare.describe("omega", "deg/s", "Measured turn rate.");
        declare.relevance(Relevance::WhenRead);
        robot
    }
}

impl Module<Sensed> for Sensors {
    fn turn(&mut self, turn: &mut Turn<'_, Sensed>) -> Result<(), Fault> {
        let Sensed { odometry, velocity, .. } = turn.y;
        turn.publish(self.x, odometry.x);
        turn.publish(self.y, odometry.y);
        turn.publish(self.theta, odometry.theta);
        turn.publish(self.v, velocity.v);
        turn.publish(self.omega, velocity.omega);
        turn.publish(self.bumper, turn.y.pressed());
        for (sonar, out) in &self.ranges {
            if let Some(ping) = turn.y.pings(*sonar).newest_first().next() {
                // No echo means that nothing is near.
                turn.publish(*out, ping.range.unwrap_or(Meters(f64::INFINITY)));
            }
        }
        Ok(())
    }
}
