//! A whole run: options, robot, turns, and the way out, on which the robot is stopped whatever has happened.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;

use clap::ArgMatches;
use mdle_runtime::{Plan, Robot};

use crate::arguments::{self, Options};
use crate::batch::{self, Batch, Terms};
use crate::clock::{Clock, Instants};
use crate::ending::{self, Ending, Fault, say};
use crate::held::Held;
use crate::log::{Log, Untouched};
use crate::progress::Progress;
use crate::report::Report;
use crate::safety::{Panicked, shielded};
use crate::signals::Signals;
use crate::turns::{self, Limits, Witnesses};
use crate::{Hosted, Pace, Refusal, Target, Time};

/// What a run meets outside the program; a test brings its own.
pub(crate) struct Surroundings<'e, I, O> {
    /// Where real time comes from.
    pub(crate) instants: I,
    /// The signals that end the run.
    pub(crate) signals: Signals,
    /// Opens standard output, once it is known how time passes (`None` for help).
    pub(crate) out: O,
    /// Standard error.
    pub(crate) err: &'e mut dyn Write,
    /// Where standard error is a terminal, the clock of the line that shows that a fast run goes on.
    pub(crate) seen: Option<Box<dyn FnMut() -> Duration + 'e>>,
}

/// Runs what `plan` makes on the robot of target `T` with these arguments, the program's own name first; the exit status.
pub(crate) fn session<'o, T: Target, P, I, O>(
    name: &str,
    arguments: impl IntoIterator<Item = OsString>,
    plan: &(impl Fn() -> P + Sync),
    surroundings: Surroundings<'_, I, O>,
) -> u8
where
    P: Plan<Output = <T::Robot as Robot>::Output, Input = <T::Robot as Robot>::Input>,
    I: Instants,
    O: FnOnce(Option<Time>) -> Box<dyn Write + 'o>,
{
    let Surroundings { instants, signals, out, err, seen } = surroundings;
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let matches = match arguments::command::<T>(name).try_get_matches_from(&arguments) {
        Ok(matches) => matches,
        Err(error) => return unparsed(&error, || out(None), err),
    };
    let options = arguments::options::<T>(&matches);
    let limits = Limits { timeout: options.timeout, turns: options.turns };
    match shielded(|| T::answer(&matches)).unwrap_or_else(bug_before) {
        Err(refusal) => return refusal.tell(err),
        Ok(Some(answer)) => return answered(&answer, &mut *out(None)),
        Ok(None) => {}
    }
    match batch::<T>(&matches, &options) {
        Err(refusal) => return refusal.tell(err),
        Ok(Some(batch)) => {
            signals.robot_runs();
            let program = arguments.first().map_or_else(|| name.into(), |program| program.to_string_lossy());
            let terms = Terms { period: options.period, limits, signals: &signals, program: &program };
            return several(&batch, plan, &terms, &mut *out(None), err, seen);
        }
        Ok(None) => {}
    }
    let Ready { mut robot, time, mut log } = match ready::<T>(&matches, &options) {
        Ok(ready) => ready,
        Err(refusal) => return refusal.tell(err),
    };
    signals.robot_runs();
    let screen = T::screen(&matches);
    let mut out = out(Some(time));
    if screen {
        out = Box::new(Held::new(out));
    }
    let mut report = Report::new(&mut *out, is_watched(time) && !screen);
    let mut clock = Clock::begin(instants, time, options.period);
    let ending = shielded(|| {
        let log = match &mut log {
            Ok(log) => log.as_mut(),
            Err(error) => return Ending::Log(error.to_string()),
        };
        let seen = seen.filter(|_| !screen && !is_watched(time));
        let (progress, err): (_, Option<&mut dyn Write>) = match seen {
            Some(now) => (Some(Progress::new(&mut *err, now)), None),
            None => (None, Some(&mut *err)),
        };
        let mut witnesses = Witnesses { report: &mut report, log, progress, err };
        turns::run(&mut robot, plan(), limits, &mut clock, &signals, &mut witnesses)
    });
    let status = way_out(&mut robot, ending.unwrap_or_else(bug), &mut report, log.ok().flatten(), err);
    // It stands, and all is said; even code that panics while it tidies up must not change the status.
    let _ = shielded(move || drop(robot));
    signals.robot_stands();
    if let Some(timing) = clock.timing() {
        say(err, format_args!("{timing}"));
    }
    if let Err(error) = report.close() {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}

/// The runs of a batch, if these options ask for several.
fn batch<T: Target>(matches: &ArgMatches, options: &Options) -> Result<Option<Batch<T::Robot>>, Refusal> {
    let batch = shielded(|| T::batch(matches, options.period)).unwrap_or_else(bug_before)?;
    if batch.is_some() && options.log.is_some() {
        let sentence = "--log writes down one run, and there are to be several: leave it out, or run one seed alone";
        return Err(Refusal::Usage(sentence.to_owned()));
    }
    Ok(batch)
}

/// Makes the runs of a batch and tells of them; the exit status.
fn several<'e, R: Hosted, P>(
    batch: &Batch<R>,
    plan: &(impl Fn() -> P + Sync),
    terms: &Terms<'_>,
    out: &mut dyn Write,
    err: &'e mut dyn Write,
    seen: Option<Box<dyn FnMut() -> Duration + 'e>>,
) -> u8
where
    P: Plan<Output = R::Output, Input = R::Input>,
{
    let progress = seen.map(|now| Progress::new(&mut *err, now));
    let (status, unwritten) = batch::run(batch, plan, terms, out, progress);
    if let Some(signal) = terms.signals.caught() {
        Ending::Signal(signal).tell(err);
    }
    if let Some(error) = unwritten.filter(|error| error.kind() != io::ErrorKind::BrokenPipe) {
        say(err, format_args!("warning: standard output could not be written: {error}"));
    }
    status
}

