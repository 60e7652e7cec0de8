//! The record of a robot without a run of its own, such as a robot in a scenario.

use std::fs::File;
use std::io;
use std::path::Path;

use mdle_record::{Begin, RecordFile, RecordedChange};
use mdle_runtime::{Nanos, Sensed, Turn, Twist};

use crate::drive::Exact;
use crate::log::LogEntry;
use crate::position::Texts;
use crate::record::{RecordWriter, UnmadeTurn};
use crate::supervised::Supervised;
use crate::transitions::Transitions;

/// The record of a robot, while it is being written. Each second of the run is written to the file when this second is
/// over.
pub struct RobotRecord(RecordWriter<RecordFile<File>>);

/// A turn, for the record of a robot.
pub struct RobotTurn<'a> {
    /// Number of the turn, counted from 0.
    pub number: u64,
    /// Time of the turn.
    pub t: Nanos,
    /// The output.
    pub y: &'a Sensed,
    /// The input that is sent to the robot after the turn.
    pub sent: Twist,
    /// Source of the input.
    pub kind: Turn<()>,
    /// The plan, and its state at the end of the turn; `None` if no plan has made the turn.
    pub plan: Option<(&'a dyn Texts, u64)>,
    /// Number of the plan, counting from 1 in the order in which plans have begun.
    pub plan_number: u64,
    /// Reason why the plan has replaced another plan in this turn; `None` if it has not.
    pub begins: Option<&'a str>,
    /// Transitions of the turn.
    pub transitions: &'a Transitions,
    /// Changes, other than the output, that influenced the turn.
    pub changes: Vec<RecordedChange>,
}

impl RobotRecord {
    /// Creates the file of a record, or truncates an existing file.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn create(path: &Path, begin: Begin) -> io::Result<Self> {
        Ok(Self(RecordWriter::new(RecordFile::new(File::create(path)?), begin, false)))
    }

    /// Writes a turn.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn turn(&mut self, turn: RobotTurn<'_>) -> io::Result<()> {
        let RobotTurn { number, t, y, sent, kind, plan, plan_number, begins, transitions, changes } = turn;
        let mut supervised = Supervised::default();
        supervised.note(None, begins);
        let supervised = &supervised;
        self.0.take(Some(Exact { y, asked: sent, sent }), changes);
        match plan {
            None => self.0.turn_without_plan(&UnmadeTurn { number, t, plan: plan_number, supervised }),
            Some((plan, state)) => self.0.turn(&LogEntry {
                plan,
                turn: number,
                t,
                state,
                kind,
                applied: None,
                frame: None,
                transitions,
                plan_number,
                supervised,
            }),
        }
    }

    /// Completes the record with the cause of the end at time `t`; `number` is the number of the last turn. If the
    /// record has no turns, it begins with the output `y`.
    ///
    /// # Errors
    /// Fails if the file cannot be written.
    pub fn end(mut self, number: u64, (y, t): (&Sensed, Nanos), cause: &str) -> io::Result<()> {
        self.0.begins(y)?;
        self.0.ended(number, t, cause)?;
        self.0.close()
    }
}
