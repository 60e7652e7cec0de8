//! The record of a robot of a crowd.

use std::path::{Path, PathBuf};

use mdle_compiler::load::LoadedPlan;
use mdle_host::{RobotRecord, RobotTurn, Transitions};
use mdle_record::Begin;
use mdle_runtime::{Machine, Nanos, Sensed, Turn, Twist};

use super::super::records::{remove, unwritten};
use super::alphabet::CrowdAlphabet;

/// The record of a robot, while it is being written.
pub(super) struct RecordedMember {
    path: PathBuf,
    /// The open record; `None` once it is complete, or cannot be written.
    record: Option<RobotRecord>,
    /// Transitions of the turn.
    pub(super) transitions: Transitions,
    /// Number of the next turn.
    next: u64,
    /// Message about the error that ended the record; `None` if there was no error.
    fault: Option<String>,
}

impl RecordedMember {
    /// Creates the record of robot `number`. For the log `run.mcap`, the record of robot 17 is `run.17.mcap`.
    ///
    /// # Errors
    /// Fails with a message if the record cannot be written.
    pub(super) fn create(log: &Path, number: usize, begin: Begin) -> Result<Self, String> {
        let path = log.with_extension(format!("{number}.mcap"));
        let record = RobotRecord::create(&path, begin).map_err(|error| unwritten(&path, &error))?;
        Ok(Self { path, record: Some(record), transitions: Transitions::default(), next: 0, fault: None })
    }

    /// Writes a turn that `machine` has made at time `t` with the output `y`.
    pub(super) fn turn(
        &mut self,
        machine: &Machine<LoadedPlan<CrowdAlphabet>>,
        (y, t): (&Sensed, Nanos),
        turn: &Turn<Twist>,
    ) {
        let (kind, sent) = match turn {
            Turn::Law(input) => (Turn::Law(()), *input),
            Turn::Cut => (Turn::Cut, Twist::default()),
            Turn::Over => (Turn::Over, Twist::default()),
        };
        let Self { record, transitions, next, path, fault } = self;
        let plan = Some((machine.plan() as _, machine.state()));
        let (number, changes) = (*next, Vec::new());
        let (plan_number, begins) = (1, None);
        let recorded = RobotTurn { number, t, y, sent, kind, plan, plan_number, begins, transitions, changes };
        let written = record.as_mut().map_or(Ok(()), |record| record.turn(recorded));
        *next += 1;
        if let Err(error) = written {
            *record = None;
            *fault = Some(unwritten(path, &error));
        }
    }

    /// Removes the record of a run that cannot begin.
    pub(super) fn remove(self) {
        drop(self.record);
        remove(&self.path);
    }

    /// Completes the record with the output `y` at time `t` and the cause of the end. Has no effect if the record is
    /// already complete.
    pub(super) fn end(&mut self, (y, t): (&Sensed, Nanos), cause: &str) {
        let last = self.next.saturating_sub(1);
        let ended = self.record.take().map_or(Ok(()), |record| record.end(last, (y, t), cause));
        if let Err(error) = ended {
            self.fault = Some(unwritten(&self.path, &error));
        }
    }

    /// Returns the message about the error that ended the record; `None` if there was no error.
    pub(super) fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }
}
