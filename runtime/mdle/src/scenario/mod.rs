//! `mdle run SCENARIO.toml`: several robots in one world and one process (docs/src/many_robots.md).

mod arguments;
mod crowd;
mod file;
mod fleet;
mod member;
mod output;
mod records;
mod sent_plan;
mod setup;

use std::io::{self, Write as _};
use std::path::Path;
use std::process::ExitCode;

use codespan_reporting::diagnostic::{Diagnostic, Label};
use mdle_compiler::diagnostic::Sources;
use mdle_engine::Library;
use mdle_host::Interruption;
use mdle_runtime::{Printable, Sensed};

use crate::arguments::Run;
use crate::failure::{self, Failure};
use arguments::Options;
use crowd::CrowdSetup;
use file::ScenarioError;
use fleet::Fleet;
use output::Output;
use setup::{Scenario, SetupError};

/// Exit status for a scenario with a failure, such as a file that could not be written.
const FAULT: u8 = 3;

/// Returns `true` if this file is a scenario rather than a plan.
pub(crate) fn is_scenario(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "toml")
}

/// Runs a scenario with these modules in each robot; returns the exit status.
///
/// # Errors
/// Fails if the scenario cannot be run.
pub(crate) fn run(arguments: &Run, library: &Library<Sensed>) -> Result<ExitCode, Failure> {
    let options = Options::read(arguments)?;
    let path = &arguments.file;
    let text = file::text(path).map_err(Failure::Usage)?;
    let refused = |error| match error {
        SetupError::Plan(failure) => failure,
        SetupError::File(error) => refused(path, &text, &error),
    };
    let file = file::read(&text).map_err(SetupError::File).map_err(refused)?;
    if let Some(crowd) = &file.crowd {
        options.check_crowd()?;
        let crowd = CrowdSetup::read(crowd, &file, path, &options).map_err(refused)?;
        return crowd::run(crowd, &options);
    }
    options.check_robots()?;
    let scenario = Scenario::read(file, path, options.seed).map_err(refused)?;
    if options.recorded_paths.is_some() && scenario.members.iter().all(|member| member.records.is_none()) {
        let help = "name a path that the plan replays, as in `records = \"NAME\"`, or leave the option out";
        return Err(Failure::Usage(format!("--recorded-paths: no robot of the scenario records a path\nhelp: {help}")));
    }
    let mut output = Output::open(&options, &scenario).map_err(Failure::Usage)?;
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

/// Prints the error of a scenario file.
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
