//! The body of a robot, as laws need it.

use crate::Meters;
use crate::capability::Steering;

/// Constants of a body that laws need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Radius of the smallest circle around the body.
    pub body_radius: Meters,
    /// Half the length of the body, along which it drives; of a disc its radius.
    pub half_length: Meters,
    /// Half the width of the body; of a disc its radius.
    pub half_width: Meters,
    /// The distance between its wheels.
    pub wheel_base: Meters,
    /// Distance, on a wall beside the robot, between the places that the two neighbours of the sonar square to it hear;
    /// `None` for a robot whose heading by odometry is better than its heading by walls.
    pub sonars_apart: Option<Meters>,
    /// The distance of the sonars from its centre.
    pub ring_radius: Meters,
    /// Number of pings that must agree that a way is free.
    pub confirmation: usize,
    /// Gains by which laws steer the robot.
    pub steering: Steering,
}
