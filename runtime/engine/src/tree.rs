//! The tree of attributes and methods (paper, III-H), which users and programs can read, set and call while a plan
//! runs.
//!
//! A front end runs on its own thread, and turns typed text into a [`Request`] to the [`Hub`]. Values are read from the
//! snapshot of a turn break; changes wait in a queue until a turn break. The thread that drives the robot has the
//! [`Desk`], and never waits for a front end.

mod desk;
mod hub;
mod node;
mod proposal;
mod request;
mod shared;
#[cfg(test)]
mod tests;
mod value;
mod watch;

pub use desk::{Desk, Reply, Served};
pub use hub::{Hub, QUEUE};
pub use node::{Access, Node, Role, Tree, ValueKind};
pub(crate) use proposal::listed;
pub use request::{Answer, Change, Operation, Request};
pub use value::{Value, read};
