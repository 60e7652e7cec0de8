//! The log of a run in the format that its name asks for: JSON lines, or a record.

use std::io;
use std::path::Path;

use mdle_quantity::Clocked;
use mdle_record::Change;
use mdle_runtime::Nanos;

use crate::drive::Exact;
use crate::log::{Entry, Log};
use crate::record::{Record, UnmadeTurn};

/// Ending of the name of a record.
const MCAP: &str = "mcap";

/// A log that is being written.
#[derive(Debug)]
pub(crate) struct RunLog {
    format: Format,
    /// `true` if the run goes on without the log when it cannot be written.
    is_best_effort: bool,
    /// `true` once the log has ended before the run.
    has_ended: bool,
    /// Time of the last turn.
    t: Nanos,
    /// A message about that end which nobody has seen yet.
    message: Option<String>,
}

/// The format of a log.
#[derive(Debug)]
pub(crate) enum Format {
    /// A JSON object for each turn.
    Lines(Log),
    /// A record that can be replayed.
    Record(Box<Record>),
}

/// Returns `true` if the name of a log asks for a record.
pub fn is_record(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(MCAP))
}

impl RunLog {
    /// A log that begins; if `is_best_effort`, the run goes on without it when it cannot be written.
    pub(crate) fn new(format: Format, is_best_effort: bool) -> Self {
        Self { format, is_best_effort, has_ended: false, t: Nanos::ZERO, message: None }
    }

    /// Returns `true` if the log is a record, which takes more of a turn than an entry has.
    pub(crate) fn is_record(&self) -> bool {
        match self.format {
            Format::Lines(_) => false,
            Format::Record(_) => true,
        }
    }

    /// Takes the output and the input of a turn, and its causes besides the output.
    pub(crate) fn take(&mut self, exact: Option<Exact<'_>>, changes: Vec<Change>) {
        match &mut self.format {
            Format::Lines(_) => {}
            Format::Record(record) => record.take(exact, changes),
        }
    }

    /// Writes a turn that no plan has made.
    ///
    /// # Errors
    /// When the file cannot be written, and the run must not go on without it.
    pub(crate) fn turn_without_plan(&mut self, unmade: &UnmadeTurn<'_>) -> io::Result<()> {
        self.t = unmade.t;
        self.write(|format| match format {
            Format::Lines(_) => Ok(()),
            Format::Record(record) => record.turn_without_plan(unmade),
        })
    }

    /// Writes one turn.
    ///
    /// # Errors
    /// When the file cannot be written, and the run must not go on without it.
    pub(crate) fn turn(&mut self, entry: &Entry<'_>) -> io::Result<()> {
        self.t = entry.t;
        self.write(|format| match format {
            Format::Lines(log) => log.turn(entry),
            Format::Record(record) => record.turn(entry),
        })
    }

    /// Notes the end of the turns, the last of which had this number.
    pub(crate) fn ended(&mut self, turn: u64, t: Nanos, cause: &str) {
        match &mut self.format {
            // An error comes back when the record is closed.
            Format::Record(record) if !self.has_ended => drop(record.ended(turn, t, cause)),
            Format::Lines(_) | Format::Record(_) => {}
        }
    }

    /// Hands everything to the system; nothing more is written.
    ///
    /// # Errors
    /// When the file cannot be written, and a run must not be without it.
    pub(crate) fn close(&mut self) -> io::Result<()> {
        self.write(|format| match format {
            Format::Lines(log) => log.flush(),
            Format::Record(record) => record.close(),
        })
    }

    /// Returns the message that the log has ended before the run, once.
    pub(crate) fn take_message(&mut self) -> Option<String> {
        self.message.take()
    }

    /// Writes something, unless the log has ended.
    fn write(&mut self, write: impl FnOnce(&mut Format) -> io::Result<()>) -> io::Result<()> {
        if self.has_ended {
            return Ok(());
        }
        match write(&mut self.format) {
            Err(error) if self.is_best_effort => {
                self.has_ended = true;
                let t = Clocked(self.t);
                self.message =
                    Some(format!("warning: from {t} on the run has no log, as it cannot be written: {error}"));
                Ok(())
            }
            written => written,
        }
    }
}
