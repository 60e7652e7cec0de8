//! Scenarios inside executables. `mdlec SCENARIO.toml --target sim` copies all files that a scenario reads into an
//! executable, which runs the scenario in the same way as `mdle run`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use mdle_engine::Library;
use mdle_host::Program;

use super::arguments::ScenarioOptions;
use super::{ReadyPlan, run_with};
use crate::arguments::{ParsedCommand, parse};
use crate::failure::Failure;
use crate::input_files::{InputFiles, embeddable};
use crate::modules;

/// Returns the names and contents of all files that the scenario at `path` reads; the scenario's own file comes first.
///
/// # Errors
/// Fails if the scenario cannot be run, or if the name of a file is not UTF-8; prints the error and returns the exit
/// status.
pub fn scenario_files(path: &Path) -> Result<Vec<(String, Vec<u8>)>, u8> {
    read(path).map_err(Failure::tell_status)
}

fn read(path: &Path) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let files = InputFiles::of_system(path);
    ReadyPlan::read(&files, &ScenarioOptions::default())?;
    let contents = files.into_contents();
    // Checks that the scenario can be read from the copies alone, which are looked up by name, without resolving links
    // and folders.
    ReadyPlan::read(&InputFiles::inside(path, contents.clone()), &ScenarioOptions::default())?;
    let is_other = |(file, _): &(PathBuf, _)| file != path;
    let (mut others, mut own): (Vec<_>, Vec<_>) = contents.into_iter().partition(is_other);
    own.append(&mut others);
    embeddable(own).map_err(Failure::Usage)
}

/// Runs a scenario in the same way as `mdle run`, with the options of this process. `files` contains the files that
/// [`scenario_files`] has returned. Returns the exit status.
#[must_use]
pub fn run_scenario(program: Program<'_>, files: &[(&str, &[u8])]) -> ExitCode {
    run(program, files).unwrap_or_else(Failure::tell)
}

fn run(program: Program<'_>, files: &[(&str, &[u8])]) -> Result<ExitCode, Failure> {
    let path = files.first().map_or("", |(path, _)| *path);
    // Records contain this command, which repeats the run from the scenario's file.
    let words = ["mdle", "run", path].map(OsString::from).into_iter().chain(std::env::args_os().skip(1));
    let ParsedCommand::Run(arguments) = parse(words.collect())? else { return Ok(ExitCode::SUCCESS) };
    let options = ScenarioOptions::read(&arguments, Some(program))?;
    let mut library = Library::new();
    modules::shipped(&mut library);
    run_with(&options, &InputFiles::embedded(files), &library)
}
