//! `mdle test`: tests of plans, in files beside them (docs/src/testing.md).

pub(crate) mod arguments;
mod course;
mod coverage;
mod expected;
mod faults;
mod file;
mod judge;
mod messages;
mod report;
mod runner;
mod scripted;
mod simulated;
mod subject;
mod suite;

use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;

use arguments::Test;
use mdle_compiler::alphabet::did_you_mean;
use mdle_engine::Library;
use mdle_runtime::Sensed;
use suite::Suite;

use crate::failure::Failure;

/// Exit status of tests of which one fails.
const FAILED: u8 = 1;

/// Runs tests; returns 0 if all of them pass, 1 if one fails or a plan has errors, and 2 if a file of tests has errors.
///
/// # Errors
/// There is nothing to test.
pub(crate) fn test(arguments: &Test, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    let (mut suites, mut inputs, mut status) = (Vec::new(), Vec::new(), 0);
    for file in files(&arguments.files)? {
        match Suite::read(&file) {
            Ok((suite, input)) => {
                suites.push(suite);
                inputs.push(input);
            }
            Err(failure) => status = status.max(failure.tell_status()),
        }
    }
    let only = arguments.only.as_deref();
    if let Some(name) = only {
        must_have(name, &suites, status)?;
    }
    let (seed, seeds) = (arguments.seed, arguments.seeds.map(Into::into));
    let jobs = runner::jobs(&suites, only, seed, seeds);
    let threads = arguments.jobs.and_then(|jobs| NonZeroUsize::try_from(jobs).ok());
    let threads = threads.or_else(|| available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let (made, _coverage) = runner::run(&suites, &jobs, threads, library);
    let tests = report::tested(&suites, &inputs, &made);
    report::tell(&tests);
    let has_failed = tests.iter().any(|test| !test.is_good());
    Ok(ExitCode::from(if has_failed { status.max(FAILED) } else { status }))
}

/// Checks that there is a test of this name, if all files could be read.
fn must_have(name: &str, suites: &[Suite], status: u8) -> Result<(), Failure> {
    let names: Vec<_> = suites.iter().flat_map(|suite| &suite.cases).map(|case| case.name.as_str()).collect();
    if status > 0 || names.contains(&name) {
        return Ok(());
    }
    Err(Failure::Usage(format!("there is no test `{name}`{}", did_you_mean(name, &names))))
}

/// Returns the files of tests that the arguments name: files of tests, plans with such a file beside them, and folders.
fn files(named: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let here = [PathBuf::from(".")];
    let mut files = Vec::new();
    for path in if named.is_empty() { &here } else { named } {
        if path.is_dir() {
            let mut found = BTreeSet::new();
            collect(path, &mut found);
            if found.is_empty() {
                let message = format!("there is no file of tests in {}", path.display());
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

/// Adds the files of tests in a folder and in the folders inside it, but for hidden ones and `target`.
fn collect(folder: &Path, found: &mut BTreeSet<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        // A link to a folder may lead back.
        let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
        if is_folder && !name.starts_with('.') && name != "target" {
            collect(&entry.path(), found);
        } else if !is_folder && name.ends_with(file::ENDING) {
            let path = entry.path();
            found.insert(path.strip_prefix("./").map(Path::to_owned).unwrap_or(path));
        }
    }
}
