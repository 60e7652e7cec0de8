//! Connects to the robot and opens the files before the first turn of a run. The order of these steps ensures that all
//! files are unchanged if the run cannot start.

use std::io;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use mdle_record::Begin;
use mdle_runtime::PathStore;

use crate::arguments::SharedOptions;
use crate::drive::Drive;
use crate::executable::Executable;
use crate::log::UnchangedFile;
use crate::paths::{self, PathRecording};
use crate::record::RecordWriter;
use crate::run_log::{Format, RunLog, is_record};
use crate::safety::{Panicked, shielded};
use crate::signals::Signals;
use crate::target_options::TargetOptions;
use crate::views::{self, ByOdometry};
use crate::{NamedFile, Pace, Refusal, Time, named_file};

/// A connected robot and open files, ready for the first turn of a run.
pub(crate) struct Ready<'p> {
    /// Connected robot, with the plan that drives it.
    pub(crate) drive: Box<dyn Drive + 'p>,
    /// Source of the time of the turns.
    pub(crate) time: Time,
    /// Log of the run, or the error that prevents it. The run is not refused because of this error, because the robot
    /// is already connected and must be stopped.
    pub(crate) log: io::Result<Option<RunLog>>,
    /// Recorder of the driven path; `None` if the path is not recorded.
    pub(crate) path: io::Result<Option<PathRecording>>,
    /// Views by odometry; `None` if the options do not request them.
    pub(crate) views: Option<ByOdometry>,
}

/// Connects to the robot and opens the files of a run. If the run cannot start, the files are left unchanged.
pub(crate) fn ready<'p>(
    executable: &'p dyn Executable,
    matches: &ArgMatches,
    options: &SharedOptions,
    store: PathStore,
    plan: KnownFiles<'_>,
    signals: &Signals,
    begin: Begin,
) -> Result<Ready<'p>, Refusal> {
    let target = executable.target();
    let opened = shielded(|| {
        let time = (target.time)(matches).map_err(Refusal::Usage)?;
        named_file::check(named_files(&target, matches, options, plan))?;
        check_record(&target, options)?;
        let log = untouched("run log", options.log.as_deref())?;
        let path = untouched("path", options.path.as_deref())?;
        let views = views::by_odometry(&target, matches, signals.patience())?;
        if options.path.is_some() {
            paths::check_period(options.period)?;
        }
        // From here on, a signal must not end the program before the robot is stopped.
        signals.robot_runs(time);
        let drive = executable.connect(matches, options.period, &signals.stop_request(), store)?;
        let log = log.map(|file| begun(file, options, begin, is_watched(time), signals)).transpose();
        let path = path.map(|file| file.emptied(signals.patience()).map(PathRecording::new)).transpose();
        Ok(Ready { drive, time, log, path, views })
    });
    opened.unwrap_or_else(bug_before)
}

/// Files that a run reads for its plan.
#[derive(Clone, Copy)]
pub(crate) struct KnownFiles<'a> {
    /// Files that the program has read for the plan.
    pub(crate) read: &'a [PathBuf],
    /// Names of the paths that the plan replays.
    pub(crate) paths: &'a [&'static str],
}

/// Returns all files that the options of a run name.
fn named_files(
    target: &TargetOptions,
    matches: &ArgMatches,
    options: &SharedOptions,
    plan: KnownFiles<'_>,
) -> Vec<NamedFile> {
    let written = [("--log", &options.log), ("--record-path", &options.path)];
    let written = written
        .into_iter()
        .filter_map(|(option, path)| path.clone().map(|path| NamedFile { option, path, is_written: true }));
    let read = paths::files(matches, plan.paths).chain(plan.read.iter().cloned()).map(|path| NamedFile {
        option: "the plan",
        path,
        is_written: false,
    });
    written.chain(views::files(matches)).chain(read).chain((target.files)(matches)).collect()
}

/// Checks the options for the log. Fails for a log without a file name, and for a record if a record cannot contain the
/// outputs or inputs of the robot.
fn check_record(target: &TargetOptions, options: &SharedOptions) -> Result<(), Refusal> {
    if options.log.as_deref() == Some(Path::new("-")) {
        let sentence = "--log -: expected the name of a file; `--log /dev/stdout` writes JSON lines to standard output";
        return Err(Refusal::Usage(sentence.to_owned()));
    }
    let Some(path) = options.log.as_deref().filter(|path| !target.records && is_record(path)) else { return Ok(()) };
    let (path, lines) = (path.display(), path.with_extension("jsonl"));
    Err(Refusal::Usage(format!(
        "--log {path}: the robot {} has outputs or inputs of a type of its own, which a record does not have; `--log {}` \
         writes a log of JSON lines",
        target.name,
        lines.display()
    )))
}

/// Begins the log; the file's name determines the format.
fn begun(
    file: UnchangedFile<'_>,
    options: &SharedOptions,
    begin: Begin,
    prompt: bool,
    signals: &Signals,
) -> io::Result<RunLog> {
    let format = if options.log.as_deref().is_some_and(is_record) {
        Format::Record(Box::new(RecordWriter::new(file.recorded(signals.patience())?, begin, prompt)))
    } else {
        Format::Lines(file.begin(prompt, signals.patience())?)
    };
    Ok(RunLog::new(format, options.log_best_effort))
}

/// Opens the file at `path`, which the run will write later, and leaves it unchanged. Returns `None` if there is no
/// path. Error messages call the file `what`.
fn untouched<'p>(what: &str, path: Option<&'p Path>) -> Result<Option<UnchangedFile<'p>>, Refusal> {
    let refused =
        |path: &Path, error| Refusal::Usage(format!("the {what} {} cannot be written: {error}", path.display()));
    path.map(|path| UnchangedFile::open(path).map_err(|error| refused(path, error))).transpose()
}

/// Converts a panic that happened before the run to a refusal.
pub(crate) fn bug_before<T>(Panicked(message): Panicked) -> Result<T, Refusal> {
    Err(Refusal::Fault(format!("the robot's code panicked before it ran, which is a bug: {message}")))
}

/// Returns `false` if the run has the fastest pace. At other paces, a person may be watching the run; at the fastest
/// pace, fast writing is more important.
pub(crate) fn is_watched(time: Time) -> bool {
    match time {
        Time::Wall | Time::Stepped(Pace::Times(_)) => true,
        Time::Stepped(Pace::Max) => false,
    }
}
