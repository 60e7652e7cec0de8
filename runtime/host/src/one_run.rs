//! The run of one robot: connects to the robot, makes its turns, and always stops it.

use std::ffi::OsString;
use std::io::Write;
use std::time::Duration;

use mdle_record::Begin;
use mdle_runtime::Nanos;

use crate::clock::Clock;
use crate::drive::Drive;
use crate::executable::Executable;
use crate::held_report::HeldReport;
use crate::instants::{Instants, nanos};
use crate::paths::PathRecording;
use crate::progress::ProgressLine;
use crate::ready::{KnownFiles, Ready, is_watched, ready};
use crate::report::ReportWriter;
use crate::required::Required;
use crate::run_end::{RunEnd, RunFault, say};
use crate::safety::shielded;
use crate::signals::Signals;
use crate::surroundings::{PlanData, RunSettings, Surroundings};
use crate::turns::{self, Witnesses};
use crate::{Refusal, Time, watch, way_out};

/// Connects to the robot, opens the files, makes the turns, and stops the robot; returns the exit status.
pub(crate) fn one_run<'o, I, O>(
    executable: &dyn Executable,
    settings: &RunSettings<'_>,
    plan: &PlanData,
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    I: Instants,
    O: FnOnce() -> Box<dyn Write + 'o>,
{
    let RunSettings { matches, options, call, .. } = settings;
    let read = KnownFiles { read: &call.read, paths: &plan.paths };
    let begin = begin(settings, executable.target().name);
    match ready(executable, matches, options, plan.store, read, &surroundings.signals, begin) {
        Ok(ready) => driven(ready, settings, &plan.required, surroundings),
        Err(Refusal::Ended(stopped)) => ended_at_the_start(&surroundings.signals, stopped, surroundings.err),
        Err(refusal) => {
            // A driver that refuses has already stopped its robot, so the program can wait until the message is read.
            surroundings.signals.patience().stop_was_tried(None);
            refusal.tell(surroundings.err)
        }
    }
}

/// Returns the data of a run that a record contains before the first turn.
fn begin(settings: &RunSettings<'_>, target: &str) -> Begin {
    let RunSettings { program, call, options, .. } = settings;
    let version = if program.version.is_empty() { env!("CARGO_PKG_VERSION") } else { program.version };
    Begin {
        version: version.to_owned(),
        target: target.to_owned(),
        plan: program.plan.to_owned(),
        command: call.repeating(program.plan),
        period: Nanos(nanos(options.period)),
        files: call.recorded.files.clone(),
        beside: call.recorded.beside.clone(),
        safety: call.recorded.safety.clone(),
    }
}

/// Makes the turns of a connected robot, stops it, and reports why the run ended; returns the exit status.
fn driven<'o, I, O>(
    mut ready: Ready<'_>,
    settings: &RunSettings<'_>,
    required: &Required,
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    I: Instants,
    O: FnOnce() -> Box<dyn Write + 'o>,
{
    let Surroundings { mut instants, signals, watch, out, err, elapsed } = surroundings;
    let (time, period) = (ready.time, settings.options.period);
    let screen = watch::is_asked_for(settings.matches);
    let mut out = out();
    if screen {
        out = Box::new(HeldReport::new(out));
    }
    let mut report = ReportWriter::new(&mut *out, is_watched(time) && !screen);
    if time == Time::Wall
        && let Err(refused) = instants.keep_time()
    {
        warn_of_lateness(&refused, settings.call.words.first(), err);
    }
    let mut clock = Clock::begin(instants, time, period, ready.drive.longest_gap());
    let watched = watch.run(time);
    let elapsed = elapsed.filter(|_| !screen && !is_watched(time));
    let ending = shielded(|| {
        with_witnesses(&mut ready, &mut report, err, elapsed, |drive, witnesses| {
            turns::run(drive, settings.limits(), &mut clock, &signals, witnesses, &watched)
        })
    });
    let status = end(ready, ending.unwrap_or_else(way_out::bug), required, &signals, &mut report, err);
    if let Some(timing) = clock.timing() {
        say(err, format_args!("{timing}"));
    }
    if let Err(error) = report.close() {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}

/// Calls `run` with the robot and the recipients of the reports of its turns. A progress line is shown if its clock,
/// `elapsed`, is given.
fn with_witnesses<'e>(
    ready: &mut Ready<'_>,
    report: &mut ReportWriter<'_>,
    err: &'e mut dyn Write,
    elapsed: Option<Box<dyn FnMut() -> Duration + 'e>>,
    run: impl FnOnce(&mut dyn Drive, &mut Witnesses<'_, '_>) -> RunEnd,
) -> RunEnd {
    let log = match &mut ready.log {
        Ok(log) => log.as_mut(),
        Err(error) => return RunEnd::Log(error.to_string()),
    };
    let (progress, err): (_, Option<&mut dyn Write>) = match elapsed {
        Some(now) => (Some(ProgressLine::new(err, now)), None),
        None => (None, Some(err)),
    };
    let path = ready.path.as_mut().ok().and_then(Option::as_mut);
    let mut witnesses = Witnesses { report, log, path, views: ready.views.as_mut(), progress, err };
    run(&mut *ready.drive, &mut witnesses)
}

/// Stops the robot, closes the files, and reports why the run ended; returns the exit status.
fn end(
    ready: Ready<'_>,
    ending: RunEnd,
    required: &Required,
    signals: &Signals,
    report: &mut ReportWriter<'_>,
    err: &mut dyn Write,
) -> u8 {
    let Ready { mut drive, log, path, mut views, .. } = ready;
    let (ending, orderly, faults) = way_out::stop(&mut *drive, ending);
    // A panic in a view must not prevent the report.
    let _ = shielded(|| views.iter_mut().for_each(|views| views.stopped(drive.sensed())));
    let ending = way_out::judge(&mut *drive, ending, required, report);
    let orderly = orderly && ending.is_orderly();
    signals.patience().stop_was_tried(Some(ending.status(&faults)));
    let files = way_out::EndFiles {
        log: log.ok().flatten(),
        path: path.and_then(|path| path.map_or(Ok(()), PathRecording::close)).err(),
        views,
    };
    let status = way_out::tell(&mut *drive, ending, orderly, faults, report, files, err);
    // The robot is stopped and the report is complete: a panic during the cleanup must not change the status.
    let _ = shielded(move || drop(drive));
    status
}

/// Warns that turns may be late because the system does not give a permission; names the command that gives it.
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

/// Reports that a signal ended the run while the program connected to the robot; returns the exit status.
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
