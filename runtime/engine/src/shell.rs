//! The shell: a session of a person, or of a file of commands, with a run (paper, III-H; docs/src/shell.md).
//!
//! A [`Session`] is the supervisor of the run: it serves requests at breaks, and can stop the clock. The front
//! end, [`converse`], runs on a thread of its own.

mod clock;
mod command;
mod converse;
mod lines;
mod link;
mod modules;
mod parts;
mod plans;
mod recorder;
mod session;

pub use converse::{Conversation, converse};
pub use lines::{Input, Lines, PrintAbove, Terminal, Typed};
pub use session::Session;
