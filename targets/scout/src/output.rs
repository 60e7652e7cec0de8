//! The robot's output: what its odometry, bumper and sonars say (`y = h(x)`, paper, Eq. 1).

use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Meters, Output, Pings, Pose, SONARS, SonarId, Twist};

use crate::wheels::WHEEL_BASE;

/// The radius of the body.
const RADIUS: Meters = Meters(0.205);
/// How many pings must agree that a way is free on a robot whose sonars fire in turn.
const CONFIRMATION: usize = 2;

/// The output of one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    pub(crate) odometry: Pose,
    pub(crate) velocity: Twist,
    pub(crate) switches: u32,
    pub(crate) pings: [Pings; SONARS],
    pub(crate) ring_radius: Meters,
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
        self.switches != 0
    }
}

impl DiffDrive for Sensed {
    fn body_radius(&self) -> Meters {
        RADIUS
    }

    fn wheel_base(&self) -> Meters {
        Meters(WHEEL_BASE)
    }
}

impl SonarRing for Sensed {
    fn pings(&self, sonar: SonarId) -> &Pings {
        // Numbers of sonars are below 16.
        &self.pings[sonar.number()]
    }

    fn ring_radius(&self) -> Meters {
        self.ring_radius
    }

    fn confirmation(&self) -> usize {
        CONFIRMATION
    }
}
