//! The records of the robots in a scenario. Each robot has its own file, in the same format as the record of any other
//! run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use mdle_host::{RobotRecord, RobotTurn, Target as _};
use mdle_record::Begin;
use mdle_runtime::{Nanos, Plan, Sensed};
use mdle_sim::Sim;

use super::setup::{Scenario, ScenarioRobot};

/// The records that are being written.
pub(super) struct ScenarioRecords(Vec<MemberRecord>);

/// The record of a robot.
struct MemberRecord {
    /// Name of the robot.
    robot: String,
    path: PathBuf,
    /// The open record; `None` once it is complete.
    record: Option<RobotRecord>,
    /// Number of the last turn.
    turn: u64,
}

impl ScenarioRecords {
    /// Creates the records of a scenario. For the log `run.mcap`, the record of the robot `ada` is `run.ada.mcap`.
    /// `command` is the command that repeats the run.
    ///
    /// # Errors
    /// Fails with a message if a record cannot be written; in this case, the records that were created are removed.
    pub(super) fn create(log: &Path, scenario: &Scenario, command: &str) -> Result<Self, String> {
        let mut created = Self(Vec::new());
        for member in &scenario.members {
            let path = log.with_extension(format!("{}.mcap", member.name));
            match RobotRecord::create(&path, of_member(member, scenario, command)) {
                Ok(record) => {
                    created.0.push(MemberRecord { robot: member.name.clone(), path, record: Some(record), turn: 0 });
                }
                Err(error) => {
                    created.remove();
                    return Err(unwritten(&path, &error));
                }
            }
        }
        Ok(created)
    }

    /// Removes the records of a run that cannot begin.
    pub(super) fn remove(self) {
        for MemberRecord { path, record, .. } in self.0 {
            drop(record);
            remove(&path);
        }
    }

    /// Writes a turn of a robot.
    ///
    /// # Errors
    /// Fails with a message if the record cannot be written.
    pub(super) fn turn(&mut self, robot: &str, turn: RobotTurn<'_>) -> Result<(), String> {
        let number = turn.number;
        self.write(robot, |record, last| {
            *last = number;
            record.as_mut().map_or(Ok(()), |record| record.turn(turn))
        })
    }

    /// Completes the record of a robot with the output `y` at time `t` and the cause of the end. Has no effect if the
    /// record is already complete.
    ///
    /// # Errors
    /// Fails with a message if the record cannot be written.
    pub(super) fn end(&mut self, robot: &str, (y, t): (&Sensed, Nanos), cause: &str) -> Result<(), String> {
        self.write(robot, |record, last| record.take().map_or(Ok(()), |record| record.end(*last, (y, t), cause)))
    }

    fn write(
        &mut self,
        robot: &str,
        write: impl FnOnce(&mut Option<RobotRecord>, &mut u64) -> io::Result<()>,
    ) -> Result<(), String> {
        let member = self.0.iter_mut().find(|member| member.robot == robot);
        let Some(MemberRecord { path, record, turn, .. }) = member else { return Ok(()) };
        write(record, turn).map_err(|error| unwritten(path, &error))
    }
}

/// Removes the file of a record that does not contain a run.
pub(super) fn remove(path: &Path) {
    // Best effort: the error that prevented the run is reported instead.
    let _ = fs::remove_file(path);
}

/// Returns the error message for a file that cannot be written.
pub(super) fn unwritten(path: &Path, error: &io::Error) -> String {
    format!("{} cannot be written: {error}", path.display())
}

/// Returns the first entry of a robot's record.
fn of_member(member: &ScenarioRobot, scenario: &Scenario, command: &str) -> Begin {
    let ScenarioRobot { loaded, files, records, .. } = member;
    let plan = loaded.plan();
    let period = Nanos(u64::try_from(scenario.period.as_nanos()).unwrap_or(u64::MAX));
    let parts = [
        (!plan.reads().is_empty(), "modules"),
        (!plan.robots().is_empty(), "the state link"),
        (records.is_some(), "recorded paths"),
    ];
    let beside: Vec<_> = parts.into_iter().filter_map(|(is_there, words)| is_there.then_some(words)).collect();
    Begin { beside: beside.join(" and "), ..begin(&plan, files, command, period) }
}

/// Returns the first entry of a robot's record. `command` is the command that repeats the run.
pub(super) fn begin(plan: &impl Plan, files: &[(String, String)], command: &str, period: Nanos) -> Begin {
    Begin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        target: Sim::NAME.to_owned(),
        plan: plan.name(0).to_owned(),
        command: command.to_owned(),
        period,
        files: files.to_vec(),
        ..Begin::default()
    }
}
