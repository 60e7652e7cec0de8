//! The report of tests for people: a line for each test, and the failures with their places in test and plan.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use codespan_reporting::diagnostic::{Diagnostic, Label};
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_files::Input;
use mdle_host::quoted;
use mdle_runtime::PrintableLines;
use mdle_runtime::trace::Seconds;

use super::course::{CourseTransition, TestCourse, TestEnd, atom_words};
use super::judge::UnmetExpectation;
use super::runner::{CompletedRun, RunJob, RunResult};
use super::suite::{RunsOn, TestCase, TestSuite};
use crate::messages;

/// Maximum number of transitions to show before a failure.
const STEPS: usize = 5;
/// Maximum number of seeds of a test for which to show commands.
const SEEDS: usize = 10;

/// The runs of one test.
pub(super) struct Tested<'m> {
    pub(super) suite: &'m TestSuite,
    pub(super) case: &'m TestCase,
    /// The files of the plan and the test, for reports.
    pub(super) sources: &'m Sources,
    /// Runs in the order of their seeds; at least one.
    pub(super) runs: &'m [CompletedRun],
}

/// Returns the tests with their runs, which are in the order of the tests.
pub(super) fn tested<'m>(suites: &'m [TestSuite], inputs: &'m [Input], made: &'m [CompletedRun]) -> Vec<Tested<'m>> {
    let groups = made.chunk_by(|one, next| (one.job.suite, one.job.case) == (next.job.suite, next.job.case));
    let tests = groups.filter_map(|runs| {
        let RunJob { suite, case, .. } = runs.first()?.job;
        let (suite, input) = (suites.get(suite)?, inputs.get(suite)?);
        Some(Tested { suite, case: suite.cases.get(case)?, sources: &input.sources, runs })
    });
    tests.collect()
}

impl Tested<'_> {
    /// Returns the runs that have failed.
    pub(super) fn failed(&self) -> impl Iterator<Item = &CompletedRun> {
        self.runs.iter().filter(|run| !run.result.is_good())
    }

    /// Returns `true` if all runs have passed.
    pub(super) fn is_good(&self) -> bool {
        self.failed().next().is_none()
    }

    /// Returns the outcome in a few words: the turns and the end of a single run, or the number of failed runs.
    pub(super) fn outcome(&self) -> String {
        match (self.runs, self.failed().count()) {
            ([CompletedRun { result: RunResult::Judged(course, _), .. }], _) => course_words(course),
            ([CompletedRun { result: RunResult::Crashed(_), .. }], _) => "crashed".to_owned(),
            (runs, 0) => format!("{} seeds", runs.len()),
            (runs, failed) => format!("{failed} of {} seeds failed", runs.len()),
        }
    }

    /// Returns the command that repeats a run by itself.
    pub(super) fn again(&self, job: RunJob) -> String {
        let (file, name) = (quoted(&self.suite.path.display().to_string()), quoted(&self.case.name));
        let seed = job.seed.map_or(String::new(), |seed| format!(" --seed {seed} --seeds 1"));
        format!("mdle test {file} --test {name}{seed}")
    }

    /// Returns the commands that record a run and explain a turn of it, if `mdle run` can repeat the run.
    pub(super) fn why(&self, job: RunJob, failure: &UnmetExpectation) -> Option<[String; 2]> {
        let RunsOn::Simulation(simulation) = &self.case.runs_on else { return None };
        if simulation.has_faults() {
            return None;
        }
        let mut run = format!("mdle run {} --target sim", quoted(&self.suite.subject.file.display().to_string()));
        for option in &simulation.options {
            let _ = write!(run, " {}", quoted(option));
        }
        let seed = job.seed.map_or(String::new(), |seed| format!(" --seed {seed}"));
        let _ = write!(run, "{seed} --speed max --log failed.mcap");
        Some([run, format!("mdle why failed.mcap {}", Seconds(failure.t))])
    }
}

