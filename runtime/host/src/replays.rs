//! Functions by which a robot replays paths.

use mdle_runtime::{MetersPerSecond, PathStore, Robot, Twist};

/// Functions and limits to replay and to record paths on a robot whose alphabet has the capability `paths`.
pub struct Replays<R: Robot> {
    /// Maximum forward or backward speed and turn rate of a path.
    pub fastest: Twist,
    /// Hands the robot the paths that the plan replays, before the first exchange: from then on each output has them.
    pub take: fn(&mut R, PathStore),
    /// Returns the forward speed of the robot, by this output.
    pub speed: fn(&R::Output) -> MetersPerSecond,
}
