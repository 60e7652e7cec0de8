//! The compiler of MDLe: translates the text of plans to Rust.
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

/// A plan in the forms that the stages produce.
#[derive(Debug, Clone)]
pub struct Compiled {
    /// Resolved plan; may be degenerate.
    pub plan: plan::Plan,
    /// Plan without repeated interrupts.
    pub nondegenerate: plan::Nondegenerate,
    /// Plan as a state machine.
    pub machine: fsm::Machine,
    /// Group and robot of the plan; `None` if the plan was not projected from the plan of a group.
    pub part: Option<projection::RobotPlan>,
}

impl Compiled {
    /// Replaces each name in a script with the text of the same quark in the plan ([`trace::Script::in_words_of`]). If
    /// the plan is for one robot of a group, the script may contain texts of the group's plan.
    ///
    /// # Errors
    /// Fails at the first name that is neither an interrupt in the plan nor a law in the plan that can complete.
    pub fn worded(&self, script: trace::Script, alphabet: &Alphabet) -> Result<trace::Script, trace::ScriptError> {
        let script = match &self.part {
            Some(part) => script.renamed(|text| part.own_words(text)),
            None => script,
        };
        script.in_words_of(&self.plan, alphabet)
    }
}

/// Compiles plans to state machines; [`rust::emit`] turns a machine into Rust. If `wanted` is given, compiles only the
/// plan with this name; otherwise, compiles every plan that no other plan uses. Returns no plan if there is an error.
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

/// A function that checks whether a plan is small enough for a certain use, such as a picture; returns an error if the
/// plan is too large.
pub type Limit = fn(&plan::Nondegenerate) -> Result<(), Diagnostic>;

/// Compiles plans as [`compile_with`] does. If there is only one plan and it exceeds `limit`, it is not lowered,
/// because lowering takes far longer than all earlier stages.
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

/// Compiles untrusted plans as [`compile_with`] does. If a plan exceeds `bounds`, an error is reported before the plan
/// uses up memory.
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

/// Returns the diagnostics that [`compile_with`] reports for a file that may use other files. Does not keep the
/// compiled plans.
#[must_use]
pub fn check_with(
    source: SourceId,
    text: &str,
    alphabet: &Alphabet,
    loader: &mut dyn syntax::Loader,
) -> Vec<Diagnostic> {
    stages(source, text, alphabet, None, loader, (plan::Bounds::FILES, None)).1
}

/// Returns the names of the plans in a file that [`compile_with`] would compile. This needs far less time and memory
/// than compiling them, even if plans use other plans many times.
#[must_use]
pub fn roots(source: SourceId, text: &str, alphabet: &Alphabet, loader: &mut dyn syntax::Loader) -> Vec<String> {
    let arena = syntax::arena_for(text);
    let (mut files, _) = syntax::parse_with(source, text, &arena, loader);
    let _ = projection::project(&mut files, &arena, alphabet);
    plan::roots(&files, alphabet)
}

/// Runs all stages within `bounds`, one plan after the other. The compiled plans are kept only if a limit is given.
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

/// Removes advice with edits from the diagnostics of a plan that is for one robot of a group. The edits would refer to
/// the text of this plan, but the user has only the text of the group's plan.
fn of_part(mut found: Vec<Diagnostic>, part: Option<&projection::RobotPlan>) -> Vec<Diagnostic> {
    if part.is_some() {
        found.iter_mut().for_each(|diagnostic| diagnostic.help.retain(|help| help.edit.is_none()));
    }
    found
}

/// Removes repeated diagnostics from a sorted list. Text that is copied to several plans causes the same diagnostic in
/// each plan.
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
