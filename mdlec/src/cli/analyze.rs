//! `mdlec analyze`: what is so of every run of a plan.

use super::{Analyze, Failure, build, input, report};
use crate::Compiled;
use crate::analysis::analyze as analysis;
use crate::diagnostic::Diagnostic;

/// Prints the analysis of a plan; what is suspicious goes to standard error.
pub(super) fn analyze(options: &Analyze) -> Result<(), Failure> {
    let target = input::target(options.target.as_deref())?;
    let mut input = input::read_plan(&options.plan, &target)?;
    let suspicious = |compiled: &Compiled| -> Vec<Diagnostic> { analysis(&compiled.lowered).1 };
    let name = options.name.as_deref();
    let compiled = build::compile_judged(&mut input, &target, name, options.deny_warnings, suspicious)?;
    let (analysis, _) = analysis(&compiled.lowered);
    report::print(&if options.json { analysis.to_json() } else { analysis.to_text() })
}
