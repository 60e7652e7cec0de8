//! Builds executables that contain the Modular Engine (`mdlec PLAN --engine`). Such an executable contains the texts of
//! its plan, and runs them as `mdle run PLAN` does: the plan may read modules and other robots.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::endings::default_output;
use super::progress::build_package;
use super::scenario::constant;
use super::version::version;
use super::{CommandFailure, ExecutableArguments, report};
use crate::link::{Entry, Package, TargetCrate};
use mdle_compiler::alphabet::did_you_mean;
use mdle_files::{Input, Settings, Target, read_plan};

/// Builds the executable of the plan in the file at `path`, and returns its path; `settings` are those beside the plan.
pub(super) fn build(
    options: &ExecutableArguments,
    path: &Path,
    output: Option<PathBuf>,
    machine: Option<&str>,
    settings: &Settings,
) -> Result<PathBuf, CommandFailure> {
    let started = Instant::now();
    let name = settings.name_of_target(options.target.as_deref()).unwrap_or_default();
    must_have_driver(&name)?;
    must_be_whole(settings)?;
    let target = settings.target(options.target.as_deref())?;
    let mut input = read_plan(path, &target)?;
    let plan_name = checked(&mut input, &target, options)?;
    let files = input.files().map(Path::to_owned).zip(input.texts().map(|text| text.as_bytes().to_vec()));
    let files = mdle::embeddable(files).map_err(CommandFailure::usage)?;
    let package = Package {
        plan_name: &plan_name,
        version: &version(input.texts().map(str::as_bytes), &target),
        plan_file: path,
        inputs: &input.inputs(&target),
        entry: Entry::Engine { target: &name, plan: options.name.as_deref() },
        rust: &constant(&files),
        target: &TargetCrate::Builtin { name: &name, crate_name: &target.alphabet.crate_name },
        machine,
    };
    let path = output.unwrap_or_else(|| default_output(path, &plan_name));
    build_package(&package, &path, None, started)?;
    Ok(path)
}

/// Refuses a robot for which the engine has no driver.
fn must_have_driver(target: &str) -> Result<(), CommandFailure> {
    let known = mdle::engine_targets();
    if known.contains(&target) {
        return Ok(());
    }
    let (near, known) = (did_you_mean(target, &known), known.join(", "));
    let sentence = format!("the engine has no driver for `{target}`{near}\nhelp: `--engine` is for {known}");
    Err(CommandFailure::usage(sentence))
}

/// Refuses settings with safety rules or modules, which the executable would not have: a plan that always needs rules
/// must not run without them.
fn must_be_whole(settings: &Settings) -> Result<(), CommandFailure> {
    let safety = settings.safety().map(|entry| (entry.place, "safety rules", "--safety FILE"));
    let module = settings.modules().next().map(|module| (module.place, "modules", "--module NAME=COMMAND"));
    let Some((place, what, option)) = safety.or(module) else { return Ok(()) };
    Err(CommandFailure::usage(format!(
        "{place}: an executable takes its {what} from the command line only\nhelp: build it from a folder without this \
         entry, and start it with `{option}`"
    )))
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
        None => {
            let names = compiled.into_iter().map(|compiled| compiled.plan.root.name);
            Ok(input.only(names.map(|name| (name.clone(), name)).collect())?)
        }
    }
}
