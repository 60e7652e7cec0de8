//! `mdlec PLAN`: the executable, or a stage on the way to it.

use std::io::{self, IsTerminal, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use mdle_runtime::Printable;

use super::bind;
use super::input::{self, Input, Target};
use super::version::version;
use super::{Build, Emit, EmitKind, Failure, endings, matrices, report};
use crate::diagnostic::{Diagnostic, sort};
use crate::link::{self, Cache, LinkError, Package, Progress, TargetCrate};
use crate::rust::{self, Header};
use crate::syntax::outline;
use crate::{Compiled, fsm, picture, syntax};

/// Does what the command line without a command asks for.
pub(super) fn build(options: &Build) -> Result<(), Failure> {
    link::leave_nothing_behind(Shown::wipe)
        .map_err(|error| Failure::usage(format!("this system does not let signals be caught: {error}")))?;
    let Some(path) = options.plan.as_deref() else { return Err(Failure::usage("no plan was given")) };
    let (kind, file) = match &options.emit {
        None => (EmitKind::Exe, options.output.clone()),
        Some(Emit { file: Some(_), .. }) if options.output.is_some() => {
            return Err(Failure::usage("there are two files to write to: one in `--emit` and one with `-o`"));
        }
        Some(Emit { kind, file }) => (*kind, file.clone().or_else(|| options.output.clone())),
    };
    if let Some(file) = &file {
        endings::no_picture(file, kind, path)?;
    }
    if kind == EmitKind::Exe {
        return executable(options, path, file);
    }
    if options.run {
        return Err(Failure::usage("`--run` runs an executable, and this `--emit` makes none"));
    }
    if options.combine && kind != EmitKind::Matrices {
        return Err(Failure::usage("`--combine` sums matrices: it goes with `--emit matrices`"));
    }
    if kind == EmitKind::Matrices {
        let target = input::target(options.target.as_deref())?;
        let mut input = input::read_plan(path, &target)?;
        let compiled = compile_one(&mut input, &target, options.name.as_deref(), options.deny_warnings)?;
        let inputs = input.inputs(&target);
        return matrices::matrices(&compiled.nondegenerate, options.combine, file.as_deref(), &input.sources, &inputs);
    }
    let (text, inputs) = stage(options, path, kind)?;
    match file {
        Some(file) => link::write_whole(&file, text.as_bytes(), &inputs).map_err(|error| failure(&error)),
        None if kind.is_for_people() => report::print(&text),
        None => report::print_exactly(&text),
    }
}

/// Compiles the one plan that is to be run; messages go to standard error.
pub(super) fn compile_one(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
) -> Result<Compiled, Failure> {
    compile_judged(input, target, name, deny_warnings, |compiled| (compiled, Vec::new()))
}

/// Compiles the one plan that is to be judged: `judge` takes it, so that it can let go of what it does not need.
pub(super) fn compile_judged<T>(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
    judge: impl FnMut(Compiled) -> (T, Vec<Diagnostic>),
) -> Result<T, Failure> {
    if let Some(name) = name {
        known_plan(input, name)?;
    }
    let (compiled, mut found) = input.compile(&target.alphabet, name);
    let names: Vec<_> = compiled.iter().map(|compiled| compiled.plan.root.name.clone()).collect();
    let (mut judged, more): (Vec<_>, Vec<_>) = compiled.into_iter().map(judge).unzip();
    found.extend(more.into_iter().flatten());
    sort(&mut found);
    found.dedup();
    if !report::diagnostics(&input.sources, &found, deny_warnings) {
        return Err(Failure::PLAN);
    }
    match (judged.pop(), judged.len()) {
        (Some(only), 0) => Ok(only),
        (None, _) => Err(Failure::usage(format!(
            "every plan of `{}` is used by another or takes parameters\nhelp: name one of them, as in `{}`, or write a plan \
             that uses it",
            input.sources.name(input.source),
            report::option("plan", "NAME"),
        ))),
        (Some(_), _) => Err(Failure::usage(format!(
            "`{}` contains several plans that no other plan uses: {}\nhelp: name one of them, as in `{}`",
            input.sources.name(input.source),
            names.join(", "),
            report::option("plan", names.first().map_or("NAME", String::as_str)),
        ))),
    }
}

/// Exit status 2 if no plan of the file has this name.
fn known_plan(input: &mut Input, name: &str) -> Result<(), Failure> {
    let names = input.plan_names();
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    if names.contains(&name) || names.is_empty() {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "`{}` has no plan `{name}`{}\nhelp: its plans are {}",
        input.sources.name(input.source),
        input::did_you_mean(name, &names),
        names.join(", ")
    )))
}

