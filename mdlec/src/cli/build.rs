//! `mdlec build`, and `mdlec` without a command: builds the executable of a plan, or prints another form of the plan.

use std::path::{Path, PathBuf};

use super::compiled::{compile_one, needs_target};
use super::executable::{self, BuiltExecutable};
use super::{Bare, Build, CommandFailure, Emit, EmitKind, ExecutableArguments, endings, matrices, report, scenario};
use crate::link;
use mdle_compiler::syntax::outline;
use mdle_compiler::{Limit, fsm, picture, rust, syntax};
use mdle_files::{Input, Settings, Target, read_plan};

/// Runs `mdlec` without a command: builds the executable of a plan or prints another form of the plan and, with
/// `--run`, runs the executable.
pub(super) fn bare(options: &Bare) -> Result<(), CommandFailure> {
    let makes_none = options.build.emit.as_ref().is_some_and(|emit| emit.kind != EmitKind::Exe);
    if options.run && makes_none {
        return Err(CommandFailure::usage("`--run` runs an executable, and this `--emit` makes none"));
    }
    if options.run && options.build.machine.is_some() {
        let why = "`--run` runs the executable here, and `--machine` builds it for another machine: copy it there";
        return Err(CommandFailure::usage(why));
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
pub(super) fn build(options: &Build) -> Result<Option<BuiltExecutable>, CommandFailure> {
    let Build { executable: about, emit, combine, machine } = options;
    let path = executable::begin(about)?;
    let (kind, file) = match emit {
        None => (EmitKind::Exe, about.output.clone()),
        Some(Emit { file: Some(_), .. }) if about.output.is_some() => {
            return Err(CommandFailure::usage("there are two files to write to: one in `--emit` and one with `-o`"));
        }
        Some(Emit { kind, file }) => (*kind, file.clone().or_else(|| about.output.clone())),
    };
    if let Some(file) = &file {
        endings::no_picture(file, kind, path)?;
    }
    if kind == EmitKind::Exe {
        return executable::build(about, path, file, machine.as_deref()).map(Some);
    }
    if scenario::is_scenario(path) {
        let sentence = "is a scenario, and `--emit` prints a form of a plan\nhelp: name the plan of a robot";
        return Err(CommandFailure::usage(format!("`{}` {sentence}", path.display())));
    }
    if let Some((_, option)) = [(machine.is_some(), "--machine"), (about.engine, "--engine")].iter().find(|(is, _)| *is)
    {
        return Err(CommandFailure::usage(format!("`{option}` is for executables, and this `--emit` makes none")));
    }
    if *combine && kind != EmitKind::Matrices {
        return Err(CommandFailure::usage("`--combine` sums matrices: it goes with `--emit matrices`"));
    }
    if kind == EmitKind::Matrices {
        let target = Settings::beside(path)?.target(about.target.as_deref())?;
        let mut input = read_plan(path, &target)?;
        let compiled = compile_one(&mut input, &target, about.name.as_deref(), about.deny_warnings, limit(kind))?;
        let inputs = input.inputs(&target);
        matrices::matrices(&compiled.nondegenerate, *combine, file.as_deref(), &input.sources, &inputs)?;
        return Ok(None);
    }
    let (text, inputs) = stage(about, path, kind)?;
    match file {
        Some(file) => link::write_whole(&file, text.as_bytes(), &inputs).map_err(CommandFailure::from),
        None if kind.is_for_people() => report::print(&text),
        None => report::print_exactly(&text),
    }?;
    Ok(None)
}

/// Returns the check that a plan is not too large to be built, or to be printed in the form `kind`.
fn limit(kind: EmitKind) -> Limit {
    match kind {
        EmitKind::Tree | EmitKind::Projected | EmitKind::Plan | EmitKind::Nondegenerate | EmitKind::Formal => {
            |_| Ok(())
        }
        EmitKind::Expanded | EmitKind::Fsm => fsm::expands,
        EmitKind::Matrices | EmitKind::Scxml => |plan| fsm::expanded_states(plan).map(drop),
        EmitKind::Dot | EmitKind::Mermaid => picture::fits,
        EmitKind::Rust | EmitKind::Exe => rust::fits,
    }
}

/// Returns the text of the plan in the form `kind`, and the paths of the files that were read.
fn stage(options: &ExecutableArguments, path: &Path, kind: EmitKind) -> Result<(String, Vec<PathBuf>), CommandFailure> {
    let settings = Settings::beside(path)?;
    let target = settings.target(options.target.as_deref())?;
    let mut input = read_plan(path, &target)?;
    if kind == EmitKind::Tree {
        let arena = syntax::Arena::new();
        let (tree, found) = syntax::parse(input.source, input.sources.text(input.source), &arena);
        let good = report::diagnostics(&input.sources, &found, options.deny_warnings);
        return if good { Ok((outline::outline(&tree), input.inputs(&target))) } else { Err(CommandFailure::PLAN) };
    }
    if kind == EmitKind::Projected {
        return Ok((projected(&mut input, &target, options)?, input.inputs(&target)));
    }
    let compiled = compile_one(&mut input, &target, options.name.as_deref(), options.deny_warnings, limit(kind))?;
    let nondegenerate = &compiled.nondegenerate;
    let text = match kind {
        EmitKind::Plan => Ok(compiled.plan.to_string()),
        EmitKind::Formal => Ok(compiled.plan.formal()),
        EmitKind::Nondegenerate => Ok(nondegenerate.plan().to_string()),
        EmitKind::Expanded => fsm::expand(nondegenerate).map(|expanded| expanded.plan().numbered()),
        EmitKind::Fsm => fsm::fsm_file(nondegenerate).map(|file| file.to_json()),
        EmitKind::Dot => picture::dot(&compiled.machine),
        EmitKind::Mermaid => picture::mermaid(&compiled.machine),
        EmitKind::Scxml => picture::scxml(nondegenerate),
        EmitKind::Tree | EmitKind::Projected | EmitKind::Matrices | EmitKind::Rust | EmitKind::Exe => {
            needs_target(settings.names_target(options.target.as_deref()))?;
            input.rust(&compiled, &target)
        }
    };
    let text = text.map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        CommandFailure::PLAN
    })?;
    Ok((text, input.inputs(&target)))
}

/// Checks the plan of a group, and returns the plans of its robots as text.
fn projected(input: &mut Input, target: &Target, options: &ExecutableArguments) -> Result<String, CommandFailure> {
    let wanted = options.name.as_deref();
    if let Some(name) = wanted {
        input.must_have(name)?;
    }
    let found = input.check(&target.alphabet);
    if !report::diagnostics(&input.sources, &found, options.deny_warnings) {
        return Err(CommandFailure::PLAN);
    }
    let text = input.projected(&target.alphabet, wanted);
    match text.is_empty() {
        true => Err(CommandFailure::usage(format!(
            "`{}` has no group of robots, and `--emit projected` prints the plans of one\nhelp: a group begins with its \
             robots: `{{ Group [robot1 robot2] Name … }}`",
            input.sources.name(input.source)
        ))),
        false => Ok(text),
    }
}
