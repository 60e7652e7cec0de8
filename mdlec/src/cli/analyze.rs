//! `mdlec analyze`: what is so of every run of a plan.

use super::{Analyze, Failure, build, input, report};
use crate::Compiled;
use crate::analysis::analyze as analysis;
use crate::diagnostic::Diagnostic;

/// Prints the analysis of a plan; what is suspicious goes to standard error.
pub(super) fn analyze(options: &Analyze) -> Result<(), Failure> {
    let target = input::target(options.target.as_deref())?;
    let mut input = input::read_plan(&options.plan, &target)?;
    let mut analysed = None;
    let suspicious = |compiled: &Compiled| -> Vec<Diagnostic> {
        let (analysis, suspicious) = analysis(&compiled.lowered);
        analysed = Some(analysis);
        suspicious
    };
    build::compile_judged(&mut input, &target, options.name.as_deref(), options.deny_warnings, suspicious)?;
    // There is one plan then, or there was an error.
    let Some(analysis) = analysed else { return Err(Failure::PLAN) };
    if options.json { report::print_exactly(&analysis.to_json()) } else { report::print(&analysis.to_text()) }
}
