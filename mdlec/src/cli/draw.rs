//! `mdlec draw`: draws a plan as a picture.

use super::{CommandFailure, Draw, compiled, endings, report};
use crate::link;
use mdle_compiler::picture;
use mdle_files::Settings;

/// Draws the plan, into a file or to standard output.
pub(super) fn draw(options: &Draw) -> Result<(), CommandFailure> {
    if let Some(file) = &options.output {
        endings::svg(file)?;
    }
    let target = Settings::beside(&options.plan)?.target(options.target.as_deref())?;
    let mut input = mdle_files::read_plan(&options.plan, &target)?;
    let compiled = compiled::compile_one(&mut input, &target, options.name.as_deref(), false, picture::fits)?;
    let drawn = picture::svg(&compiled.machine).map_err(|too_large| {
        report::diagnostics(&input.sources, &[too_large], false);
        CommandFailure::PLAN
    })?;
    match &options.output {
        None => report::print_exactly(&drawn),
        Some(file) => link::write_whole(file, drawn.as_bytes(), &input.inputs(&target)).map_err(CommandFailure::from),
    }
}