/// Prints help, or why the arguments are wrong; the exit status.
fn unparsed<'o>(error: &clap::Error, out: impl FnOnce() -> Box<dyn Write + 'o>, err: &mut dyn Write) -> u8 {
    if error.use_stderr() {
        say(err, format_args!("{}", error.render().to_string().trim_end()));
        return ending::USAGE;
    }
    answered(&error.render().to_string(), &mut *out())
}

/// Prints what was asked for instead of a run. Nobody has to read it to the end.
fn answered(answer: &str, out: &mut dyn Write) -> u8 {
    let _ = write!(out, "{answer}").and_then(|()| out.flush());
    ending::OVER
}

/// What a run needs before its first turn.
struct Ready<R> {
    robot: R,
    time: Time,
    /// A log that cannot begin is no refusal: the robot is there already, and has to be stopped.
    log: io::Result<Option<Log<File>>>,
}

/// Opens what a run needs. A start that is refused leaves the file of the log as it was.
fn ready<T: Target>(matches: &ArgMatches, options: &Options) -> Result<Ready<T::Robot>, Refusal> {
    let opened = shielded(|| {
        let time = T::time(matches).map_err(Refusal::Usage)?;
        let file = match &options.log {
            Some(path) => Some(Untouched::open(path).map_err(|error| no_log(path, &error))?),
            None => None,
        };
        let robot = T::connect(matches, options.period)?;
        let log = file.map(|file| file.begin(is_watched(time))).transpose();
        Ok(Ready { robot, time, log })
    });
    opened.unwrap_or_else(bug_before)
}

/// A panic before anything ran.
fn bug_before<T>(Panicked(message): Panicked) -> Result<T, Refusal> {
    Err(Refusal::Fault(format!("the robot's code panicked before it ran, which is a bug: {message}")))
}

/// Why there is no run log at `path`.
fn no_log(path: &Path, error: &io::Error) -> Refusal {
    Refusal::Usage(format!("the run log {} cannot be written: {error}", path.display()))
}

/// Whether somebody may be watching: at the fastest pace it matters more that writing is cheap.
fn is_watched(time: Time) -> bool {
    match time {
        Time::Wall | Time::Stepped(Pace::Times(_)) => true,
        Time::Stepped(Pace::Max) => false,
    }
}

/// A panic as an ending.
fn bug(Panicked(message): Panicked) -> Ending {
    Ending::Bug(message)
}

/// Stops the robot and says why the run ended, and what else went wrong; the exit status.
///
/// The null input is sent once more where the robot still listens, then the stop command in any case.
fn way_out<R: Hosted>(
    robot: &mut R,
    ending: Ending,
    report: &mut Report<'_>,
    log: Option<Log<File>>,
    err: &mut dyn Write,
) -> u8 {
    let mut faults = Vec::new();
    let mut orderly = ending.is_orderly();
    if ending.robot_listens() {
        let last = shielded(|| turns::exchange(robot, &R::Input::default()).map(drop));
        if let Err(fault) = last.unwrap_or_else(|panicked| Err(bug(panicked))) {
            orderly = fault.is_orderly();
            faults.push(Fault::Exchange(fault));
        }
    }
    let stopped = shielded(|| robot.stop().map_err(|fault| fault.to_string()));
    let stopped = stopped.unwrap_or_else(|Panicked(message)| Err(format!("its code panicked: {message}")));
    // Without a word on a broken log the reader of a short one would take it for a whole run.
    let logged = log.map_or(Ok(()), |mut log| log.flush());
    faults.extend(logged.err().filter(|_| !matches!(ending, Ending::Log(_))).map(Fault::Log));
    faults.extend(stopped.err().map(Fault::Stop));
    report.flush();
    // Before the robot finishes, which may take a while.
    ending.tell(err);
    if orderly {
        let finished = shielded(|| robot.finish());
        let finished = finished.unwrap_or_else(|Panicked(message)| Err(format!("a panic: {message}")));
        faults.extend(finished.err().map(Fault::Finish));
    }
    faults.iter().for_each(|fault| fault.tell(err));
    ending.status(&faults)
}
