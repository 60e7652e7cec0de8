//! Runs tests in parallel. The outcome depends neither on the number of threads nor on the order of the runs.

use std::io::{self, IsTerminal as _};
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Instant;

use mdle_engine::Library;
use mdle_host::ProgressLine;
use mdle_runtime::Sensed;

use super::course::TestCourse;
use super::coverage::Coverage;
use super::judge::{UnmetExpectation, judge};
use super::scripted;
use super::simulated::RunError;
use super::suite::{RunsOn, TestCase, TestSuite};

/// A run to make.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunJob {
    pub(super) suite: usize,
    pub(super) case: usize,
    pub(super) seed: Option<u64>,
}

/// A run that was made.
#[derive(Debug)]
pub(super) struct CompletedRun {
    pub(super) job: RunJob,
    pub(super) result: RunResult,
}

/// Result of a run.
#[derive(Debug)]
pub(super) enum RunResult {
    /// The run has a course, and a list of the expectations that it has not met.
    Judged(Box<TestCourse>, Vec<UnmetExpectation>),
    /// The run could not begin, or its code panicked; contains the error message.
    Crashed(String),
}

impl RunResult {
    /// Returns `true` if all expectations are met.
    pub(super) fn is_good(&self) -> bool {
        match self {
            Self::Judged(_, failures) => failures.is_empty(),
            Self::Crashed(_) => false,
        }
    }
}

/// Returns the runs of all tests, or of the tests called `only`.
pub(super) fn jobs(suites: &[TestSuite], only: Option<&str>, first: Option<u64>, count: Option<u64>) -> Vec<RunJob> {
    let mut jobs = Vec::new();
    for (suite, tests) in suites.iter().enumerate() {
        for (case, test) in tests.cases.iter().enumerate().filter(|(_, test)| only.is_none_or(|only| test.name == only))
        {
            let (seed, runs) = test.seeds(first, count);
            jobs.extend((0..runs).map(|run| RunJob { suite, case, seed: seed.map(|seed| seed.wrapping_add(run)) }));
        }
    }
    jobs
}

/// Makes the runs on `threads` threads; returns them in the order of `jobs`, and the coverage of each suite.
pub(super) fn run(
    suites: &[TestSuite],
    jobs: &[RunJob],
    threads: NonZeroUsize,
    library: &Library<Sensed>,
) -> (Vec<CompletedRun>, Vec<Coverage>) {
    let next = AtomicUsize::new(0);
    let fresh = || suites.iter().map(|suite| Coverage::new(suite.subject.machine())).collect::<Vec<_>>();
    let (mut made, mut coverage) = (Vec::new(), fresh());
    let refused: Vec<_> = suites.iter().map(|_| OnceLock::new()).collect();
    thread::scope(|scope| {
        let (sender, receiver) = channel();
        let (reached, workers) = channel();
        for _ in 0..threads.get().min(jobs.len()) {
            let (sender, reached, next, fresh, refused) = (sender.clone(), reached.clone(), &next, &fresh, &refused);
            scope.spawn(move || {
                let mut coverage = fresh();
                while let Some((number, job)) = taken(next, jobs) {
                    let result = one(suites, *job, library, &mut coverage, refused);
                    // The runner listens until all threads have ended.
                    let _ = sender.send((number, CompletedRun { job: *job, result }));
                }
                let _ = reached.send(coverage);
            });
        }
        drop((sender, reached));
        let begun = Instant::now();
        let (mut err, is_seen) = (io::stderr(), io::stderr().is_terminal());
        let mut progress = is_seen.then(|| ProgressLine::new(&mut err, Box::new(move || begun.elapsed())));
        for run in receiver {
            made.push(run);
            if let Some(progress) = &mut progress {
                progress.runs(made.len() as u64, jobs.len() as u64);
            }
        }
        for worker in workers {
            coverage.iter_mut().zip(&worker).for_each(|(all, own)| all.add(own));
        }
    });
    made.sort_by_key(|(number, _)| *number);
    (made.into_iter().map(|(_, made)| made).collect(), coverage)
}

fn taken<'j>(next: &AtomicUsize, jobs: &'j [RunJob]) -> Option<(usize, &'j RunJob)> {
    let number = next.fetch_add(1, Ordering::Relaxed);
    jobs.get(number).map(|job| (number, job))
}

/// Makes a run. A panic fails only this run. `refused` contains, for each suite, the message about a module that was
/// refused. The other runs of the suite do not load this module again, because it may take long until a process is
/// refused.
fn one(
    suites: &[TestSuite],
    job: RunJob,
    library: &Library<Sensed>,
    coverage: &mut [Coverage],
    refused: &[OnceLock<String>],
) -> RunResult {
    let (Some(suite), Some(coverage), Some(refused)) =
        (suites.get(job.suite), coverage.get_mut(job.suite), refused.get(job.suite))
    else {
        return RunResult::Crashed("there is no such test".to_owned());
    };
    let Some(case) = suite.cases.get(job.case) else {
        return RunResult::Crashed("there is no such test".to_owned());
    };
    if let (RunsOn::Simulation(_), Some(sentence)) = (&case.runs_on, refused.get()) {
        return RunResult::Crashed(sentence.clone());
    }
    let mut own = coverage.clone();
    own.begins();
    match shielded(|| course(suite, case, job.seed, library, &mut own)) {
        Ok(mut course) => {
            *coverage = own;
            let failures = judge(&case.expected, &course, &suite.subject);
            let (first, _) = case.seeds(None, None);
            if failures.is_empty() && job.seed != first {
                // The course of a passed run with another seed than the first is not needed, and takes memory.
                (course.steps, course.began) = (Vec::new(), Vec::new());
            }
            RunResult::Judged(Box::new(course), failures)
        }
        Err(RunError::Module(sentence)) => RunResult::Crashed(refused.get_or_init(|| sentence).clone()),
        Err(RunError::Own(sentence)) => RunResult::Crashed(sentence),
    }
}

/// Makes a run; a panic in its code becomes an error.
fn shielded(run: impl FnOnce() -> Result<TestCourse, RunError>) -> Result<TestCourse, RunError> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|payload| {
        let words = payload.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
        Err(RunError::Own(format!("a panic, which is a bug: {words}")))
    })
}

fn course(
    suite: &TestSuite,
    case: &TestCase,
    seed: Option<u64>,
    library: &Library<Sensed>,
    coverage: &mut Coverage,
) -> Result<TestCourse, RunError> {
    match &case.runs_on {
        RunsOn::Script(script) => Ok(scripted::run(&suite.subject, &case.expected, script, coverage)),
        RunsOn::Simulation(simulation) => simulation.run(&suite.subject, &case.expected, seed, library, coverage),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_crashes_one_run() {
        let own = |sentence: &str| Err(RunError::Own(sentence.to_owned()));
        assert_eq!(shielded(|| panic!("no wheel {}", 3)), own("a panic, which is a bug: no wheel 3"));
        assert_eq!(shielded(|| own("no start")), own("no start"));
    }
}
