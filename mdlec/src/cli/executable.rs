//! `mdlec run`: builds the executable of a plan, and runs it in place of this process.

use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use super::compiled::{Emitted, emitted, needs_target};
use super::progress::{ProgressOutput, build_package};
use super::version::version;
use super::{CommandFailure, EmitKind, ExecutableArguments, RunArguments, endings, engine, scenario};
use crate::link::{self, Entry, Package, TargetCrate};
use mdle_compiler::rust;
use mdle_files::{RunOption, SafetyEntry, Settings};

/// Builds the executable of a plan, and replaces this process by the executable.
pub(super) fn run(options: &RunArguments) -> Result<(), CommandFailure> {
    let path = begin(&options.executable)?;
    let output = options.executable.output.clone();
    if let Some(output) = &output {
        endings::no_picture(output, EmitKind::Exe, path)?;
    }
    settings_fit(&options.executable, &options.args)?;
    build(&options.executable, path, output, None)?.become_it(options.executable.target.as_deref(), &options.args)
}

/// Checks the `mdle.toml` beside a plan before the build. The options that it adds to a run with the arguments `args`
/// must be valid. It must not name safety rules, because executables do not support them.
pub(super) fn settings_fit(options: &ExecutableArguments, args: &[String]) -> Result<(), CommandFailure> {
    // A scenario takes no options from an `mdle.toml`.
    let Some(path) = options.plan.as_ref().filter(|path| !scenario::is_scenario(path)) else { return Ok(()) };
    let settings = Settings::beside(path)?;
    if let Some(SafetyEntry { place, .. }) = settings.safety() {
        let sentence = format!("{place}: `mdlec run` has no safety rules\nhelp: use `mdle run {}`", path.display());
        return Err(CommandFailure::usage(sentence));
    }
    settings.run_options(options.target.as_deref(), args, link::known)?;
    Ok(())
}

/// Installs the signal handlers of `take_signals`, and returns the file of the plan.
pub(super) fn begin(options: &ExecutableArguments) -> Result<&Path, CommandFailure> {
    take_signals()?;
    options.plan.as_deref().ok_or_else(|| CommandFailure::usage("no plan was given"))
}

/// Installs handlers for the signals that end this process. The handlers first end its child processes and remove its
/// unfinished files.
pub(super) fn take_signals() -> Result<(), CommandFailure> {
    link::leave_nothing_behind(ProgressOutput::wipe)
        .map_err(|error| CommandFailure::usage(format!("this system does not let signals be caught: {error}")))
}

/// An executable that was built, with the settings of its plan.
pub(super) struct BuiltExecutable {
    pub(super) path: PathBuf,
    /// Settings of the plan; empty for a scenario, which takes no options from an `mdle.toml`.
    pub(super) settings: Settings,
}

/// Builds the executable of the plan in `path`. By default, the executable is for this machine and in the current
/// folder.
pub(super) fn build(
    options: &ExecutableArguments,
    path: &Path,
    output: Option<PathBuf>,
    machine: Option<&str>,
) -> Result<BuiltExecutable, CommandFailure> {
    if scenario::is_scenario(path) {
        let path = scenario::build(options, path, output, machine)?;
        return Ok(BuiltExecutable { path, settings: Settings::default() });
    }
    let started = Instant::now();
    let settings = Settings::beside(path)?;
    needs_target(settings.names_target(options.target.as_deref()))?;
    if options.engine {
        let path = engine::build(options, path, output, machine, &settings)?;
        return Ok(BuiltExecutable { path, settings });
    }
    let mut target = settings.target(options.target.as_deref())?;
    target.alphabet.has_engine = false;
    let Emitted { target, input, plan_name, rust } =
        emitted(path, target, options.name.as_deref(), options.deny_warnings)?;
    let output = output.unwrap_or_else(|| endings::default_output(path, &plan_name));
    let crate_name = &target.alphabet.crate_name;
    let target_crate = match &target.folder {
        None => TargetCrate::Builtin { name: &target.alphabet.name, crate_name },
        Some(folder) => TargetCrate::Path { folder, crate_name },
    };
    let plan_type = rust::plan_type(&plan_name);
    let package = Package {
        plan_name: &plan_name,
        version: &version(input.texts().map(str::as_bytes), &target),
        plan_file: path,
        inputs: &input.inputs(&target),
        entry: Entry::Plan(&plan_type),
        rust: &rust,
        target: &target_crate,
        machine,
    };
    build_package(&package, &output, target.folder.as_deref(), started)?;
    Ok(BuiltExecutable { path: output, settings })
}

impl BuiltExecutable {
    /// Replaces this process by the executable, with the options of `mdle.toml` before `args`. `target` is the target
    /// that the command line names.
    pub(super) fn become_it(&self, target: Option<&str>, args: &[String]) -> Result<(), CommandFailure> {
        let program = if self.path.is_absolute() { self.path.clone() } else { Path::new(".").join(&self.path) };
        let options = self.settings.run_options(target, args, link::known)?;
        options.iter().try_for_each(|option| must_fit(option, &program))?;
        let options = options.iter().flat_map(|option| &option.arguments);
        become_program(Command::new(&program).args(options).args(args))
    }
}

/// Fails if the executable `program` does not accept the option with this value.
///
/// The executable is called with the option and `--version`. It checks its arguments in order before it prints its
/// version, and does nothing else, so this call only checks the option.
fn must_fit(option: &RunOption, program: &Path) -> Result<(), CommandFailure> {
    let answer = Command::new(program).args(&option.arguments).arg("--version").stdin(Stdio::null()).output();
    // If the program cannot be started, replacing this process fails as well and reports the reason.
    match answer.ok().filter(|answer| answer.status.code() == Some(2)) {
        Some(refusal) => Err(option.refused(&String::from_utf8_lossy(&refusal.stderr)).into()),
        None => Ok(()),
    }
}

/// Replaces this process by a program. The program's exit status becomes that of this process, and signals to this
/// process reach the program.
pub(super) fn become_program(command: &mut Command) -> Result<(), CommandFailure> {
    let error = command.exec();
    Err(CommandFailure::usage(format!("cannot run `{}`: {error}", Path::new(command.get_program()).display())))
}
