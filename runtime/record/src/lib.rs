//! Writes and reads the records of runs. A record is an MCAP file that contains all data for a replay that is exact to
//! the bit, and channels that viewers can open (docs/src/reference/interfaces.md, 6.6).
//!
//! The thread that drives a robot encodes each turn as a [frame](frames). The thread that writes the file converts
//! frames to an MCAP file, using a [`RecordFile`]. [`Records`] reads the turns of such a file.
#![forbid(unsafe_code)]

mod begin;
mod bytes;
mod change;
mod exact;
pub mod frames;
mod parts;
mod reader;
#[cfg(test)]
mod tests;
mod turn;
mod viewers;
mod writer;

pub use begin::{Begin, Constants, SafetyTexts};
pub use change::{Overruled, RecordedChange};
pub use reader::{Message, MessageKind, ReadError, Records, TurnsWithMessages};
pub use turn::{Applied, Chain, RecordedTransition, RecordedTurn, TurnMade};
pub use writer::RecordFile;
