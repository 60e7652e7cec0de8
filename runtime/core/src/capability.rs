//! What a robot can offer to quarks: one trait for each capability an alphabet can name, implemented by the robot's output.
//! `state_link`, `modules` and `paths` have none yet, so no robot can offer them.

use crate::{Meters, Output, Pings, Pose, SonarId, Twist};

/// `odometry`: the robot knows where it is and how fast it moves, in axes that stay put while it is switched on.
pub trait Odometry: Output {
    /// The pose.
    fn pose(&self) -> Pose;
    /// The measured velocities.
    fn velocity(&self) -> Twist;
}

/// `bumper`: the robot feels contact.
pub trait Bumpers: Output {
    /// Whether any bumper is in contact.
    fn pressed(&self) -> bool;
}

/// `diff_drive`: two driven wheels, so an input is a [`Twist`]; what laws must know of the body.
pub trait DiffDrive: Output {
    /// The radius of the smallest circle around the body.
    fn body_radius(&self) -> Meters;
    /// The distance between the wheels.
    fn wheel_base(&self) -> Meters;
}

/// `sonar[16]`: a ring of sonars in the sixteen directions of [`SonarId`].
pub trait SonarRing: Output {
    /// The last pings of one sonar.
    fn pings(&self, sonar: SonarId) -> &Pings;
    /// The distance of the transducers from the centre of the body.
    fn ring_radius(&self) -> Meters;
    /// How many pings must agree that a way is free: three, or two on a robot whose sonars fire in turn.
    fn confirmation(&self) -> usize {
        3
    }
    /// The range under which `atIsection` reads a direction as blocked.
    fn blocked_within(&self) -> Meters {
        Meters(1.15)
    }
}
