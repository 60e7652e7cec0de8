//! A complete run: options, robot, turns, and the end, at which the robot is always stopped.

use std::ffi::OsString;
use std::io::{self, Write};
use std::time::Duration;

use clap::ArgMatches;
use mdle_record::Begin;
use mdle_runtime::{Nanos, PathStore};

use crate::answer::{print_answer, unparsed};
use crate::arguments::{self, Options};
use crate::call::Call;
use crate::clock::Clock;
use crate::cycle::Limits;
use crate::executable::Executable;
use crate::held_report::HeldReport;
use crate::instants::{Instants, nanos};
use crate::paths::{self, Recorder};
use crate::progress::Progress;
use crate::ready::{KnownFiles, Ready, bug_before, is_watched, ready};
use crate::report::Report;
use crate::required::{Required, scopes};
use crate::run_end::{RunEnd, RunFault, say};
use crate::runs::{self, Runs, Terms};
use crate::safety::shielded;
use crate::signals::Signals;
use crate::target_options::TargetOptions;
use crate::turn_watch::TurnWatch;
use crate::turns::{self, Witnesses};
use crate::{Pace, Program, Refusal, Time, watch, way_out};

/// Environment of a run: time, signals and output; tests provide their own.
pub(crate) struct Surroundings<'e, I, O> {
    /// Source of real time.
    pub(crate) instants: I,
    /// Signals that end the run.
    pub(crate) signals: Signals,
    /// Watchdog that limits the time of each turn.
    pub(crate) watch: TurnWatch,
    /// Function that opens standard output.
    pub(crate) out: O,
    /// Standard error.
    pub(crate) err: &'e mut dyn Write,
    /// Clock of the line that shows that a fast run goes on, if standard error is a terminal.
    pub(crate) elapsed: Option<Box<dyn FnMut() -> Duration + 'e>>,
}

