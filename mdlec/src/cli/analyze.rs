//! `mdlec analyze`: static analysis of a plan.

use super::{Analyze, CommandFailure, compiled, report};
use mdle_compiler::Compiled;
use mdle_compiler::analysis::analyze as analysis;
use mdle_files::Settings;

/// Prints the analysis of a plan; warnings go to standard error.
pub(super) fn analyze(options: &Analyze) -> Result<(), CommandFailure> {
    let target = Settings::beside(&options.plan)?.target(options.target.as_deref())?;
    let mut input = mdle_files::read_plan(&options.plan, &target)?;
    // The analysis needs only the state machine. The rest of a long plan is as large again, so it is dropped.
    let judge = |Compiled { machine, .. }: Compiled| analysis(&machine);
    let analysis = compiled::compile_judged(
        &mut input,
        &target,
        options.name.as_deref(),
        options.deny_warnings,
        |_| Ok(()),
        judge,
    )?;
    if options.json { report::print_exactly(&analysis.to_json()) } else { report::print(&analysis.to_text()) }
}