/// A stage as text, with the files that were read for it.
fn stage(options: &Build, path: &Path, kind: EmitKind) -> Result<(String, Vec<PathBuf>), Failure> {
    let target = input::target(options.target.as_deref())?;
    let mut input = input::read_plan(path, &target)?;
    if kind == EmitKind::Tree {
        let arena = syntax::Arena::new();
        let (tree, found) = syntax::parse(input.source, input.sources.text(input.source), &arena);
        let good = report::diagnostics(&input.sources, &found, options.deny_warnings);
        return if good { Ok((outline::outline(&tree), input.inputs(&target))) } else { Err(Failure::PLAN) };
    }
    let compiled = compile_one(&mut input, &target, options.name.as_deref(), options.deny_warnings)?;
    let nondegenerate = &compiled.nondegenerate;
    let text = match kind {
        EmitKind::Plan => Ok(compiled.plan.to_string()),
        EmitKind::Formal => Ok(compiled.plan.formal()),
        EmitKind::Nondegenerate => Ok(nondegenerate.plan().to_string()),
        EmitKind::Expanded => fsm::expand(nondegenerate).map(|expanded| expanded.plan().numbered()),
        EmitKind::Fsm => fsm::fsm_file(nondegenerate).map(|file| file.to_json()),
        EmitKind::Dot => picture::dot(&compiled.lowered),
        EmitKind::Mermaid => picture::mermaid(&compiled.lowered),
        EmitKind::Scxml => picture::scxml(nondegenerate),
        EmitKind::Tree | EmitKind::Matrices | EmitKind::Rust | EmitKind::Exe => {
            needs_target(options.target.as_deref())?;
            rust_of(&compiled, path, &target)
        }
    };
    let text = text.map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        Failure::PLAN
    })?;
    Ok((text, input.inputs(&target)))
}

/// Rust is written for a robot.
fn needs_target(target: Option<&str>) -> Result<(), Failure> {
    let question = || {
        let option = report::option("target", "sim");
        Failure::usage(format!("for which robot? Name it, as in `{option}`; `mdlec targets` lists them"))
    };
    target.map(|_| ()).ok_or_else(question)
}

/// A plan as Rust, and what it was made of.
pub(super) struct Emitted {
    pub(super) target: Target,
    pub(super) input: Input,
    pub(super) plan_name: String,
    pub(super) rust: String,
}

/// Makes Rust of the one plan that is to be compiled with the crate of this target.
pub(super) fn emitted(
    path: &Path,
    target: Option<&str>,
    name: Option<&str>,
    deny_warnings: bool,
) -> Result<Emitted, Failure> {
    needs_target(target)?;
    let target = input::target(target)?;
    let mut input = input::read_plan(path, &target)?;
    let compiled = compile_one(&mut input, &target, name, deny_warnings)?;
    if let Some(folder) = &target.folder {
        bind::must_be_bound(folder, &target.alphabet)?;
    }
    let rust = rust_of(&compiled, path, &target).map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        Failure::PLAN
    })?;
    Ok(Emitted { target, input, plan_name: compiled.plan.root.name, rust })
}

fn rust_of(compiled: &Compiled, path: &Path, target: &Target) -> Result<String, Diagnostic> {
    rust::fits(&compiled.lowered, compiled.plan.root.span)?;
    let file = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let header = Header { file: &file, plan: &compiled.plan.root.name };
    Ok(rust::emit(&compiled.lowered, header, &target.alphabet))
}

fn executable(options: &Build, path: &Path, output: Option<PathBuf>) -> Result<(), Failure> {
    let started = Instant::now();
    let Emitted { target, input, plan_name, rust } =
        emitted(path, options.target.as_deref(), options.name.as_deref(), options.deny_warnings)?;
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
        version: &version(&input, &target),
        plan_file: path,
        inputs: &input.inputs(&target),
        plan_type: &plan_type,
        rust: &rust,
        target: &target_crate,
    };
    let mut shown = Shown { open: false };
    let built = Cache::of_user()
        .and_then(|cache| link::build(&cache, &package, &output, &mut |progress| shown.progress(&progress)));
    shown.close();
    if !built.as_ref().is_ok_and(|built| built.fresh) {
        note_ignored(path, &target);
    }
    let built = built.map_err(|error| failure(&error))?;
    let seconds = started.elapsed().as_secs_f64();
    let size = built.size as f64 / 1e6;
    report::note(format_args!("{}: built in {seconds:.2} s, {size:.1} MB", output.display()));
    if options.run { run(&output, &options.args) } else { Ok(()) }
}

/// Names a configuration near the target or the plan that would have had an effect on the build if cargo had been run there.
fn note_ignored(plan: &Path, target: &Target) {
    let beside = plan.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let folders: Vec<&Path> = target.folder.as_deref().into_iter().chain([beside]).collect();
    if let Some(file) = link::ignored_configuration(&folders) {
        report::note(format_args!(
            "{} has no effect: builds read the configuration in cargo's home only",
            file.display()
        ));
    }
}

/// Becomes the executable, so that its exit status and its signals are this process's.
fn run(output: &Path, args: &[String]) -> Result<(), Failure> {
    let program = if output.is_absolute() { output.to_owned() } else { Path::new(".").join(output) };
    let error = Command::new(&program).args(args).exec();
    Err(Failure::usage(format!("cannot run `{}`: {error}", program.display())))
}

pub(super) fn failure(error: &LinkError) -> Failure {
    Failure { status: error.exit_status(), message: Some(error.to_string()) }
}

/// The progress line: one that is written over on a terminal, else one for each thing worth saying.
struct Shown {
    open: bool,
}

impl Shown {
    fn progress(&mut self, progress: &Progress) {
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

    fn close(&mut self) {
        if std::mem::take(&mut self.open) {
            Self::wipe();
        }
    }

    /// Empties the line that the cursor is in.
    fn wipe() {
        let mut out = io::stderr().lock();
        if out.is_terminal() {
            let _ = write!(out, "\r\x1b[K");
        }
    }
}
