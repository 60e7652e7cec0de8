//! `mdle log export --csv`: writes the turns of a record as a table.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mdle_record::{Message, MessageKind, RecordedTurn};
use mdle_runtime::SONARS;
use mdle_runtime::trace::Seconds;

use super::{created, damaged, unwritten};
use crate::failure::{self, Failure};
use crate::replay;

/// Writes the turns of a record as CSV to a file, or to standard output.
///
/// # Errors
/// Fails if the record cannot be read, or if the table cannot be written.
pub(super) fn export(log: &Path, file: Option<&Path>) -> Result<ExitCode, Failure> {
    let (_, records) = replay::record(log)?;
    let mut table = TableWriter::created(file)?;
    table.write(&head())?;
    let mut outcome = Ok(ExitCode::SUCCESS);
    for turn in records.with_messages() {
        match turn {
            Ok((turn, messages)) => table.write(&line(&turn, &messages))?,
            Err(error) => {
                outcome = damaged(log, &error);
                break;
            }
        }
    }
    table.close()?;
    outcome
}

/// Writer of lines to a file or to standard output.
pub(super) struct TableWriter {
    out: Box<dyn Write>,
    /// Path of the file; `None` means standard output.
    file: Option<PathBuf>,
}

impl TableWriter {
    /// Creates `file`, which must not exist yet; `None` means standard output.
    ///
    /// # Errors
    /// Fails if the file cannot be created.
    pub(super) fn created(file: Option<&Path>) -> Result<Self, Failure> {
        let out: Box<dyn Write> = match file {
            Some(file) => Box::new(BufWriter::new(created(file)?)),
            None => Box::new(BufWriter::new(io::stdout().lock())),
        };
        Ok(Self { out, file: file.map(Path::to_owned) })
    }

    /// Writes a line and a line break.
    ///
    /// # Errors
    /// Fails if the system cannot write the line.
    pub(super) fn write(&mut self, line: &str) -> Result<(), Failure> {
        self.out.write_all(line.as_bytes()).map_err(|error| self.failed(&error))
    }

    /// Writes all buffered lines.
    ///
    /// # Errors
    /// Fails if the system cannot write the lines.
    pub(super) fn close(mut self) -> Result<(), Failure> {
        self.out.flush().map_err(|error| self.failed(&error))
    }

    fn failed(&self, error: &io::Error) -> Failure {
        match &self.file {
            Some(file) => unwritten(&file.display(), error),
            None => failure::unprinted(error),
        }
    }
}

/// Returns the header line of the table; columns are in SI units.
fn head() -> String {
    let mut line = "turn,t,plan,state,x,y,theta,v,omega,bumpers,battery".to_owned();
    for sonar in 0..SONARS {
        let _ = write!(line, ",r{sonar}");
    }
    line + ",sent_v,sent_omega,transitions\n"
}

/// Returns the line of a turn. The range of a sonar is empty before its first ping, and `inf` without an echo.
fn line(turn: &RecordedTurn, messages: &[Message]) -> String {
    let RecordedTurn { number, t, y, sent, plan, state, .. } = turn;
    let pose = y.odometry;
    let mut line = format!(
        "{number},{},{plan},{state},{},{},{},{},{},{},{}",
        Seconds(*t),
        pose.x.0,
        pose.y.0,
        pose.theta.0,
        y.velocity.v.0,
        y.velocity.omega.0,
        y.switches,
        y.supply.battery.0
    );
    for pings in &y.pings {
        line += ",";
        if let Some(ping) = pings.newest_first().next() {
            line += &ping.range.map_or_else(|| "inf".to_owned(), |range| range.0.to_string());
        }
    }
    let causes = messages.iter().filter(|message| message.kind == MessageKind::Transition).filter_map(cause);
    let causes = causes.collect::<Vec<_>>().join("; ");
    let _ = writeln!(line, ",{},{},{}", sent.v.0, sent.omega.0, quoted(&causes));
    line
}

/// Returns the cause of a transition, with its values and its position in the plan; `None` for any other message.
fn cause(message: &Message) -> Option<String> {
    let transition: serde_json::Value = serde_json::from_str(&message.json).ok()?;
    transition.get("cause")?.as_str().map(str::to_owned)
}

/// Returns `text` as a CSV field, in quotes if necessary.
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
