//! Capabilities: one trait for each capability that an alphabet can name, implemented by the robot's output.
//! See docs/src/reference/interfaces.md, 7.2.

use crate::{
    Links, Meters, Nanos, Output, Peer, Pings, Pose, PublishedNumber, Radians, Setpoint, SonarId, Twist, Volts,
};

/// `odometry`: the robot knows where it is and how fast it moves, in axes that stay put while it is switched on.
pub trait Odometry: Output {
    /// The pose.
    fn pose(&self) -> Pose;
    /// The measured velocities.
    fn velocity(&self) -> Twist;
    /// Returns the angle by which walls are off the axes of a frame, one of which has the direction `axis`, as far as
    /// the heading has drifted: 0 unless the robot knows it better than its odometry, as by a [`crate::Compass`].
    fn drift(&self, _axis: Radians) -> Radians {
        Radians(0.0)
    }
}

/// `bumper`: the robot feels contact.
pub trait Bumpers: Output {
    /// Returns `true` if any bumper is in contact.
    fn pressed(&self) -> bool;
}

/// `diff_drive`: two driven wheels, so that an input is a [`Twist`]; gives the dimensions that laws need.
pub trait DiffDrive: Output {
    /// The radius of the smallest circle around the body.
    fn body_radius(&self) -> Meters;
    /// Returns half the length of a rectangular body, along which it drives; the radius of a disc.
    fn half_length(&self) -> Meters {
        self.body_radius()
    }
    /// Returns half the width of a rectangular body; the radius of a disc.
    fn half_width(&self) -> Meters {
        self.body_radius()
    }
    /// The distance between the wheels.
    fn wheel_base(&self) -> Meters;
    /// Returns the gains by which laws steer.
    fn steering(&self) -> Steering {
        Steering::USUAL
    }
}

/// Gains by which laws steer: the `k` of each law, in turn rate for the remaining error (paper, section IV-A).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// `rotate`, `turn` and `path`: in rad/s for each radian still to turn.
    pub rotate: f64,
    /// `align`: in rad/s for each metre by which the ranges differ.
    pub align: f64,
    /// `goAvoid`: in rad/s for each radian off the direction chosen.
    pub avoid: f64,
}

impl Steering {
    /// The usual gains. For `rotate`, with its fastest turn, they ask for 1.6 rad/s² at most, where a Scout's wheels
    /// can do more than three times that, and an ATRV-mini's were set to 1.55 and 2.
    pub const USUAL: Self = Self { rotate: 2.0, align: 2.0, avoid: 2.0 };
}

/// `sonar[16]`: a ring of sonars in the sixteen directions of [`SonarId`].
pub trait SonarRing: Output {
    /// The last pings of one sonar.
    fn pings(&self, sonar: SonarId) -> &Pings;
    /// The time of this output, on the clock by which pings are dated.
    fn now(&self) -> Nanos;
    /// The distance of the transducers from the centre of the body.
    fn ring_radius(&self) -> Meters;
    /// Returns the number of pings that must agree that a way is free: three, or two on a robot whose sonars fire in
    /// turn.
    fn confirmation(&self) -> usize {
        3
    }
    /// The range under which `atIsection` reads a direction as blocked.
    fn blocked_within(&self) -> Meters {
        Meters(1.15)
    }
}

/// `power`: the robot measures its battery, and knows whether it is plugged in.
pub trait Power: Output {
    /// The voltage of the battery, as the robot measures it.
    fn battery(&self) -> Volts;
    /// Returns `true` if the battery has to be charged, by this robot's own limit.
    fn is_low(&self) -> bool;
    /// Returns `true` if the robot is on its charger.
    fn is_plugged(&self) -> bool;
}

/// `paths`: there is a store of recorded and loaded paths.
pub trait Paths: Output {
    /// The setpoints of a path; `None` if there is no path of this name.
    fn path(&self, name: &str) -> Option<&[Setpoint]>;
}

/// `modules`: an engine runs the plan, with modules that publish what no sensor of the robot measures.
pub trait Modules: Output {
    /// Returns the number that this module has published last under this name; `None` before the first.
    fn published(&self, module: &str, attribute: &str) -> Option<PublishedNumber>;
}

/// `state_link`: an engine runs the plan, with a link by which robots tell each other their states.
pub trait StateLink: Output {
    /// Returns the other robots that the plan names.
    fn links(&self) -> &Links;

    /// Returns another robot that the plan names; `None` if the link knows no robot of this name.
    fn peer(&self, robot: &str) -> Option<&Peer> {
        self.links().peer(robot)
    }
}
