//! Compiles the selected plan of a file, or its only plan, and generates the Rust code. Messages go to standard error.

use std::path::Path;

use mdle_compiler::{Compiled, Limit, rust};
use mdle_files::{Input, InputError, Target, read_plan};

use super::{CommandFailure, report};

/// Compiles the plan `name`, or the only plan that no other plan uses, if the plan is within the limit; messages go to
/// standard error.
pub(super) fn compile_one(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
    limit: Limit,
) -> Result<Compiled, CommandFailure> {
    compile_judged(input, target, name, deny_warnings, limit, |compiled| compiled)
}

/// Compiles the plan `name`, or the only plan that no other plan uses, and passes it by value to `judge`, which can
/// drop the parts that it does not need.
pub(super) fn compile_judged<T>(
    input: &mut Input,
    target: &Target,
    name: Option<&str>,
    deny_warnings: bool,
    limit: Limit,
    mut judge: impl FnMut(Compiled) -> T,
) -> Result<T, CommandFailure> {
    if let Some(name) = name {
        input.must_have(name)?;
    }
    let (compiled, found) = input.compile_within(&target.alphabet, name, limit);
    let named = |compiled: Compiled| (compiled.plan.root.name.clone(), compiled);
    let judged: Vec<_> = compiled.into_iter().map(named).map(|(name, compiled)| (name, judge(compiled))).collect();
    if !report::diagnostics(&input.sources, &found, deny_warnings) {
        return Err(CommandFailure::PLAN);
    }
    Ok(input.only(judged)?)
}

/// Fails if no target is named, because Rust code is written for a particular robot.
pub(super) fn needs_target(is_named: bool) -> Result<(), CommandFailure> {
    if is_named { Ok(()) } else { Err(InputError::NoTarget.into()) }
}

/// A plan as Rust code, with its sources.
pub(super) struct Emitted {
    pub(super) target: Target,
    pub(super) input: Input,
    pub(super) plan_name: String,
    pub(super) rust: String,
}

/// Compiles the plan `name`, or the only plan that no other plan uses, to Rust for the crate of `target`.
pub(super) fn emitted(
    path: &Path,
    target: Target,
    name: Option<&str>,
    deny_warnings: bool,
) -> Result<Emitted, CommandFailure> {
    let mut input = read_plan(path, &target)?;
    let compiled = compile_one(&mut input, &target, name, deny_warnings, rust::fits)?;
    target.must_be_bound()?;
    let rust = input.rust(&compiled, &target).map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        CommandFailure::PLAN
    })?;
    Ok(Emitted { target, input, plan_name: compiled.plan.root.name, rust })
}
