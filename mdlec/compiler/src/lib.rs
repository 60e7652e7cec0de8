//! The compiler of MDLe: text in, Rust out.
//!
//! ```text
//! text ─syntax→ tree ─projection→ tree ─plan::resolve→ Plan ─plan::remove_degeneracy→ Nondegenerate
//!      ─fsm::lower→ Machine ─rust::emit→ Rust
//! ```
//!
//! **A stage does no I/O**, and the package needs no operating system: `mdle-files` reads plans, `mdlec` links Rust.

pub mod alphabet;
pub mod analysis;
pub mod builtin;
pub mod diagnostic;
pub mod fsm;
pub mod load;
pub mod picture;
pub mod plan;
pub mod projection;
pub mod rust;
#[cfg(test)]
mod samples;
pub mod syntax;
pub mod trace;

use alphabet::Alphabet;
use diagnostic::{Diagnostic, SourceId};

/// A plan after each stage.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// Plan with everything resolved, perhaps degenerate.
    pub plan: plan::Plan,
    /// Plan without repeated interrupts.
    pub nondegenerate: plan::Nondegenerate,
    /// Plan as a state machine.
    pub machine: fsm::Machine,
    /// Part of a group that the plan is, if it is one.
    pub part: Option<projection::Part>,
}

impl Compiled {
    /// Converts a script to the texts of the plan ([`trace::Script::in_words_of`]). For the plan of a robot of a group,
    /// the script may have the words of the group.
    ///
    /// # Errors
    /// Fails at the first name that is neither an interrupt of the plan nor a law of the plan that completes.
    pub fn worded(&self, script: trace::Script, alphabet: &Alphabet) -> Result<trace::Script, trace::ScriptError> {
        let script = match &self.part {
            Some(part) => script.renamed(|text| part.own_words(text)),
            None => script,
        };
        script.in_words_of(&self.plan, alphabet)
    }
}

/// Compiles a text to state machines: the plan `wanted`, or every plan that no other plan uses; [`rust::emit`] turns a
/// machine into Rust. Returns no plan if there is an error.
#[must_use]
pub fn compile(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    wanted: Option<&str>,
) -> (Vec<Compiled>, Vec<Diagnostic>) {
    compile_with(source, text, alphabet, wanted, &mut syntax::NoFiles)
}

/// Compiles a file that may use other files, which `loader` reads; see [`compile`].
#[must_use]
pub fn compile_with(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    wanted: Option<&str>,
    loader: &mut dyn syntax::Loader,
) -> (Vec<Compiled>, Vec<Diagnostic>) {
    compile_within(source, text, alphabet, wanted, loader, |_| Ok(()))
}

/// A limit on the size of a plan, for a use of it: the error, if the plan is too large.
pub type Limit = fn(&plan::Nondegenerate) -> Result<(), Diagnostic>;

/// Compiles like [`compile_with`]. If there is one plan, and it exceeds the limit, it is not lowered: that takes far
/// longer than all before it.
#[must_use]
pub fn compile_within(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    wanted: Option<&str>,
    loader: &mut dyn syntax::Loader,
    limit: Limit,
) -> (Vec<Compiled>, Vec<Diagnostic>) {
    stages(source, text, alphabet, wanted, loader, (plan::Bounds::FILES, Some(limit)))
}

/// Compiles like [`compile_with`] the plans of somebody who is not trusted: a plan that exceeds the bounds is an error
/// before it takes their memory.
#[must_use]
pub fn compile_bounded(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    loader: &mut dyn syntax::Loader,
    bounds: plan::Bounds,
) -> (Vec<Compiled>, Vec<Diagnostic>) {
    let all: Limit = |_| Ok(());
    stages(source, text, alphabet, None, loader, (bounds, Some(all)))
}

/// Returns the diagnostics of [`compile_with`] for a file that may use others, without keeping the compiled plans.
#[must_use]
pub fn check_with(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    loader: &mut dyn syntax::Loader,
) -> Vec<Diagnostic> {
    stages(source, text, alphabet, None, loader, (plan::Bounds::FILES, None)).1
}

/// Returns the names of the plans that [`compile_with`] compiles of a file. This takes far less time and memory,
/// however often the plans use other plans.
#[must_use]
pub fn roots(source: SourceId, text: &str, alphabet: &Alphabet, loader: &mut dyn syntax::Loader) -> Vec<String> {
    let arena = syntax::arena_for(text);
    let (mut files, _) = syntax::parse_with(source, text, &arena, loader);
    let _ = projection::project(&mut files, &arena, alphabet);
    plan::roots(&files, alphabet)
}

/// Runs all stages within these bounds, one plan after the other, and keeps the compiled plans if there is a limit for
/// them.
fn stages(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    wanted: Option<&str>,
    loader: &mut dyn syntax::Loader,
    (bounds, limit): (plan::Bounds, Option<Limit>),
) -> (Vec<Compiled>, Vec<Diagnostic>) {
    let arena = syntax::arena_for(text);
    let (mut files, mut found) = syntax::parse_with(source, text, &arena, loader);
    let (parts, groups) = projection::project(&mut files, &arena, alphabet);
    found.extend(groups);
    found.extend(plan::untyped::complete(&mut files, &arena, alphabet));
    let (plans, names) = plan::resolve(&files, alphabet, wanted, bounds);
    found.extend(names);
    let mut compiled = Vec::new();
    if !diagnostic::has_errors(&found) {
        found.extend(plan::lints::bare_numbers(&files, alphabet));
        let is_only = plans.len() == 1;
        for plan in plans {
            let kept = limit.map(|_| plan.clone());
            let part = parts.iter().find(|part| part.plan == plan.root.name);
            let mut warned = |warnings: Vec<Diagnostic>| found.extend(of_part(warnings, part));
            let (nondegenerate, warnings) = plan::remove_degeneracy(plan);
            warned(warnings);
            if let Some(Err(too_large)) = limit.filter(|_| is_only).map(|limit| limit(&nondegenerate)) {
                warned(vec![too_large]);
                continue;
            }
            warned(plan::lints::lints(&nondegenerate));
            match fsm::lower(&nondegenerate) {
                Ok(machine) => {
                    warned(analysis::lints(&machine));
                    let part = part.cloned();
                    compiled.extend(kept.map(|plan| Compiled { plan, nondegenerate, machine, part }));
                }
                Err(too_large) => warned(vec![too_large]),
            }
        }
    }
    if diagnostic::has_errors(&found) {
        compiled.clear();
    }
    diagnostic::sort(&mut found);
    (compiled, once_each(found))
}

/// Removes the texts to type from the diagnostics of a part of a group: they are words of its robot, not of the group.
fn of_part(mut found: Vec<Diagnostic>, part: Option<&projection::Part>) -> Vec<Diagnostic> {
    if part.is_some() {
        found.iter_mut().for_each(|diagnostic| diagnostic.help.retain(|help| help.edit.is_none()));
    }
    found
}

/// Leaves out the repetitions among sorted diagnostics: what several plans copy is found in each of them.
fn once_each(found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut kept: Vec<Diagnostic> = Vec::with_capacity(found.len());
    for diagnostic in found {
        let mut there = kept.iter().rev().take_while(|other| other.span() == diagnostic.span());
        if there.all(|other| *other != diagnostic) {
            kept.push(diagnostic);
        }
    }
    kept
}
