//! Several runs of one plan, with robots that differ only in their seeds. Several threads make the runs, and the
//! results are reported in the order of the seeds.
//!
//! The result of a run depends neither on its thread nor on simultaneous runs: each run has its own robot, clock and
//! plan.

use std::io::Write;
use std::num::{NonZeroU64, NonZeroUsize};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread;
use std::time::Duration;

use mdle_runtime::{Nanos, PrintableLines};

use crate::clock::Clock;
use crate::cycle::RunLimits;
use crate::drive::Drive;
use crate::instants::Instants;
use crate::outcome::{EndedRun, RunOutcome};
use crate::progress::ProgressLine;
use crate::report::ReportWriter;
use crate::required::Required;
use crate::run_end::RunEnd;
use crate::safety::{Panicked, shielded};
use crate::signals::Signals;
use crate::summary::Summary;
use crate::turn_watch::TurnWatch;
use crate::turns::{self, Witnesses};
use crate::{Batch, Judgement, Pace, Time};

/// Time limit for runs that no option limits, so that no batch continues forever.
const TIMEOUT: Duration = Duration::from_secs(3600);

/// Runs of a [`Batch`], without the type of its robots.
pub(crate) struct BatchRuns<'p> {
    first: u64,
    runs: NonZeroU64,
    jobs: NonZeroUsize,
    json: bool,
    /// Function that creates the robot for a seed, with the plan that drives it; the error is the reason why the robot
    /// could not be created.
    drive: Box<dyn Fn(u64) -> Prepared<'p> + Send + Sync + 'p>,
    alone: Box<dyn Fn(u64) -> Vec<String> + Send + Sync>,
}

/// A robot with its plan before the first exchange, or the reason why the robot could not be created.
pub(crate) type Prepared<'p> = Result<Box<dyn Drive + 'p>, String>;

impl<'p> BatchRuns<'p> {
    /// Creates the runs of `batch`; `drive` adds a pilot to each robot.
    pub(crate) fn of<R: 'p>(batch: Batch<R>, drive: impl Fn(R) -> Prepared<'p> + Send + Sync + 'p) -> Self {
        let Batch { first, runs, jobs, json, robot, alone } = batch;
        Self { first, runs, jobs, json, drive: Box::new(move |seed| robot(seed).and_then(&drive)), alone }
    }
}

/// Settings that all runs share.
pub(crate) struct CommonTerms<'a> {
    pub(crate) period: Duration,
    pub(crate) limits: RunLimits,
    pub(crate) signals: &'a Signals,
    /// Watchdog that limits the time of each turn.
    pub(crate) watch: &'a TurnWatch,
    /// Command line of the program before its options, as typed in a shell.
    pub(crate) program: &'a str,
    /// Causes by which the plan must end.
    pub(crate) required: &'a Required,
}

impl CommonTerms<'_> {
    /// Returns the default time limit; `None` if an option limits the runs.
    fn by_default(&self) -> Option<Duration> {
        (self.limits.timeout.is_none() && self.limits.turns.is_none()).then_some(TIMEOUT)
    }
}

/// Makes the runs and reports them. Returns the exit status, and the error if writing to `out` failed.
pub(crate) fn run(
    batch: &BatchRuns<'_>,
    terms: &CommonTerms<'_>,
    out: &mut dyn Write,
    mut progress: Option<ProgressLine<'_>>,
) -> (u8, Option<std::io::Error>) {
    let mut runs = Vec::new();
    let next = AtomicU64::new(0);
    thread::scope(|scope| {
        let (sender, done) = channel();
        let jobs = batch.jobs.get().min(usize::try_from(batch.runs.get()).unwrap_or(usize::MAX));
        for _ in 0..jobs {
            let sender = sender.clone();
            scope.spawn(|| work(batch, terms, &next, sender));
        }
        drop(sender);
        for run in done {
            runs.push(run);
            if let Some(progress) = &mut progress {
                progress.runs(runs.len() as u64, batch.runs.get());
            }
        }
    });
    drop(progress);
    runs.sort_by_key(|run: &EndedRun| run.seed.wrapping_sub(batch.first));
    let summary = Summary {
        runs: &runs,
        asked: batch.runs.get(),
        first: batch.first,
        alone: &*batch.alone,
        timeout: terms.by_default(),
        program: terms.program,
    };
    let written =
        if batch.json { writeln!(out, "{}", summary.json()) } else { write!(out, "{}", PrintableLines(&summary)) };
    let status = match terms.signals.caught() {
        Some(signal) => 128 + signal.number(),
        None => summary.status(),
    };
    (status, written.and_then(|()| out.flush()).err())
}

