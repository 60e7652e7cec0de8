//! The log of a run. The name of the log's file determines its format: JSON lines or a record.

use std::io;
use std::path::Path;

use mdle_quantity::Clocked;
use mdle_record::RecordedChange;
use mdle_runtime::Nanos;

use crate::drive::Exact;
use crate::log::{Log, LogEntry};
use crate::record::{RecordWriter, UnmadeTurn};

/// Ending of a record's file name.
const MCAP: &str = "mcap";

/// A run log that is being written.
#[derive(Debug)]
pub(crate) struct RunLog {
    format: Format,
    /// `true` if the run continues without the log when it cannot be written.
    is_best_effort: bool,
    /// `true` if writing the log has failed and the run continues without it.
    has_ended: bool,
    /// Time of the last turn.
    t: Nanos,
    /// Message that the log has ended before the run; `None` once [`RunLog::take_message`] has returned it.
    message: Option<String>,
}

/// Format of a log, with its writer.
#[derive(Debug)]
pub(crate) enum Format {
    /// JSON lines, one object per turn.
    Lines(Log),
    /// A record from which the run can be replayed.
    Record(Box<RecordWriter>),
}

/// Returns `true` if the name of a log requests a record.
pub fn is_record(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(MCAP))
}

impl RunLog {
    /// Creates a log that begins; with `is_best_effort`, the run continues without the log when it cannot be written.
    pub(crate) fn new(format: Format, is_best_effort: bool) -> Self {
        Self { format, is_best_effort, has_ended: false, t: Nanos::ZERO, message: None }
    }

    /// Returns `true` if the log is a record. A record needs more data of a turn than an entry contains.
    pub(crate) fn is_record(&self) -> bool {
        match self.format {
            Format::Lines(_) => false,
            Format::Record(_) => true,
        }
    }

    /// Stores the output and the input of a turn, and the other changes that influenced the turn.
    pub(crate) fn take(&mut self, exact: Option<Exact<'_>>, changes: Vec<RecordedChange>) {
        match &mut self.format {
            Format::Lines(_) => {}
            Format::Record(record) => record.take(exact, changes),
        }
    }

    /// Writes a turn that was made without a plan.
    ///
    /// # Errors
    /// Fails if the file cannot be written and the run must not continue without a log.
    pub(crate) fn turn_without_plan(&mut self, unmade: &UnmadeTurn<'_>) -> io::Result<()> {
        self.t = unmade.t;
        self.write(|format| match format {
            Format::Lines(_) => Ok(()),
            Format::Record(record) => record.turn_without_plan(unmade),
        })
    }

    /// Writes a turn.
    ///
    /// # Errors
    /// Fails if the file cannot be written and the run must not continue without a log.
    pub(crate) fn turn(&mut self, entry: &LogEntry<'_>) -> io::Result<()> {
        self.t = entry.t;
        self.write(|format| match format {
            Format::Lines(log) => log.turn(entry),
            Format::Record(record) => record.turn(entry),
        })
    }

    /// Writes the reason why the turns have ended; `turn` is the number of the last turn.
    pub(crate) fn ended(&mut self, turn: u64, t: Nanos, cause: &str) {
        match &mut self.format {
            // An error is reported when the record is closed.
            Format::Record(record) if !self.has_ended => drop(record.ended(turn, t, cause)),
            Format::Lines(_) | Format::Record(_) => {}
        }
    }

    /// Passes all data to the system; nothing is written afterwards.
    ///
    /// # Errors
    /// Fails if the file cannot be written and the run must have a log.
    pub(crate) fn close(&mut self) -> io::Result<()> {
        self.write(|format| match format {
            Format::Lines(log) => log.flush(),
            Format::Record(record) => record.close(),
        })
    }

    /// Removes and returns the message that the log has ended before the run; `None` if there is no such message.
    pub(crate) fn take_message(&mut self) -> Option<String> {
        self.message.take()
    }

    /// Calls `write` with the log; does nothing if the log has already ended.
    fn write(&mut self, write: impl FnOnce(&mut Format) -> io::Result<()>) -> io::Result<()> {
        if self.has_ended {
            return Ok(());
        }
        match write(&mut self.format) {
            Err(error) if self.is_best_effort => {
                self.has_ended = true;
                let t = Clocked(self.t);
                self.message =
                    Some(format!("warning: the log ends before {t} of the run, as it cannot be written: {error}"));
                Ok(())
            }
            written => written,
        }
    }
}
