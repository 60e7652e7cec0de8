//! The body of a robot: the constants that laws need.

use crate::Meters;
use crate::capability::Steering;

/// Constants of a body that laws need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Radius of the smallest circle around the body.
    pub body_radius: Meters,
    /// Half the length of the body, measured along its driving direction; the radius of a disc.
    pub half_length: Meters,
    /// Half the width of the body; the radius of a disc.
    pub half_width: Meters,
    /// Distance between the wheels.
    pub wheel_base: Meters,
    /// Distance between two points on a wall beside the robot: the points that reflect the pings of the two neighbours
    /// of the sonar that is square to the wall. `None` for a robot whose odometry measures the heading better than
    /// walls do.
    pub sonars_apart: Option<Meters>,
    /// Distance of the sonars from the robot's centre.
    pub ring_radius: Meters,
    /// Number of pings that must agree before a direction is treated as free.
    pub confirmation: usize,
    /// Steering gains of the laws.
    pub steering: Steering,
}
