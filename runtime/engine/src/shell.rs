//! The shell: controls a run by commands from a user or a file (paper, III-H; docs/src/shell.md).
//!
//! A [`Session`] is the supervisor of the run: it serves requests at turn breaks, and can pause the clock. The front
//! end, [`converse`], runs on its own thread.

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
pub use lines::{FileLines, Lines, PrintAbove, TerminalLines, Typed};
pub use session::Session;
