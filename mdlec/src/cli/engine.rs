//! Builds executables that contain the Modular Engine (`mdlec PLAN --engine`). Such an executable contains the texts of
//! its plan, and runs them as `mdle run PLAN` does: the plan may read modules and other robots.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::compiled::needs_target;
use super::progress::build_package;
use super::scenario::constant;
use super::version::version;
use super::{CommandFailure, ExecutableArguments, report};
use crate::link::{Entry, Package, TargetCrate};
use mdle_compiler::alphabet::did_you_mean;
use mdle_files::{Input, Settings, Target, read_plan};

/// Builds the executable of the plan in the file at `path`, and returns the path of the executable.
pub(super) fn build(
    options: &ExecutableArguments,
    path: &Path,
    output: Option<PathBuf>,
    machine: Option<&str>,
) -> Result<PathBuf, CommandFailure> {
    let started = Instant::now();
    let settings = Settings::beside(path)?;
    needs_target(settings.names_target(options.target.as_deref()))?;
    let name = settings.name_of_target(options.target.as_deref()).unwrap_or_default();
    let known = mdle::engine_targets();
    if !known.contains(&name.as_str()) {
        let (near, known) = (did_you_mean(&name, &known), known.join(", "));
        let sentence = format!("the engine has no driver for `{name}`{near}\nhelp: `--engine` is for {known}");
        return Err(CommandFailure::usage(sentence));
    }
    let target = settings.target(options.target.as_deref())?;
    let mut input = read_plan(path, &target)?;
    let plan_name = checked(&mut input, &target, options)?;
    let files: Vec<_> = input.files().zip(input.texts()).map(named).collect::<Result<_, _>>()?;
    let crate_name = &target.alphabet.crate_name;
    let package = Package {
        plan_name: &plan_name,
        version: &version(input.texts().map(str::as_bytes), &target),
        plan_file: path,
        inputs: &input.inputs(&target),
        entry: Entry::Engine { target: &name, plan: options.name.as_deref() },
        rust: &constant(&files),
        target: &TargetCrate::Builtin { name: &name, crate_name },
        machine,
    };
    // Standard input has no file name, so the executable gets the name of the plan.
    let stem = path.file_stem().filter(|stem| *stem != "-").map_or_else(|| PathBuf::from(&plan_name), PathBuf::from);
    let output = output.unwrap_or(stem);
    build_package(&package, &output, None, started)?;
    Ok(output)
}

/// Returns the name of a file as text, and the contents of the file.
fn named((file, text): (&Path, &str)) -> Result<(String, Vec<u8>), CommandFailure> {
    let Some(name) = file.to_str() else {
        let sentence = "is no UTF-8 text, and an executable has its files by their names";
        return Err(CommandFailure::usage(format!("the path {} {sentence}\nhelp: rename it", file.display())));
    };
    Ok((name.to_owned(), text.as_bytes().to_vec()))
}

/// Checks the plan, or all parts of a group's plan, and returns its name. Messages go to standard error.
fn checked(input: &mut Input, target: &Target, options: &ExecutableArguments) -> Result<String, CommandFailure> {
    let wanted = options.name.as_deref();
    let group = input.group(wanted);
    if let Some(name) = wanted.filter(|_| group.is_none()) {
        input.must_have(name)?;
    }
    let (compiled, found) = input.compile(&target.alphabet, wanted.filter(|_| group.is_none()));
    if !report::diagnostics(&input.sources, &found, options.deny_warnings) {
        return Err(CommandFailure::PLAN);
    }
    match group {
        // The link file of a run names the robot whose part the run drives.
        Some(group) => Ok(group.name),
        None => Ok(input
            .only(compiled.into_iter().map(|plan| (plan.plan.root.name.clone(), plan.plan.root.name)).collect())?),
    }
}
