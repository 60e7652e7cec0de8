//! The link to the robot, behind which is the middleware, or a test.

use std::time::Duration;

use mdle_runtime::Twist;

use crate::cdr::Payload;
use crate::fault::Fault;
use crate::report::StateMessages;

/// A link to a robot whose topics have been found.
pub trait Link {
    /// Sends a velocity.
    ///
    /// # Errors
    /// Nobody takes it.
    fn command(&mut self, twist: Twist) -> Result<(), Fault>;

    /// Calls `take` with each message since the last call: the index of its topic, and its bytes.
    ///
    /// # Errors
    /// Those of `take`; or several programs publish the odometry.
    fn receive(&mut self, take: &mut dyn FnMut(usize, &Payload) -> Result<(), Fault>) -> Result<(), Fault>;

    /// Sends a zero velocity until all subscribers that acknowledge have done so, or for this time.
    ///
    /// # Errors
    /// No subscriber has acknowledged it.
    fn halt(&mut self, limit: Duration) -> Result<(), Fault>;

    /// Publishes the state of the plan.
    fn publish(&mut self, messages: StateMessages);
}
