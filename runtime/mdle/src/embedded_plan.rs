//! Plans inside executables that contain the engine. `mdlec PLAN --target TARGET --engine` copies the files of a plan
//! into an executable, which runs the plan in the same way as `mdle run PLAN --target TARGET`.

use std::ffi::OsString;
use std::io::Write as _;
use std::process::ExitCode;

use mdle_engine::Library;
use mdle_host::Program;

use crate::arguments::{ParsedCommand, help_of_executables, parse};
use crate::failure::{self, Failure};
use crate::input_files::InputFiles;
use crate::run::run_files;
use crate::{modules, targets};

/// Returns the names of the robots that the engine can drive.
#[must_use]
pub fn engine_targets() -> [&'static str; 3] {
    targets::names()
}

/// Runs a plan on the robot `target` in the same way as `mdle run`, with the options of this process. `files` contains
/// the names and texts of the plan's files, its own file first. `plan` is the name of the plan to run; `None` means the
/// only plan that no other plan uses. Returns the exit status.
#[must_use]
pub fn run_plan(program: Program<'_>, files: &[(&str, &[u8])], target: &str, plan: Option<&str>) -> ExitCode {
    run(program, files, target, plan).unwrap_or_else(Failure::tell)
}

fn run(program: Program<'_>, files: &[(&str, &[u8])], target: &str, plan: Option<&str>) -> Result<ExitCode, Failure> {
    let path = files.first().map_or("", |(path, _)| *path);
    // Records contain this command, which repeats the run from the plan's file.
    let words = ["mdle", "run", path, "--target", target].into_iter();
    let words = words.chain(plan.iter().flat_map(|plan| ["--plan", *plan])).map(OsString::from);
    let words = words.chain(std::env::args_os().skip(1)).collect();
    let ParsedCommand::Run(arguments) = parse(words)? else { return Ok(ExitCode::SUCCESS) };
    if let Some(help) = help_of_executables(&arguments.options) {
        // The help of the run follows, as soon as the plan is loaded.
        write!(std::io::stdout(), "{help}").map_err(|error| failure::unprinted(&error))?;
    }
    let mut library = Library::new();
    modules::shipped(&mut library);
    run_files(*arguments, &InputFiles::embedded(files), program.version, &mut library, None)
}