/// Makes runs until no run is left or a signal arrives.
fn work(batch: &BatchRuns<'_>, terms: &CommonTerms<'_>, next: &AtomicU64, done: Sender<EndedRun>) {
    loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        if number >= batch.runs.get() || terms.signals.caught().is_some() {
            return;
        }
        let seed = batch.first.wrapping_add(number);
        // The receiver exists until all threads have ended, so sending cannot fail.
        let Some(run) = one(batch, seed, terms) else { return };
        let _ = done.send(run);
    }
}

/// Makes the run with this seed. Returns `None` if a signal interrupted the run.
fn one(batch: &BatchRuns<'_>, seed: u64, terms: &CommonTerms<'_>) -> Option<EndedRun> {
    let mut run = EndedRun { seed, outcome: RunOutcome::Ended, t: Nanos::ZERO, over: None, contacts: 0 };
    let mut drive = match shielded(|| (batch.drive)(seed)).unwrap_or_else(panicked) {
        Ok(drive) => drive,
        Err(sentence) => return Some(EndedRun { outcome: RunOutcome::Failed(sentence), ..run }),
    };
    let mut clock = Clock::begin(StoppedClock, Time::Stepped(Pace::Max), terms.period, None);
    let mut nobody = std::io::sink();
    let mut over = None;
    let limits = RunLimits { timeout: terms.limits.timeout.or(terms.by_default()), ..terms.limits };
    let watched = terms.watch.run(Time::Stepped(Pace::Max));
    let ending = shielded(|| {
        let mut report = ReportWriter::new(&mut nobody, false);
        let mut witnesses =
            Witnesses { report: &mut report, log: None, path: None, views: None, progress: None, err: None };
        let ending = turns::run(&mut *drive, limits, &mut clock, terms.signals, &mut witnesses, &watched);
        over = witnesses.report.over().cloned();
        ending
    });
    run.t = clock.taken();
    let stopped = shielded(|| {
        if ending.as_ref().is_ok_and(RunEnd::robot_listens) {
            let _ = drive.release();
        }
        drive.stop()
    });
    let failure = stopped.unwrap_or_else(panicked).err();
    run.outcome = match ending {
        Ok(RunEnd::Signal(_)) => return None,
        Err(panic) => RunOutcome::Failed(panicked::<()>(panic).err().unwrap_or_default()),
        Ok(
            RunEnd::Unstarted(fault)
            | RunEnd::Robot(fault)
            | RunEnd::Unstopped(fault)
            | RunEnd::Log(fault)
            | RunEnd::Overrun(fault)
            | RunEnd::Pilot(fault)
            | RunEnd::Failed(fault)
            | RunEnd::Bug(fault),
        ) => RunOutcome::Failed(fault),
        Ok(RunEnd::Safety(rule)) => RunOutcome::Failed(format!("the safety rules ended it: {rule}")),
        Ok(RunEnd::Quit) => RunOutcome::Failed("it was asked to end".to_owned()),
        Ok(RunEnd::Suspended { .. }) => RunOutcome::Failed("it went without a command".to_owned()),
        Ok(_) if failure.is_some() => RunOutcome::Failed(failure.unwrap_or_default()),
        Ok(RunEnd::Timeout(_) | RunEnd::Turns(_)) => RunOutcome::TimedOut,
        Ok(RunEnd::Over | RunEnd::Otherwise(_)) => {
            run.over = over;
            match shielded(|| Ok(drive.observer().and_then(|observer| observer.judged()))).unwrap_or_else(panicked) {
                Err(panic) => RunOutcome::Failed(panic),
                Ok(_) if run.over.as_ref().is_some_and(|over| !terms.required.allows(over)) => RunOutcome::Otherwise,
                Ok(None) => RunOutcome::Ended,
                Ok(Some(Judgement::Arrived)) => RunOutcome::Arrived,
                Ok(Some(Judgement::Bumped)) => RunOutcome::Bumped,
                Ok(Some(Judgement::Astray(place))) => RunOutcome::Astray(place),
            }
        }
    };
    run.contacts = drive.observer().map_or(0, |observer| observer.contacts());
    Some(run)
}

fn panicked<T>(Panicked(message): Panicked) -> Result<T, String> {
    Err(format!("a panic, which is a bug: {message}"))
}

/// Clock of a batch, whose time never advances, so that runs are made as fast as possible.
#[derive(Debug)]
struct StoppedClock;

impl Instants for StoppedClock {
    fn now(&mut self) -> Duration {
        Duration::ZERO
    }

    fn sleep(&mut self, _: Duration) {}
}