/// Prints the lines of all tests to standard output, and the failures to standard error.
pub(super) fn tell(tests: &[Tested<'_>]) {
    let mut out = String::new();
    let mut file = None;
    for test in tests {
        if file.replace(&test.suite.path) != Some(&test.suite.path) {
            let _ = writeln!(out, "{}", test.suite.path.display());
        }
        let mark = if test.is_good() { "ok  " } else { "FAIL" };
        let _ = writeln!(out, "  {mark}  {} ({})", test.case.name, test.outcome());
    }
    said(&out);
    tests.iter().filter(|test| !test.is_good()).for_each(failed);
    let (good, all) = (tests.iter().filter(|test| test.is_good()).count(), tests.len());
    let runs: usize = tests.iter().map(|test| test.runs.len()).sum();
    let runs = if runs == all { String::new() } else { format!(", {runs} runs") };
    if all == 0 {
        return;
    }
    said(&match all - good {
        0 => format!("{all} passed{runs}\n"),
        bad => format!("{bad} failed, {good} passed{runs}\n"),
    });
}

/// Prints text to standard output.
pub(super) fn said(text: &str) {
    // A closed pipe is not an error.
    let _ = write!(io::stdout().lock(), "{}", PrintableLines(text)).and_then(|()| io::stdout().flush());
}

/// Prints the failures of the first run of a test that has failed, and the commands that repeat all failed runs.
fn failed(test: &Tested<'_>) {
    let Some(first) = test.failed().next() else { return };
    let sources = test.sources;
    match &first.result {
        RunResult::Crashed(sentence) => {
            let label = Label::primary(test.suite.source, test.case.text.name.span());
            // The help text follows the message on separate lines.
            let mut lines = sentence.lines();
            let reason = lines.next().unwrap_or_default();
            let message = format!("{}: the run could not be made: {reason}", title(test, first.job));
            let report = Diagnostic::error().with_message(message).with_labels(vec![label]);
            let again = format!("again: {}", test.again(first.job));
            messages::write(sources, report.with_notes(lines.map(str::to_owned).chain([again]).collect()));
        }
        RunResult::Judged(course, failures) => {
            let mut told = None;
            for (number, failure) in (1..).zip(failures) {
                // Failures at the same time have the same transitions before them, which are shown only once.
                let is_new = told.replace(failure.t) != Some(failure.t);
                let report = report(test, first.job, course, failure, is_new);
                let commands = if number == failures.len() { commands(test, first.job, failures) } else { Vec::new() };
                messages::write(sources, report.with_notes(commands));
            }
        }
    }
    let others: Vec<_> = test.failed().skip(1).collect();
    let mut lines = String::new();
    for run in others.iter().take(SEEDS) {
        let _ = writeln!(lines, "also failed: {}", test.again(run.job));
    }
    if others.len() > SEEDS {
        let _ = writeln!(lines, "… and {} more seeds", others.len() - SEEDS);
    }
    let _ = write!(io::stderr().lock(), "{}", PrintableLines(&lines));
}

fn title(test: &Tested<'_>, job: RunJob) -> String {
    let seed = job.seed.map_or(String::new(), |seed| format!(", seed {seed}"));
    format!("{}{seed}", test.case.name)
}

/// Returns the report of a failure: the expectation, the place in the plan and, if `has_transitions` is `true`, the
/// last transitions.
fn report(
    test: &Tested<'_>,
    job: RunJob,
    course: &TestCourse,
    failure: &UnmetExpectation,
    has_transitions: bool,
) -> Diagnostic<SourceId> {
    let machine = test.suite.subject.machine();
    let place = if failure.place.is_empty() { test.case.text.name.span() } else { failure.place.clone() };
    let mut labels = vec![Label::primary(test.suite.source, place).with_message(&failure.expected)];
    if let Some((atom, words)) = &failure.atom {
        let (source, range) = test.sources.range(machine.atom(*atom).element().span());
        labels.push(Label::secondary(source, range).with_message(words));
    }
    let mut notes = vec![format!("got: {}", failure.got)];
    if has_transitions && course.steps.first().is_some_and(|step| step.t <= failure.t) {
        notes.push(transitions(test, course, failure));
    }
    Diagnostic::error()
        .with_message(format!("{}: {}", title(test, job), failure.message))
        .with_labels(labels)
        .with_notes(notes)
}

/// Returns the commands that repeat a run, and that explain it at its first failure.
fn commands(test: &Tested<'_>, job: RunJob, failures: &[UnmetExpectation]) -> Vec<String> {
    let first = failures.iter().min_by_key(|failure| failure.t);
    let why = first.and_then(|first| test.why(job, first)).map(|[record, why]| format!("why: {record}\n     {why}"));
    [format!("again: {}", test.again(job))].into_iter().chain(why).collect()
}

/// Returns the last transitions before a failure.
fn transitions(test: &Tested<'_>, course: &TestCourse, failure: &UnmetExpectation) -> String {
    let (machine, words) = (test.suite.subject.machine(), &test.suite.subject.words);
    let until = course.steps.partition_point(|step| step.t <= failure.t);
    let first = until.saturating_sub(STEPS);
    let line = |CourseTransition { t, to, words: by, .. }: &CourseTransition| {
        format!("\n  {:>7} s  {}  <- {by}", Seconds(*t).to_string(), atom_words(machine, words, *to))
    };
    let lines: String = course.steps.get(first..until).unwrap_or_default().iter().map(line).collect();
    format!("last transitions:{lines}")
}

/// Returns a short description of a run.
fn course_words(course: &TestCourse) -> String {
    let turns = if course.turns == 1 { "1 turn".to_owned() } else { format!("{} turns", course.turns) };
    match &course.ending {
        TestEnd::Over => format!("{turns}, over at {} s", Seconds(course.t)),
        TestEnd::Running => format!("{turns}, running at {} s", Seconds(course.t)),
        TestEnd::Failed(_) => format!("{turns}, a fault at {} s", Seconds(course.t)),
    }
}
