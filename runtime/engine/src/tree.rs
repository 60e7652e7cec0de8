//! The tree of attributes and methods (paper, III-H), which users and programs can read, set and call while a plan
//! runs.
//!
//! A front end runs on its own thread, and converts typed text to a [`Request`] to the [`Hub`]. Reading takes values
//! from the snapshot of a turn break; changes wait in a queue until a turn break. The [`Desk`] belongs to the thread
//! that drives the robot, which never waits for a front end.

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