/// Runs an executable with the call `call`; returns the exit status.
pub(crate) fn session<'o, I, O>(
    program: Program<'_>,
    call: Call,
    executable: &dyn Executable,
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    I: Instants,
    O: FnOnce() -> Box<dyn Write + 'o>,
{
    let Surroundings { mut instants, signals, watch, out, err, elapsed } = surroundings;
    let target = executable.target();
    let matches = match arguments::command(&target, program, &call).try_get_matches_from(call.arguments()) {
        Ok(matches) => matches,
        Err(error) => return unparsed(error, out, err),
    };
    let options = arguments::options(&target, &matches);
    let limits = Limits { timeout: options.timeout, turns: options.turns };
    match shielded(|| (target.answer)(&matches)).unwrap_or_else(bug_before) {
        Err(refusal) => return refusal.tell(err),
        Ok(Some(answer)) => return print_answer(&answer, &mut *out()),
        Ok(None) => {}
    }
    let PlanData { store, paths, required } = match prepared(&target, &matches, executable, call.later_path.as_deref())
    {
        Err(refusal) => return refusal.tell(err),
        Ok(prepared) => prepared,
    };
    match batch(executable, &matches, &options, store) {
        Err(refusal) => return refusal.tell(err),
        Ok(Some(batch)) => {
            // Nothing has to be stopped.
            signals.robot_runs(Time::Stepped(Pace::Max));
            signals.patience().stop_was_tried(None);
            let program = call.command(program.plan);
            let terms = Terms {
                period: options.period,
                limits,
                signals: &signals,
                watch: &watch,
                program: &program,
                required: &required,
            };
            return several(&batch, &terms, &mut *out(), err, elapsed);
        }
        Ok(None) => {}
    }
    let read = KnownFiles { read: &call.read, paths: &paths };
    let begin = Begin {
        version: if program.version.is_empty() { env!("CARGO_PKG_VERSION") } else { program.version }.to_owned(),
        target: target.name.to_owned(),
        plan: program.plan.to_owned(),
        command: call.repeating(program.plan),
        period: Nanos(nanos(options.period)),
        files: call.recorded.files.clone(),
        beside: call.recorded.beside.clone(),
        safety: call.recorded.safety.clone(),
    };
    let ready = ready(executable, &matches, &options, store, read, &signals, begin);
    let Ready { mut drive, time, mut log, mut path, mut views } = match ready {
        Ok(ready) => ready,
        Err(Refusal::Ended(stopped)) => return ended_at_the_start(&signals, stopped, err),
        Err(refusal) => {
            // A driver that refuses has stopped its robot, so the message is waited for.
            signals.patience().stop_was_tried(None);
            return refusal.tell(err);
        }
    };
    let screen = watch::is_asked_for(&matches);
    let mut out = out();
    if screen {
        out = Box::new(HeldReport::new(out));
    }
    let mut report = Report::new(&mut *out, is_watched(time) && !screen);
    if time == Time::Wall
        && let Err(refused) = instants.keep_time()
    {
        warn_of_lateness(&refused, call.words.first(), err);
    }
    let mut clock = Clock::begin(instants, time, options.period, drive.longest_gap());
    let watched = watch.run(time);
    let ending = shielded(|| {
        let log = match &mut log {
            Ok(log) => log.as_mut(),
            Err(error) => return RunEnd::Log(error.to_string()),
        };
        let elapsed = elapsed.filter(|_| !screen && !is_watched(time));
        let (progress, err): (_, Option<&mut dyn Write>) = match elapsed {
            Some(now) => (Some(Progress::new(&mut *err, now)), None),
            None => (None, Some(&mut *err)),
        };
        let path = path.as_mut().ok().and_then(Option::as_mut);
        let mut witnesses = Witnesses { report: &mut report, log, path, views: views.as_mut(), progress, err };
        turns::run(&mut *drive, limits, &mut clock, &signals, &mut witnesses, &watched)
    });
    let (ending, orderly, faults) = way_out::stop(&mut *drive, ending.unwrap_or_else(way_out::bug));
    // A view that panics must not keep the report from being written.
    let _ = shielded(|| views.iter_mut().for_each(|views| views.stopped(drive.sensed())));
    let ending = way_out::judge(&mut *drive, ending, &required, &mut report);
    let orderly = orderly && ending.is_orderly();
    signals.patience().stop_was_tried(Some(ending.status(&faults)));
    let files = way_out::Files {
        log: log.ok().flatten(),
        path: path.and_then(|path| path.map_or(Ok(()), Recorder::close)).err(),
        views,
    };
    let status = way_out::tell(&mut *drive, ending, orderly, faults, &mut report, files, err);
    // It stands, and all is said; even code that panics while it tidies up must not change the status.
    let _ = shielded(move || drop(drive));
    if let Some(timing) = clock.timing() {
        say(err, format_args!("{timing}"));
    }
    if let Err(error) = report.close() {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}

/// Warns about a permission that this computer does not give, and names the command that gives it.
fn warn_of_lateness(refused: &str, program: Option<&OsString>, err: &mut dyn Write) {
    let program = program.map_or_else(|| "FILE".into(), |program| program.to_string_lossy());
    say(
        err,
        format_args!(
            "warning: turns may be late when this computer is busy, as it does not permit {refused}; \
             `sudo setcap cap_sys_nice,cap_ipc_lock+ep {program}` permits it to this executable"
        ),
    );
}

/// Data of the plan that the options determine.
struct PlanData {
    /// Paths that the plan replays.
    store: PathStore,
    /// Names of these paths.
    paths: Vec<&'static str>,
    /// Causes by which the plan must end.
    required: Required,
}

/// Reads the paths that the plan replays, where the path with the name `later` may be missing, and the causes by which
/// the plan must end.
fn prepared(
    target: &TargetOptions,
    matches: &ArgMatches,
    executable: &dyn Executable,
    later: Option<&str>,
) -> Result<PlanData, Refusal> {
    let prepared = shielded(|| {
        let plan = executable.plan();
        let required = Required::of(matches, &*plan).map_err(Refusal::Usage)?;
        let laws = (0..).take(plan.fsm().atoms.len()).map(|atom| plan.law(atom));
        let texts: Vec<_> = laws.chain(scopes(plan.fsm()).map(|scope| plan.condition(scope))).collect();
        (target.accepts)(matches, &texts)?;
        let store = paths::load(target, matches, plan.paths(), later)?;
        Ok(PlanData { store, paths: plan.paths().to_vec(), required })
    });
    prepared.unwrap_or_else(bug_before)
}

/// Returns the runs of a batch if the options request several runs.
fn batch<'p>(
    executable: &'p dyn Executable,
    matches: &ArgMatches,
    options: &Options,
    store: PathStore,
) -> Result<Option<Runs<'p>>, Refusal> {
    let batch = shielded(|| executable.batch(matches, options.period, store)).unwrap_or_else(bug_before)?;
    let alone =
        [("--log", &options.log), ("--record-path", &options.path)].into_iter().find(|(_, file)| file.is_some());
    if let (Some(_), Some((option, _))) = (&batch, alone) {
        return Err(Refusal::Usage(format!(
            "{option} writes down one run, and there are to be several: leave it out, or run one seed alone"
        )));
    }
    Ok(batch)
}

/// Makes the runs of a batch and reports them; returns the exit status.
fn several<'e>(
    batch: &Runs<'_>,
    terms: &Terms<'_>,
    out: &mut dyn Write,
    err: &'e mut dyn Write,
    elapsed: Option<Box<dyn FnMut() -> Duration + 'e>>,
) -> u8 {
    let progress = elapsed.map(|now| Progress::new(&mut *err, now));
    let (status, unwritten) = runs::run(batch, terms, out, progress);
    if let Some(signal) = terms.signals.caught() {
        RunEnd::Signal(signal).tell(true, err);
    }
    if let Some(error) = unwritten.filter(|error| error.kind() != io::ErrorKind::BrokenPipe) {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}

/// Reports that a signal ended the run while the robot was being opened; returns the exit status.
fn ended_at_the_start(signals: &Signals, stopped: Result<(), String>, err: &mut dyn Write) -> u8 {
    let Some(signal) = signals.caught() else {
        signals.patience().stop_was_tried(None);
        return Refusal::Fault("the robot's code ended the start, and nothing asked for that".to_owned()).tell(err);
    };
    let ending = RunEnd::Signal(signal);
    let faults: Vec<RunFault> = stopped.err().map(RunFault::Stop).into_iter().collect();
    signals.patience().stop_was_tried(Some(ending.status(&faults)));
    ending.tell(faults.is_empty(), err);
    faults.iter().for_each(|fault| fault.tell(faults.is_empty(), err));
    ending.status(&faults)
}
