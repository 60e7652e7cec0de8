//! Records of runs: an MCAP file with all data for a bit-exact replay, and with channels that viewers can open
//! (docs/src/reference/interfaces.md, 6.6).
//!
//! The thread that drives a robot encodes each turn as a [frame](frames). The thread that writes the file turns frames
//! into an MCAP file, a [`RecordFile`]. [`Records`] reads the turns of such a file.
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
