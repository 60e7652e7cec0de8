//! `mdle run SCENARIO.toml`: runs several robots in one world and in one process (docs/src/many_robots.md).
//!
//! The executable of a scenario calls the same functions with copies of the scenario's files ([`embedded`]).

mod arguments;
mod crowd;
mod embedded;
mod file;
mod fleet;
mod member;
mod output;
mod records;
mod robot_plan;
mod room;
mod sent_plan;
mod setup;
mod setup_error;
mod values;

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use codespan_reporting::diagnostic::{Diagnostic, Label};
use mdle_compiler::diagnostic::Sources;
use mdle_engine::Library;
use mdle_host::Interruption;
use mdle_runtime::{Printable, Sensed};

use crate::arguments::RunArguments;
use crate::failure::{self, Failure};
use crate::input_files::InputFiles;
use arguments::ScenarioOptions;
use crowd::CrowdSetup;
pub use embedded::{run_scenario, scenario_files};
use file::ScenarioError;
use fleet::Fleet;
use output::ScenarioOutput;
use setup::Scenario;
use setup_error::SetupError;

/// Exit status for a scenario with a failure, such as a file that could not be written.
const FAULT: u8 = 3;

/// Returns `true` if this file is a scenario rather than a plan.
#[must_use]
pub fn is_scenario(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "toml")
}

/// Runs a scenario; each robot has the modules in `library`. Returns the exit status.
///
/// # Errors
/// Fails if the scenario cannot be run.
pub(crate) fn run(arguments: &RunArguments, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    let options = ScenarioOptions::read(arguments, None)?;
    run_with(&options, &InputFiles::of_system(&arguments.file), library)
}

/// Runs the scenario in these files.
fn run_with(options: &ScenarioOptions, files: &InputFiles, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    match ReadyPlan::read(files, options)? {
        ReadyPlan::Crowd(crowd) => crowd::run(crowd, options),
        ReadyPlan::Robots(scenario) => run_robots(*scenario, options, library),
    }
}

/// A scenario that is ready to run.
enum ReadyPlan {
    Crowd(CrowdSetup),
    Robots(Box<Scenario>),
}

impl ReadyPlan {
    /// Reads the scenario in these files, for a run with these options. Messages go to standard error.
    fn read(files: &InputFiles, options: &ScenarioOptions) -> Result<Self, Failure> {
        let path = &files.path;
        let text = files.text(path, file::LARGEST);
        let text = text.map_err(|error| Failure::Usage(format!("{} cannot be read: {error}", path.display())))?;
        let refused = |error| match error {
            SetupError::Plan(failure) => failure,
            SetupError::File(error) => refused(path, &text, &error),
        };
        let file = file::read(&text).map_err(SetupError::File).map_err(refused)?;
        if let Some(crowd) = &file.crowd {
            options.check_crowd()?;
            return CrowdSetup::read(crowd, &file, files, options).map(Self::Crowd).map_err(refused);
        }
        options.check_robots()?;
        Scenario::read(file, files, options.seed).map(Box::new).map(Self::Robots).map_err(refused)
    }
}

/// Runs the robots of a scenario.
fn run_robots(scenario: Scenario, options: &ScenarioOptions, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    if options.recorded_paths.is_some() && scenario.members.iter().all(|member| member.records.is_none()) {
        let help = "name a path that the plan replays, as in `records = \"NAME\"`, or leave the option out";
        return Err(Failure::Usage(format!("--recorded-paths: no robot of the scenario records a path\nhelp: {help}")));
    }
    let mut output = ScenarioOutput::open(options, &scenario).map_err(Failure::Usage)?;
    let timeout = options.timeout.unwrap_or(scenario.timeout);
    let fleet = match Fleet::new(scenario, library, output.records()) {
        Ok(fleet) => fleet,
        Err(sentence) => {
            output.discard();
            return Err(Failure::Usage(sentence));
        }
    };
    let uncaught = |error| Failure::Usage(format!("signals cannot be caught: {error}"));
    let interruption = Interruption::listen().map_err(uncaught)?;
    let status = fleet.run(timeout, &interruption, &mut output);
    let closed = output.close();
    let interrupted = interruption.tell(&mut io::stderr());
    match closed {
        Ok(()) => Ok(ExitCode::from(interrupted.unwrap_or(status))),
        Err(sentence) => {
            let _ = writeln!(io::stderr(), "error: {sentence}");
            Ok(ExitCode::from(FAULT))
        }
    }
}

/// Prints the error of a scenario file, and returns the failure.
fn refused(path: &Path, text: &str, error: &ScenarioError) -> Failure {
    let mut sources = Sources::default();
    let source = sources.add(path.display().to_string(), text);
    let Some(place) = &error.place else {
        let help = if error.help.is_empty() { String::new() } else { format!("\nhelp: {}", error.help) };
        return Failure::Usage(format!("{}: {}{help}", path.display(), error.message));
    };
    let label = Label::primary(source, place.clone());
    let mut report = Diagnostic::error().with_message(&error.message).with_labels(vec![label]);
    if !error.help.is_empty() {
        report = report.with_notes(vec![format!("help: {}", error.help)]);
    }
    crate::messages::write(&sources, report);
    failure::error(&format!("the scenario {} has errors", Printable(&path.display().to_string())));
    Failure::TestFile
}
