//! `mdlec run`: builds the executable of a plan, shows the progress, and runs the executable in place of this
//! process.

use std::io::{self, IsTerminal, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use mdle_runtime::Printable;

use super::compiled::{Emitted, emitted, needs_target};
use super::version::version;
use super::{EmitKind, Executable, Failure, Run, endings, report, scenario};
use crate::link::{self, Built, Cache, Entry, Package, Progress, TargetCrate};
use mdle_compiler::rust;
use mdle_files::{RunOption, SafetyEntry, Settings};

/// Builds the executable of a plan and becomes it.
pub(super) fn run(options: &Run) -> Result<(), Failure> {
    let path = begin(&options.executable)?;
    let output = options.executable.output.clone();
    if let Some(output) = &output {
        endings::no_picture(output, EmitKind::Exe, path)?;
    }
    settings_fit(&options.executable, &options.args)?;
    build(&options.executable, path, output, None)?.become_it(options.executable.target.as_deref(), &options.args)
}

/// Checks, before the build, the options that a run with the arguments `args` takes from an `mdle.toml`, which may name
/// no safety rules: an executable has none.
pub(super) fn settings_fit(options: &Executable, args: &[String]) -> Result<(), Failure> {
    // A scenario takes none.
    let Some(path) = options.plan.as_ref().filter(|path| !scenario::is_scenario(path)) else { return Ok(()) };
    let settings = Settings::beside(path)?;
    if let Some(SafetyEntry { place, .. }) = settings.safety() {
        let sentence = format!("{place}: `mdlec run` has no safety rules\nhelp: use `mdle run {}`", path.display());
        return Err(Failure::usage(sentence));
    }
    settings.run_options(options.target.as_deref(), args, link::known)?;
    Ok(())
}

/// Prepares for signals, so that they leave no processes or files, and returns the file of the plan.
pub(super) fn begin(options: &Executable) -> Result<&Path, Failure> {
    take_signals()?;
    options.plan.as_deref().ok_or_else(|| Failure::usage("no plan was given"))
}

/// Makes signals end this process without leaving processes or files.
pub(super) fn take_signals() -> Result<(), Failure> {
    link::leave_nothing_behind(ProgressOutput::wipe)
        .map_err(|error| Failure::usage(format!("this system does not let signals be caught: {error}")))
}

/// An executable that was built, with the settings of its plan.
pub(super) struct Runnable {
    pub(super) path: PathBuf,
    /// The settings; empty for a scenario, which takes none.
    pub(super) settings: Settings,
}

/// Builds the executable of the plan in `path` for a machine, by default in the current folder and for this machine.
pub(super) fn build(
    options: &Executable,
    path: &Path,
    output: Option<PathBuf>,
    machine: Option<&str>,
) -> Result<Runnable, Failure> {
    if scenario::is_scenario(path) {
        return scenario::build(options, path, output, machine);
    }
    let started = Instant::now();
    let settings = Settings::beside(path)?;
    needs_target(settings.names_target(options.target.as_deref()))?;
    let mut target = settings.target(options.target.as_deref())?;
    target.alphabet.has_engine = false;
    let Emitted { target, input, plan_name, rust } =
        emitted(path, target, options.name.as_deref(), options.deny_warnings)?;
    // Standard input has no name of its own.
    let stem = path.file_stem().filter(|stem| *stem != "-").map_or_else(|| PathBuf::from(&plan_name), PathBuf::from);
    let output = output.unwrap_or(stem);
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
    Ok(Runnable { path: output, settings })
}

/// Builds a package, whose target may be in a folder, shows the progress, and prints a note about the executable.
pub(super) fn build_package(
    package: &Package<'_>,
    output: &Path,
    target: Option<&Path>,
    started: Instant,
) -> Result<(), Failure> {
    let mut shown = ProgressOutput::default();
    let built = Cache::of_user()
        .and_then(|cache| link::build(&cache, package, output, &mut |progress| shown.progress(&progress)));
    shown.close();
    if !built.as_ref().is_ok_and(|built| built.fresh) {
        note_ignored(package.plan_file, target);
    }
    let Built { size, .. } = built?;
    let seconds = started.elapsed().as_secs_f64();
    let size = size as f64 / 1e6;
    report::note(format_args!("{}: built in {seconds:.2} s, {size:.1} MB", output.display()));
    Ok(())
}

/// Prints a note about a configuration file near the plan, or in the folder of its target, that mdlec ignores although
/// cargo would read it.
fn note_ignored(plan: &Path, target: Option<&Path>) {
    let beside = plan.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let folders: Vec<&Path> = target.into_iter().chain([beside]).collect();
    if let Some(file) = link::ignored_configuration(&folders) {
        report::note(format_args!(
            "{} has no effect: builds read the configuration in cargo's home only",
            file.display()
        ));
    }
}

impl Runnable {
    /// Becomes the executable, with the options of `mdle.toml` before `args`; `target` is the target on the
    /// command line.
    pub(super) fn become_it(&self, target: Option<&str>, args: &[String]) -> Result<(), Failure> {
        let program = if self.path.is_absolute() { self.path.clone() } else { Path::new(".").join(&self.path) };
        let options = self.settings.run_options(target, args, link::known)?;
        options.iter().try_for_each(|option| must_fit(option, &program))?;
        let options = options.iter().flat_map(|option| &option.arguments);
        become_program(Command::new(&program).args(options).args(args))
    }
}

/// Fails if the executable `program` does not accept the option with this value.
///
/// An executable checks its arguments one by one, and does nothing else before it answers `--version`.
fn must_fit(option: &RunOption, program: &Path) -> Result<(), Failure> {
    let answer = Command::new(program).args(&option.arguments).arg("--version").stdin(Stdio::null()).output();
    // A program that cannot be run cannot become this process either, which says why.
    match answer.ok().filter(|answer| answer.status.code() == Some(2)) {
        Some(refusal) => Err(option.refused(&String::from_utf8_lossy(&refusal.stderr)).into()),
        None => Ok(()),
    }
}

/// Becomes a program: its exit status and its signals are then those of this process.
pub(super) fn become_program(command: &mut Command) -> Result<(), Failure> {
    let error = command.exec();
    Err(Failure::usage(format!("cannot run `{}`: {error}", Path::new(command.get_program()).display())))
}

/// Progress output: a line that is overwritten on a terminal, and otherwise a line for each new step.
#[derive(Default)]
pub(super) struct ProgressOutput {
    open: bool,
}

impl ProgressOutput {
    pub(super) fn progress(&mut self, progress: &Progress) {
        if report::is_json() {
            return;
        }
        let mut out = io::stderr().lock();
        // A closed standard error has nobody to wait for the build.
        let _ = if out.is_terminal() {
            self.open = true;
            write!(out, "\r\x1b[K{}", Printable(progress))
        } else if progress.is_first() {
            writeln!(out, "{}", Printable(progress))
        } else {
            Ok(())
        };
    }

    pub(super) fn close(&mut self) {
        if std::mem::take(&mut self.open) {
            Self::wipe();
        }
    }

    /// Clears the current line of the terminal.
    fn wipe() {
        let mut out = io::stderr().lock();
        if out.is_terminal() {
            let _ = write!(out, "\r\x1b[K");
        }
    }
}
