//! `mdle test`: runs the tests of plans in the test files beside them (docs/src/testing.md).

pub(crate) mod arguments;
mod causes;
mod course;
mod coverage;
mod coverage_table;
mod expected;
mod faults;
mod file;
#[cfg(test)]
mod hostile;
mod judge;
mod possible;
mod report;
mod results;
mod runner;
mod scripted;
mod simulated;
mod subject;
mod suite;
mod update;
mod watched;

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;

use arguments::Test;
use coverage::Coverage;
use coverage_table::CoverageTable;
use mdle_compiler::alphabet::did_you_mean;
use mdle_compiler::picture;
use mdle_engine::Library;
use mdle_files::Input;
use mdle_runtime::Sensed;
use report::Tested;
use runner::CompletedRun;
use suite::TestSuite;
use watched::WatchedFiles;

use crate::failure::{self, Failure};

/// Exit status if a test fails.
const FAILED: u8 = 1;

/// Runs tests; returns 0 if all of them pass, 1 if one fails or a plan has errors, and 2 if a test file has errors.
///
/// # Errors
/// Fails if there is nothing to test, or if a file cannot be written.
pub(crate) fn test(arguments: &Test, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    let mut watched = WatchedFiles::new(&files(&arguments.files)?);
    loop {
        let status = once(arguments, library);
        if !arguments.watch {
            return status.map(ExitCode::from);
        }
        if let Err(failure) = status {
            failure.tell_status();
        }
        let changed = watched.changed();
        report::said(&format!("\n{} has changed\n", changed.display()));
    }
}

/// Runs tests, and, if this has updated test files, runs them again; returns the exit status.
fn once(arguments: &Test, library: &Library<Sensed>) -> Result<u8, Failure> {
    if arguments.update {
        let (all, status) = Suites::read(arguments)?;
        let (made, _) = all.run(arguments, library);
        let tests = report::tested(&all.suites, &all.inputs, &made);
        for tests in tests.chunk_by(|one, next| one.suite.path == next.suite.path) {
            let Some(first) = tests.first() else { continue };
            if let Some(text) = update::updated(first.sources.text(first.suite.source), tests) {
                update::write(&first.suite.path, &text).map_err(Failure::Usage)?;
                report::said(&format!("{} is updated: review the change\n", first.suite.path.display()));
            }
        }
        if status > 0 {
            return Ok(status);
        }
    }
    let (all, status) = Suites::read(arguments)?;
    let (made, coverage) = all.run(arguments, library);
    let tests = report::tested(&all.suites, &all.inputs, &made);
    all.tell(arguments, &tests, &coverage)?;
    let has_failed = tests.iter().any(|test| !test.is_good());
    Ok(if has_failed { status.max(FAILED) } else { status })
}

/// The test files of a call.
struct Suites {
    suites: Vec<TestSuite>,
    /// The files of each plan, for reports.
    inputs: Vec<Input>,
}

impl Suites {
    /// Reads the test files; returns them with the exit status that erroneous files require.
    fn read(arguments: &Test) -> Result<(Self, u8), Failure> {
        let (mut suites, mut inputs, mut status) = (Vec::new(), Vec::new(), 0);
        for file in files(&arguments.files)? {
            match TestSuite::read(&file, arguments.update) {
                Ok((suite, input)) => {
                    suites.push(suite);
                    inputs.push(input);
                }
                Err(failure) => status = status.max(failure.tell_status()),
            }
        }
        if let Some(name) = &arguments.only {
            must_have(name, &suites, status)?;
        }
        Ok((Self { suites, inputs }, status))
    }

    fn run(&self, arguments: &Test, library: &Library<Sensed>) -> (Vec<CompletedRun>, Vec<Coverage>) {
        let jobs = runner::jobs(&self.suites, arguments.only.as_deref(), arguments.seed, arguments.seeds);
        let threads = arguments.jobs.and_then(|jobs| usize::try_from(jobs).ok()).and_then(NonZeroUsize::new);
        let threads = threads.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
        runner::run(&self.suites, &jobs, threads, library)
    }

    /// Reports the tests in the forms that the arguments request.
    fn tell(&self, arguments: &Test, tests: &[Tested<'_>], coverage: &[Coverage]) -> Result<(), Failure> {
        let covered = || self.suites.iter().zip(coverage);
        let tables = covered().map(|(suite, coverage)| CoverageTable::new(&suite.subject, coverage));
        if arguments.json {
            report::said(&format!("{}\n", results::json(tests, tables.collect())));
        } else {
            report::tell(tests);
            if arguments.coverage {
                tables.for_each(|table| report::said(&table.text()));
            }
        }
        let unwritten =
            |path: &Path, error: io::Error| Failure::Usage(format!("{} cannot be written: {error}", path.display()));
        if let Some(path) = &arguments.junit {
            fs::write(path, results::junit(tests)).map_err(|error| unwritten(path, error))?;
        }
        let Some(folder) = &arguments.pictures else { return Ok(()) };
        fs::create_dir_all(folder).map_err(|error| unwritten(folder, error))?;
        for ((suite, coverage), input) in covered().zip(&self.inputs) {
            let drawn = picture::counted_svg(suite.subject.machine(), &coverage.began);
            let drawn = drawn.map_err(|error| {
                failure::print(&input.sources, &[error]);
                Failure::Plan
            })?;
            let name = suite.subject.file.with_extension("svg");
            let path = folder.join(name.file_name().unwrap_or_default());
            fs::write(&path, drawn).map_err(|error| unwritten(&path, error))?;
        }
        Ok(())
    }
}

/// Checks that there is a test called `name`, if all files could be read.
fn must_have(name: &str, suites: &[TestSuite], status: u8) -> Result<(), Failure> {
    let names: Vec<_> = suites.iter().flat_map(|suite| &suite.cases).map(|case| case.name.as_str()).collect();
    if status > 0 || names.contains(&name) {
        return Ok(());
    }
    Err(Failure::Usage(format!("there is no test `{name}`{}", did_you_mean(name, &names))))
}

/// Returns the test files that the arguments name, either directly, or by the plan beside them, or by a folder.
fn files(named: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let here = [PathBuf::from(".")];
    let mut files = Vec::new();
    for path in if named.is_empty() { &here } else { named } {
        if path.is_dir() {
            let mut found = BTreeSet::new();
            collect(path, &mut found);
            if found.is_empty() {
                let message = format!("there is no test file in {}", path.display());
                let help = format!("the tests of `dock.mdle` are in `dock{}` beside it", file::ENDING);
                return Err(Failure::Usage(format!("{message}\nhelp: {help}")));
            }
            files.extend(found);
        } else if path.extension().is_some_and(|extension| extension == "mdle") {
            files.push(path.with_extension(file::ENDING.trim_start_matches('.')));
        } else {
            files.push(path.clone());
        }
    }
    let mut seen = BTreeSet::new();
    files.retain(|file| seen.insert(file.clone()));
    Ok(files)
}

/// Collects the test files in a folder and its subfolders, except hidden ones and `target`.
fn collect(folder: &Path, found: &mut BTreeSet<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // A symbolic link to a folder is not followed, because it may lead back.
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && !name.starts_with('.') && name != "target" {
            collect(&entry.path(), found);
        } else if !is_folder && name.ends_with(file::ENDING) {
            let path = entry.path();
            found.insert(path.strip_prefix("./").map(Path::to_owned).unwrap_or(path));
        }
    }
}
