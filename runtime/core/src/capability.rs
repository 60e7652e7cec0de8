//! Capabilities: one trait for each capability that an alphabet can name, implemented by the robot's output.
//! See docs/src/reference/interfaces.md, 7.2.

use crate::{
    Links, Meters, Nanos, Output, Peer, Pings, Pose, PublishedNumber, Radians, Setpoint, SonarId, Twist, Volts,
};

/// `odometry`: the robot measures its pose and its velocities, in coordinates that stay fixed until the robot is
/// switched off.
pub trait Odometry: Output {
    /// Returns the pose.
    fn pose(&self) -> Pose;
    /// Returns the measured velocities.
    fn velocity(&self) -> Twist;
    /// Returns the angle by which drift of the heading has turned a frame away from the walls; `axis` is the direction
    /// of one of the frame's axes. Returns 0 unless the robot has a better estimate than its odometry, for example from
    /// a [`crate::Compass`].
    fn drift(&self, _axis: Radians) -> Radians {
        Radians(0.0)
    }
}

/// `bumper`: the robot detects contact.
pub trait Bumpers: Output {
    /// Returns `true` if any bumper is in contact.
    fn pressed(&self) -> bool;
}

/// `diff_drive`: the robot has two driven wheels, so its input is a [`Twist`]. The trait provides the dimensions that
/// laws need.
pub trait DiffDrive: Output {
    /// Returns the radius of the smallest circle around the body.
    fn body_radius(&self) -> Meters;
    /// Returns half the length of a rectangular body, measured along its driving direction, or the radius of a
    /// disc.
    fn half_length(&self) -> Meters {
        self.body_radius()
    }
    /// Returns half the width of a rectangular body, or the radius of a disc.
    fn half_width(&self) -> Meters {
        self.body_radius()
    }
    /// Returns `true` if the body is a disc, and `false` if it is a rectangle.
    fn is_disc(&self) -> bool {
        self.body_radius() <= self.half_length()
    }
    /// Returns the distance between the wheels.
    fn wheel_base(&self) -> Meters;
    /// Returns the steering gains of the laws.
    fn steering(&self) -> Steering {
        Steering::USUAL
    }
}

/// Steering gains of the laws: the factor `k` between the remaining error and the turn rate (paper, section IV-A).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// Gain of `rotate`, `turn` and `path`, in rad/s per radian of the angle that remains.
    pub rotate: f64,
    /// Gain of `align`, in rad/s per metre of difference between the ranges.
    pub align: f64,
    /// Gain of `goAvoid`, in rad/s per radian between the heading and the chosen direction.
    pub avoid: f64,
}

impl Steering {
    /// The usual gains. With these gains, `rotate` requires at most 1.6 rad/s², in its fastest turn. A Scout's wheels
    /// can do more than three times that, and an ATRV-mini's limits were set to 1.55 and 2.
    pub const USUAL: Self = Self { rotate: 2.0, align: 2.0, avoid: 2.0 };
}

/// `sonar[16]`: a ring of sonars in the sixteen directions of [`SonarId`].
pub trait SonarRing: Output {
    /// Returns the last pings of one sonar.
    fn pings(&self, sonar: SonarId) -> &Pings;
    /// Returns the time of this output, on the same clock as the times of the pings.
    fn now(&self) -> Nanos;
    /// Returns the distance of the transducers from the centre of the body.
    fn ring_radius(&self) -> Meters;
    /// Returns the number of pings that must agree before a direction is treated as free: two on a robot whose sonars
    /// fire one after the other, three on any other robot.
    fn confirmation(&self) -> usize {
        3
    }
    /// Returns the range below which `atIsection` treats a direction as blocked.
    fn blocked_within(&self) -> Meters {
        Meters(1.15)
    }
}

/// `power`: the robot measures its battery, and detects whether it is plugged in.
pub trait Power: Output {
    /// Returns the voltage of the battery, as the robot measures it.
    fn battery(&self) -> Volts;
    /// Returns `true` if the battery has to be charged, according to the robot's own limit.
    fn is_low(&self) -> bool;
    /// Returns `true` if the robot is on its charger.
    fn is_plugged(&self) -> bool;
}

/// `paths`: the robot has a store of recorded and loaded paths.
pub trait Paths: Output {
    /// Returns the setpoints of the path `name`; `None` if no path has this name.
    fn path(&self, name: &str) -> Option<&[Setpoint]>;
}

/// `modules`: an engine runs the plan together with modules, which publish values that no sensor of the robot measures.
pub trait Modules: Output {
    /// Returns the last number that the module has published for this attribute; `None` before the first publication.
    fn published(&self, module: &str, attribute: &str) -> Option<PublishedNumber>;
}

/// `state_link`: an engine runs the plan, with a link over which robots send each other their states.
pub trait StateLink: Output {
    /// Returns the other robots that the plan names, with their states.
    fn links(&self) -> &Links;

    /// Returns the other robot with the name `robot`; `None` if the plan names no such robot.
    fn peer(&self, robot: &str) -> Option<&Peer> {
        self.links().peer(robot)
    }
}
