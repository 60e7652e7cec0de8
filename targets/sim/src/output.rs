//! The robot's output: what its odometry, bumper and sonars say (`y = h(x)`, paper, Eq. 1).

use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Meters, Output, Pings, Pose, SONARS, SonarId, Twist};

/// The output of one turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    pub(crate) odometry: Pose,
    pub(crate) velocity: Twist,
    /// Bit `i` for bumper switch `i`.
    pub(crate) switches: u32,
    pub(crate) pings: [Pings; SONARS],
    pub(crate) shape: Shape,
}

/// What laws must know of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    pub(crate) body_radius: Meters,
    pub(crate) wheel_base: Meters,
    pub(crate) ring_radius: Meters,
    pub(crate) confirmation: usize,
}

impl Sensed {
    /// The bumper switches in contact: bit `i` for number `i`, counted counter-clockwise from the front. A Scout has
    /// six, an ATRV-mini one before and one behind.
    #[must_use]
    pub fn switches(&self) -> u32 {
        self.switches
    }
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
        self.shape.body_radius
    }

    fn wheel_base(&self) -> Meters {
        self.shape.wheel_base
    }
}

impl SonarRing for Sensed {
    fn pings(&self, sonar: SonarId) -> &Pings {
        // Numbers of sonars are below 16.
        &self.pings[sonar.number()]
    }

    fn ring_radius(&self) -> Meters {
        self.shape.ring_radius
    }

    fn confirmation(&self) -> usize {
        self.shape.confirmation
    }
}
