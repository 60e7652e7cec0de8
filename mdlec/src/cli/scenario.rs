//! Builds and checks scenarios of several robots (`mdlec SCENARIO.toml`). The executable of a scenario contains all
//! files of the scenario, and runs them as `mdle run SCENARIO.toml` does.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(super) use mdle::is_scenario;

use super::compiled::needs_target;
use super::progress::build_package;
use super::version::version;
use super::{CommandFailure, ExecutableArguments, report};
use crate::link::{Entry, Package, TargetCrate};
use mdle_files::{Settings, target};

/// Name of the robot that scenarios use.
pub(super) const SIM: &str = "sim";

/// Builds the executable of the scenario in the file at `path`, and returns the path of the executable.
pub(super) fn build(
    options: &ExecutableArguments,
    path: &Path,
    output: Option<PathBuf>,
    machine: Option<&str>,
) -> Result<PathBuf, CommandFailure> {
    let started = Instant::now();
    must_fit(options, path)?;
    let files = files(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let target = target(Some(SIM))?;
    let crate_name = &target.alphabet.crate_name;
    let package = Package {
        plan_name: &name,
        version: &version(files.iter().map(|(_, bytes)| bytes.as_slice()), &target),
        plan_file: path,
        inputs: &files.iter().map(|(file, _)| PathBuf::from(file)).collect::<Vec<_>>(),
        entry: Entry::Scenario,
        rust: &constant(&files),
        target: &TargetCrate::Builtin { name: SIM, crate_name },
        machine,
    };
    let output = output.unwrap_or_else(|| PathBuf::from(&name));
    build_package(&package, &output, None, started)?;
    Ok(output)
}

/// Checks a scenario, its plans and its other files.
pub(super) fn check(path: &Path, deny_warnings: bool) -> Result<(), CommandFailure> {
    must_be_plain(deny_warnings)?;
    files(path).map(drop)
}

/// Returns the names and contents of the scenario's files; prints the errors if there are any.
fn files(path: &Path) -> Result<Vec<(String, Vec<u8>)>, CommandFailure> {
    mdle::scenario_files(path).map_err(CommandFailure::silent)
}

/// Refuses options that only a single plan supports, and robots other than the simulated one.
fn must_fit(options: &ExecutableArguments, path: &Path) -> Result<(), CommandFailure> {
    let settings = Settings::beside(path)?;
    needs_target(settings.names_target(options.target.as_deref()))?;
    let robot = settings.name_of_target(options.target.as_deref()).unwrap_or_default();
    must_be_simulated(path, &robot)?;
    if options.name.is_some() {
        let sentence = "`--plan` is for one robot, and a scenario names the plan of each\nhelp: leave it out";
        return Err(CommandFailure::usage(sentence));
    }
    if options.engine {
        let sentence = "`--engine` is for the plan of one robot, and an executable of a scenario has the engine\nhelp: leave it out";
        return Err(CommandFailure::usage(sentence));
    }
    must_be_plain(options.deny_warnings)
}

/// Refuses a robot other than the simulated one for the scenario in the file at `path`.
pub(super) fn must_be_simulated(path: &Path, robot: &str) -> Result<(), CommandFailure> {
    if robot == SIM {
        return Ok(());
    }
    let help = format!("use `--target {SIM}`; for other robots, name the file of the plan of each");
    let sentence = format!("is a scenario, whose robots are simulated, and the target is `{robot}`");
    Err(CommandFailure::usage(format!("`{}` {sentence}\nhelp: {help}", path.display())))
}

/// Refuses options that change messages, because `mdle` prints the messages about a scenario.
fn must_be_plain(deny_warnings: bool) -> Result<(), CommandFailure> {
    let given = [(deny_warnings, "--deny-warnings"), (report::is_json(), "--message-format json")];
    let Some((_, name)) = given.into_iter().find(|(is_given, _)| *is_given) else { return Ok(()) };
    Err(CommandFailure::usage(format!("`{name}` is for plans, and this is a scenario\nhelp: leave it out")))
}

/// Returns the Rust constant with the names and contents of files.
pub(super) fn constant(files: &[(String, Vec<u8>)]) -> String {
    let mut rust = "pub const FILES: &[(&str, &[u8])] = &[\n".to_owned();
    for (name, bytes) in files {
        // Writing to a string cannot fail.
        let _ = writeln!(rust, "    ({name:?}, b\"{}\"),", bytes.escape_ascii());
    }
    rust + "];\n"
}
