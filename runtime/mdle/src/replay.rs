//! `mdle replay`: executes a recorded run again, and compares it with the record bit by bit.

use std::fs::File;
use std::io::{self, BufReader, IsTerminal as _, Read, Write as _};
use std::os::unix::fs::FileTypeExt as _;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use mdle_compiler::diagnostic::Sources;
use mdle_compiler::fsm::Machine;
use mdle_files::{Input, Target, read_plan};
use mdle_host::Clocked;
use mdle_record::{Begin, ReadError, Records};
use mdle_runtime::{Nanos, Printable};

use crate::arguments::Replay;
use crate::failure::{self, Failure};
use crate::messages::counted;
use crate::record::Record;
use crate::recorded_files;
use crate::replayed::{Difference, Parting, ReplayOutcome, ReplayTerms, replayed};
use crate::replayer::RecordedRun;
use crate::run_time::run_time;
use crate::session;
use crate::step::step;
use crate::targets;

/// Exit status for a run that differs from the record.
const DIFFERS: u8 = 1;
/// Maximum number of turns that are printed after the first difference.
const ROWS: usize = 20;

/// Executes a record again. Returns 0 if the run matches the record, and 1 if it differs or the record was changed.
///
/// # Errors
/// Fails if the record or the plan cannot be read.
pub(crate) fn replay(arguments: &Replay) -> Result<ExitCode, Failure> {
    let (begin, records) = record(&arguments.log)?;
    let linked = targets::of_record(&begin, &arguments.log)?;
    let target = Arc::new(mdle_files::target(Some(&begin.target))?);
    let call = format!("mdle replay {}", arguments.log.display());
    let (log, file) = (arguments.log.as_path(), arguments.plan.as_deref());
    let wanted = WantedPlan { log, file, begin: &begin, call: &call, has_run: false };
    let (machine, sources) = plan(&wanted, &target)?;
    let until = arguments.until.as_deref().map(run_time).transpose()?;
    let terms = ReplayTerms { until, goes_on: arguments.plan.is_some() };
    let mut replay = (linked.replay)(machine, &sources, &target, &begin, records, false)?;
    if arguments.steps {
        return stepped(arguments, &mut *replay, until);
    }
    let outcome = replayed(&mut *replay, terms)?;
    let plan = arguments.plan.as_ref().and_then(|plan| plan.file_name()).map(|name| name.to_string_lossy());
    tell(&outcome, plan.as_deref().unwrap_or_default()).map_err(|error| failure::unprinted(&error))?;
    match outcome {
        ReplayOutcome::Unread(_, error @ ReadError::System(_)) => Err(unread(&arguments.log, &error)),
        ReplayOutcome::Same { .. } => Ok(ExitCode::SUCCESS),
        ReplayOutcome::Differs(_) | ReplayOutcome::Unread(..) => Ok(ExitCode::from(DIFFERS)),
    }
}

/// Shows the turns of a record one by one.
fn stepped(
    Replay { log, commands, .. }: &Replay,
    run: &mut dyn RecordedRun,
    until: Option<Nanos>,
) -> Result<ExitCode, Failure> {
    let outcome = match commands {
        Some(path) => step(run, until, BufReader::new(session::opened(path)?), false)?,
        None if log == Path::new("-") => {
            let sentence = "the record and the commands cannot both come from standard input\nhelp: name a file of \
                            commands, as in `-c FILE`";
            return Err(Failure::Usage(sentence.to_owned()));
        }
        None => step(run, until, io::stdin().lock(), io::stdin().is_terminal())?,
    };
    Ok(ExitCode::from(if outcome.differs || outcome.is_refused { DIFFERS } else { 0 }))
}

/// Opens a record and reads its first entry.
///
/// # Errors
/// Fails if the file cannot be read, or is not a record.
pub(crate) fn record(log: &Path) -> Result<(Begin, Record), Failure> {
    let file = opened(log).map_err(|error| unread(log, &error))?;
    Records::open(BufReader::new(file)).map_err(|error| unread(log, &error))
}

fn unread(log: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Usage(format!("the record {} cannot be read: {error}", log.display()))
}

/// Opens a record, which may be a pipe; `-` is standard input.
fn opened(path: &Path) -> io::Result<Box<dyn Read>> {
    if path == Path::new("-") {
        return Ok(Box::new(io::stdin()));
    }
    let file = File::open(path)?;
    let kind = file.metadata()?.file_type();
    if kind.is_file() || kind.is_fifo() {
        return Ok(Box::new(file));
    }
    Err(io::Error::other("expected a file or a pipe"))
}

/// The plan with which a record is replayed.
pub(crate) struct WantedPlan<'a> {
    pub(crate) log: &'a Path,
    /// Path of the plan's file; `None` for the text in the record.
    pub(crate) file: Option<&'a Path>,
    pub(crate) begin: &'a Begin,
    /// The call without `--plan`, as messages show it.
    pub(crate) call: &'a str,
    /// `true` if the plan must be the plan that ran.
    pub(crate) has_run: bool,
}

