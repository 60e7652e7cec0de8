//! A test file that is ready to run: its plan is compiled, and its tests are resolved.

use std::path::{Path, PathBuf};

use codespan_reporting::diagnostic::{Diagnostic, Label};
use mdle_compiler::diagnostic::{SourceId, Sources};
use mdle_compiler::trace::Script;
use mdle_files::Input;
use mdle_runtime::Printable;

use super::arguments::MOST_SEEDS;
use super::expected::Expected;
use super::file::{self, TestFileError, TestText};
use super::possible::possible;
use super::scripted;
use super::simulated::Simulation;
use super::subject::Subject;
use crate::failure::{self, Failure};
use crate::messages;

/// A test file.
pub(super) struct TestSuite {
    pub(super) path: PathBuf,
    /// The text of the test file, among the files of the plan.
    pub(super) source: SourceId,
    pub(super) subject: Subject,
    pub(super) cases: Vec<TestCase>,
}

/// A test.
pub(super) struct TestCase {
    pub(super) name: String,
    pub(super) text: TestText,
    pub(super) expected: Expected,
    pub(super) runs_on: RunsOn,
}

/// The robot or the script on which a test runs.
pub(super) enum RunsOn {
    Script(Script),
    Simulation(Box<Simulation>),
}

impl TestSuite {
    /// Reads a test file and compiles its plan; returns the tests, and the files of the plan together with the test
    /// file. Tests without expectations are accepted if `is_recorded` is `true`. Messages go to standard error.
    ///
    /// # Errors
    /// Fails if the file or the plan cannot be read, or has errors.
    pub(super) fn read(path: &Path, is_recorded: bool) -> Result<(Self, Input), Failure> {
        let text = file::text(path).map_err(|error| Failure::Usage(error.message))?;
        let tests = file::read(&text).map_err(|error| refused(path, &text, &error))?;
        let (subject, mut input) = Subject::read(path, &tests, &|error| refused(path, &text, error))?;
        let source = input.sources.add(path.display().to_string(), text.clone());
        let (mut cases, mut errors) = (Vec::new(), Vec::new());
        for test in tests.test {
            match TestCase::read(test, path, &subject, is_recorded) {
                Ok(case) => cases.push(case),
                Err(error) => errors.push(error),
            }
        }
        if let Some((last, others)) = errors.split_last() {
            others.iter().for_each(|error| report(path, &text, error));
            return Err(refused(path, &text, last));
        }
        Ok((Self { path: path.to_owned(), source, subject, cases }, input))
    }
}

impl TestCase {
    fn read(text: TestText, path: &Path, subject: &Subject, is_recorded: bool) -> Result<Self, TestFileError> {
        let expected = Expected::read(&text.expect, subject, text.script.is_some())?;
        possible(&expected, subject)?;
        let runs_on = match &text.script {
            None => RunsOn::Simulation(Box::new(Simulation::read(&text, path, subject)?)),
            Some(turns) => {
                let seeds = [&text.seed, &text.seeds].into_iter().flatten().map(|seed| seed.span());
                let faults = text.faults.iter().map(|fault| fault.fault.span());
                let others = text.options().into_iter().map(|(.., place)| place).chain(seeds).chain(faults);
                if let Some(place) = others.min_by_key(|place| place.start) {
                    let message = "a test with a script has no robot, so it has no world, seed or faults";
                    return Err(TestFileError::at(place, message).help("leave this out, or leave `script` out"));
                }
                RunsOn::Script(scripted::script(turns, subject)?)
            }
        };
        if let Some(seeds) = text.seeds.as_ref().filter(|seeds| !(1..=MOST_SEEDS).contains(seeds.get_ref())) {
            let message = format!("a test runs at least once and at most {MOST_SEEDS} times");
            return Err(TestFileError::at(seeds.span(), message));
        }
        if text.expect.is_empty() && !is_recorded {
            let message = format!("the test `{}` expects nothing", Printable(text.name.get_ref()));
            let help = "write what it expects, as in `expect.end = \"completed\"`, or let `mdle test --update` record what a \
                        run does";
            return Err(TestFileError::at(text.name.span(), message).help(help));
        }
        Ok(Self { name: text.name.get_ref().clone(), text, expected, runs_on })
    }

    /// Returns the first seed and the number of runs. Without a seed, there is one run without random errors.
    pub(super) fn seeds(&self, first: Option<u64>, count: Option<u64>) -> (Option<u64>, u64) {
        let own = [&self.text.seed, &self.text.seeds].map(|seed| seed.as_ref().map(|seed| *seed.get_ref()));
        match own {
            [None, None] => (None, 1),
            [seed, seeds] => (Some(first.or(seed).unwrap_or(1)), count.or(seeds).unwrap_or(1)),
        }
    }
}

/// Prints the error of a test file.
fn refused(path: &Path, text: &str, error: &TestFileError) -> Failure {
    if error.place.is_none() {
        let help = if error.help.is_empty() { String::new() } else { format!("\nhelp: {}", error.help) };
        return Failure::Usage(format!("{}: {}{help}", path.display(), error.message));
    }
    report(path, text, error);
    failure::error(&format!("the test file {} has errors", Printable(&path.display().to_string())));
    Failure::TestFile
}

/// Prints an error at its place in a test file.
fn report(path: &Path, text: &str, error: &TestFileError) {
    let mut sources = Sources::default();
    let source = sources.add(path.display().to_string(), text);
    let labels = error.place.iter().map(|place| Label::primary(source, place.clone())).collect();
    let mut report = Diagnostic::error().with_message(&error.message).with_labels(labels);
    if !error.help.is_empty() {
        report = report.with_notes(vec![format!("help: {}", error.help)]);
    }
    messages::write(&sources, report);
}
