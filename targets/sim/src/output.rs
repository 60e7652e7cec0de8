//! The robot's output: what its odometry, bumper and sonars say (`y = h(x)`, paper, Eq. 1).

use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Meters, Output, Pings, Pose, SONARS, SonarId, Twist};

use crate::{body, sonar};

/// The output of one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    pub(crate) odometry: Pose,
    pub(crate) velocity: Twist,
    pub(crate) pressed: bool,
    pub(crate) pings: [Pings; SONARS],
}

impl Output for Sensed {
    fn here(&self) -> Pose {
        self.odometry
    }
}

impl Odometry for Sensed {
    fn pose(&self) -> Pose {
        self.odometry
    }

    fn velocity(&self) -> Twist {
        self.velocity
    }
}

impl Bumpers for Sensed {
    fn pressed(&self) -> bool {
        self.pressed
    }
}

impl DiffDrive for Sensed {
    fn body_radius(&self) -> Meters {
        Meters(body::RADIUS)
    }

    fn wheel_base(&self) -> Meters {
        Meters(body::WHEEL_BASE)
    }
}

impl SonarRing for Sensed {
    fn pings(&self, sonar: SonarId) -> &Pings {
        // Numbers of sonars are below 16.
        &self.pings[sonar.number()]
    }

    fn ring_radius(&self) -> Meters {
        Meters(sonar::RING_RADIUS)
    }
}
