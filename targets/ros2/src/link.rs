//! The interface between the driver and the middleware. Tests provide their own implementation.

use std::time::Duration;

use mdle_runtime::Twist;

use crate::cdr::Payload;
use crate::fault::Fault;
use crate::report::StateMessages;

/// A link to a robot whose topics have been found.
pub trait Link {
    /// Sends a velocity command.
    ///
    /// # Errors
    /// Fails if no program subscribes to velocity commands.
    fn command(&mut self, twist: Twist) -> Result<(), Fault>;

    /// Calls `take` with the topic index and the bytes of each message that has arrived since the last call.
    ///
    /// # Errors
    /// Fails if `take` fails, or if several programs publish the odometry.
    fn receive(&mut self, take: &mut dyn FnMut(usize, &Payload) -> Result<(), Fault>) -> Result<(), Fault>;

    /// Sends a zero velocity until all reliable subscribers (those that acknowledge messages) have acknowledged it, or
    /// until the time `limit` has passed. Returns `false` if no subscriber is reliable.
    ///
    /// # Errors
    /// Fails if the reliable subscribers have not acknowledged the zero velocity in time, or if there is no subscriber.
    fn halt(&mut self, limit: Duration) -> Result<bool, Fault>;

    /// Publishes the state of the plan.
    fn publish(&mut self, messages: StateMessages);
}