/// Compiles the plan of a record, or the plan with the same name in a file.
///
/// # Errors
/// Fails if the plan cannot be read, has errors, or is not the plan of the record, or if the record does not
/// contain the plan's text.
pub(crate) fn plan(wanted: &WantedPlan<'_>, target: &Target) -> Result<(Machine, Sources), Failure> {
    let WantedPlan { log, file, begin, call, has_run } = *wanted;
    if begin.beside == Begin::MIDDLE {
        return Err(Failure::Usage(format!(
            "the record {} begins in the middle of a run, and its turns follow from those before it\n\
             help: `--log FILE.mcap` of a run records all turns; `mdle log` and `mdle plot` take this record too",
            log.display()
        )));
    }
    let Some(path) = file else {
        if begin.files.is_empty() {
            return Err(Failure::Usage(format!(
                "the record of an executable does not have the text of its plan\nhelp: name its file, as in `{call} --plan \
                 PLAN.mdle`"
            )));
        }
        return recorded_files::compiled(&begin.files, Some(&begin.plan), target);
    };
    let mut input = read_plan(path, target)?;
    input.must_have(&begin.plan).map_err(|error| Failure::OtherPlan(error.to_string()))?;
    let (plans, diagnostics) = input.compile(&target.alphabet, Some(&begin.plan));
    if has_run && let Some(difference) = difference(&input, begin) {
        return Err(Failure::OtherPlan(format!(
            "{} is not the plan that ran: {difference}\nhelp: leave `--plan` out: the record has the text of its plan; \
             `mdle replay {} --plan {0}` runs this one on the outputs of the record",
            path.display(),
            log.display()
        )));
    }
    let machine = recorded_files::only(plans, &diagnostics, &input.sources, Some(&begin.plan))?;
    Ok((machine, input.sources))
}

/// Returns a description of the first difference between the texts of a plan and the texts in the record; `None` if the
/// texts are the same.
fn difference(input: &Input, begin: &Begin) -> Option<String> {
    if begin.files.is_empty() {
        return None;
    }
    let mut recorded = begin.files.iter().map(|(_, text)| text);
    for (path, text) in input.files().zip(input.texts()) {
        let Some(recorded) = recorded.next() else { return Some(format!("it did not use {}", path.display())) };
        if text != recorded {
            let same = text.lines().zip(recorded.lines()).take_while(|(own, recorded)| own == recorded).count();
            return Some(format!("line {} of {} differs from the record", same + 1, path.display()));
        }
    }
    recorded.next().map(|_| "it uses fewer files".to_owned())
}

/// Prints the outcome of a replay; `plan` is the name of the plan.
fn tell(outcome: &ReplayOutcome, plan: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match outcome {
        ReplayOutcome::Same { turns, is_whole } => {
            let end = if *is_whole { "" } else { "; the record has no end" };
            writeln!(out, "the same to the bit, {}{end}", counted(*turns, "turn"))
        }
        ReplayOutcome::Differs(Difference { turn, t, parts, after }) => {
            writeln!(out, "turn {turn} at {} s differs", mdle_runtime::trace::Seconds(*t))?;
            parts.iter().try_for_each(|part| {
                let [name, recorded, replayed] = [&part.name, &part.recorded, &part.replayed].map(Printable);
                writeln!(out, "{name}\n  recorded: {recorded}\n  replayed: {replayed}")
            })?;
            out.write_all(side_by_side(after, plan).as_bytes())
        }
        ReplayOutcome::Unread(turns, error) => {
            writeln!(out, "the same to the bit, {}; then {error}", counted(*turns, "turn"))
        }
    }
}

/// Returns a table of the transitions from the first turn that differs. It shows the transitions of the record beside
/// those of the other plan; empty if there are no transitions.
fn side_by_side(after: &[Parting], plan: &str) -> String {
    if after.is_empty() {
        return String::new();
    }
    let recorded = |row: &Parting| Printable(row.recorded.join(", ")).to_string();
    let width = after.iter().take(ROWS).map(|row| recorded(row).chars().count()).max().unwrap_or(0).max(8);
    let mut text =
        "\nfrom here on the robot would have been somewhere else: its outputs stay those of the record\n\n".to_owned();
    let mut row = |t: &str, recorded: &str, other: &str| {
        let line = format!("{t:>9}  {recorded:<width$}  {other}");
        text += line.trim_end();
        text += "\n";
    };
    row("", "recorded", &Printable(plan).to_string());
    for parting in after.iter().take(ROWS) {
        let other = Printable(parting.replayed.join(", ")).to_string();
        row(&Clocked(parting.t).to_string(), &recorded(parting), &other);
    }
    if after.len() > ROWS {
        text += &format!("… and {} more turns with transitions\n", after.len() - ROWS);
    }
    text
}
