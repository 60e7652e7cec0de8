//! `mdlec build`, and `mdlec` without a command: builds the executable of a plan, or prints another form of the plan.

use std::path::{Path, PathBuf};

use super::bind;
use super::executable::{self, Runnable};
use super::input::{self, Input, Target};
use super::settings::{self, Settings};
use super::{Bare, Build, Emit, EmitKind, Executable, Failure, endings, matrices, report};
use crate::link;
use mdle_compiler::diagnostic::{Diagnostic, Sources};
use mdle_compiler::rust::{self, Header};
use mdle_compiler::syntax::outline;
use mdle_compiler::{Compiled, fsm, picture, syntax};

/// Runs a command line without a command.
pub(super) fn bare(options: &Bare) -> Result<(), Failure> {
    let makes_none = options.build.emit.as_ref().is_some_and(|emit| emit.kind != EmitKind::Exe);
    if options.run && makes_none {
        return Err(Failure::usage("`--run` runs an executable, and this `--emit` makes none"));
    }
    if options.run {
        executable::settings_fit(&options.build.executable, &options.args)?;
    }
    let built = build(&options.build)?;
    built
        .filter(|_| options.run)
        .map_or(Ok(()), |built| built.become_it(options.build.executable.target.as_deref(), &options.args))
}

/// Builds the executable of a plan, or prints another form of the plan. Returns the executable, if it was built.
pub(super) fn build(options: &Build) -> Result<Option<Runnable>, Failure> {
    let Build { executable: about, emit, combine } = options;
    let path = executable::begin(about)?;
    let (kind, file) = match emit {
        None => (EmitKind::Exe, about.output.clone()),
        Some(Emit { file: Some(_), .. }) if about.output.is_some() => {
            return Err(Failure::usage("there are two files to write to: one in `--emit` and one with `-o`"));
        }
        Some(Emit { kind, file }) => (*kind, file.clone().or_else(|| about.output.clone())),
    };
    if let Some(file) = &file {
        endings::no_picture(file, kind, path)?;
    }
    if kind == EmitKind::Exe {
        return executable::build(about, path, file).map(Some);
    }
    if *combine && kind != EmitKind::Matrices {
        return Err(Failure::usage("`--combine` sums matrices: it goes with `--emit matrices`"));
    }
    if kind == EmitKind::Matrices {
        let target = settings::target(path, about.target.as_deref())?;
        let mut input = input::read_plan(path, &target)?;
        let compiled = compile_one(&mut input, &target, about.name.as_deref(), about.deny_warnings)?;
        let inputs = input.inputs(&target);
        matrices::matrices(&compiled.nondegenerate, *combine, file.as_deref(), &input.sources, &inputs)?;
        return Ok(None);
    }
    let (text, inputs) = stage(about, path, kind)?;
    match file {
        Some(file) => link::write_whole(&file, text.as_bytes(), &inputs).map_err(|error| executable::failure(&error)),
        None if kind.is_for_people() => report::print(&text),
        None => report::print_exactly(&text),
    }?;
    Ok(None)
}

/// Compiles the only plan to run; messages go to standard error.
pub(super) fn compile_one(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
) -> Result<Compiled, Failure> {
    compile_judged(input, target, name, deny_warnings, |compiled| compiled)
}

/// Compiles the only plan to run, and passes it to `judge` by value, which can drop the parts that it does not need.
pub(super) fn compile_judged<T>(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
    judge: impl FnMut(Compiled) -> T,
) -> Result<T, Failure> {
    if let Some(name) = name {
        known_plan(input, name)?;
    }
    let (compiled, found) = input.compile(&target.alphabet, name);
    let names: Vec<_> = compiled.iter().map(|compiled| compiled.plan.root.name.clone()).collect();
    let mut judged: Vec<_> = compiled.into_iter().map(judge).collect();
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

/// Fails with exit status 2 if no plan of the file has this name.
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

/// Returns a form of the plan as text, with the files that were read for it.
fn stage(options: &Executable, path: &Path, kind: EmitKind) -> Result<(String, Vec<PathBuf>), Failure> {
    let settings = Settings::beside(path)?;
    let target = settings.target(options.target.as_deref())?;
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
            needs_target(settings.names_target(options.target.as_deref()))?;
            rust_of(&compiled, path, &target, &input.sources)
        }
    };
    let text = text.map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        Failure::PLAN
    })?;
    Ok((text, input.inputs(&target)))
}

/// Fails if no target is named: Rust is written for a robot.
pub(super) fn needs_target(is_named: bool) -> Result<(), Failure> {
    let option = report::option("target", "sim");
    let question = format!("for which robot? Name it, as in `{option}`; `mdlec targets` lists them");
    if is_named { Ok(()) } else { Err(Failure::usage(question)) }
}

/// A plan as Rust, with its sources.
pub(super) struct Emitted {
    pub(super) target: Target,
    pub(super) input: Input,
    pub(super) plan_name: String,
    pub(super) rust: String,
}

/// Generates Rust from the only plan to compile, for the crate of this target.
pub(super) fn emitted(
    path: &Path,
    target: Target,
    name: Option<&str>,
    deny_warnings: bool,
) -> Result<Emitted, Failure> {
    let mut input = input::read_plan(path, &target)?;
    let compiled = compile_one(&mut input, &target, name, deny_warnings)?;
    if let Some(folder) = &target.folder {
        bind::must_be_bound(folder, &target.alphabet)?;
    }
    let rust = rust_of(&compiled, path, &target, &input.sources).map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        Failure::PLAN
    })?;
    Ok(Emitted { target, input, plan_name: compiled.plan.root.name, rust })
}

fn rust_of(compiled: &Compiled, path: &Path, target: &Target, sources: &Sources) -> Result<String, Diagnostic> {
    rust::fits(&compiled.lowered, compiled.plan.root.span)?;
    let file = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let header = Header { sources, file: &file, plan: &compiled.plan.root.name };
    Ok(rust::emit(&compiled.lowered, header, &target.alphabet))
}
