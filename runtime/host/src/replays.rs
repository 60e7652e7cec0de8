//! Functions with which a robot replays paths.

use mdle_runtime::{MetersPerSecond, PathStore, Robot, Twist};

/// Functions and limits with which a robot replays and records paths. The robot's alphabet has the capability `paths`.
pub struct Replays<R: Robot> {
    /// Maximum forward or backward speed and turn rate of a path.
    pub fastest: Twist,
    /// Function that passes the paths that the plan replays to the robot. The function is called before the first
    /// exchange with the robot; every later output contains these paths.
    pub take: fn(&mut R, PathStore),
    /// Function that returns the robot's forward speed in an output.
    pub speed: fn(&R::Output) -> MetersPerSecond,
}
