//! The log of a run in the format that its name asks for: JSON lines, or a record.

use std::io;
use std::path::Path;

use mdle_record::Change;
use mdle_runtime::Nanos;

use crate::drive::Exact;
use crate::log::{Entry, Log};
use crate::record::{Record, UnmadeTurn};

/// Ending of the name of a record.
const MCAP: &str = "mcap";

/// A log that is being written.
#[derive(Debug)]
pub(crate) enum RunLog {
    /// A JSON object for each turn.
    Lines(Log),
    /// A record that can be replayed.
    Record(Box<Record>),
}

/// Returns `true` if the name of a log asks for a record.
pub(crate) fn is_record(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(MCAP))
}

impl RunLog {
    /// Returns `true` if the log is a record, which takes more of a turn than an entry has.
    pub(crate) fn is_record(&self) -> bool {
        match self {
            Self::Lines(_) => false,
            Self::Record(_) => true,
        }
    }

    /// Takes the output and the input of a turn, and its causes besides the output.
    pub(crate) fn take(&mut self, exact: Option<Exact<'_>>, changes: Vec<Change>) {
        match self {
            Self::Lines(_) => {}
            Self::Record(record) => record.take(exact, changes),
        }
    }

    /// Writes a turn that no plan has made.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn turn_without_plan(&mut self, unmade: &UnmadeTurn<'_>) -> io::Result<()> {
        match self {
            Self::Lines(_) => Ok(()),
            Self::Record(record) => record.turn_without_plan(unmade),
        }
    }

    /// Writes one turn.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn turn(&mut self, entry: &Entry<'_>) -> io::Result<()> {
        match self {
            Self::Lines(log) => log.turn(entry),
            Self::Record(record) => record.turn(entry),
        }
    }

    /// Notes the end of the turns, the last of which had this number.
    pub(crate) fn ended(&mut self, turn: u64, t: Nanos, cause: &str) {
        match self {
            Self::Lines(_) => {}
            // An error comes back when the record is closed.
            Self::Record(record) => drop(record.ended(turn, t, cause)),
        }
    }

    /// Hands everything to the system; nothing more is written.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(crate) fn close(&mut self) -> io::Result<()> {
        match self {
            Self::Lines(log) => log.flush(),
            Self::Record(record) => record.close(),
        }
    }
}
