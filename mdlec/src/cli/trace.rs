//! `mdlec trace`: runs a plan against a script of interrupts.

use std::io::{self, BufWriter, Write};

use super::{CommandFailure, Trace, TraceMachine, report};
use mdle_compiler::Limit;
use mdle_compiler::fsm::expanded_states;
use mdle_compiler::trace::{CountedRun, MatrixProduct, Script, TableMachine, TraceLine, TreeWalk, run};
use mdle_files::Settings;
use mdle_files::read::LARGEST_DATA;

/// Runs the plan and prints the trace, one line per turn.
pub(super) fn trace(options: &Trace) -> Result<(), CommandFailure> {
    if options.plan.as_os_str() == "-" && options.script.as_os_str() == "-" {
        return Err(CommandFailure::usage("standard input can be the plan or the script, but not both"));
    }
    let target = Settings::beside(&options.plan)?.target(options.target.as_deref())?;
    let mut input = mdle_files::read_plan(&options.plan, &target)?;
    let limit: Limit = match options.machine {
        TraceMachine::Table | TraceMachine::Matrix => |plan| expanded_states(plan).map(drop),
        TraceMachine::Tree | TraceMachine::Counted => |_| Ok(()),
    };
    let compiled = super::compiled::compile_one(&mut input, &target, options.name.as_deref(), false, limit)?;
    let text = mdle_files::read_text(&options.script, LARGEST_DATA)?;
    let script = Script::read(&text).and_then(|script| compiled.worded(script, &target.alphabet)).map_err(|error| {
        CommandFailure::usage(format!("{}:{}: {}", options.script.display(), error.line, error.message))
    })?;
    let too_large = |found| {
        report::diagnostics(&input.sources, &[found], false);
        CommandFailure::PLAN
    };
    match options.machine {
        TraceMachine::Tree => print(run(TreeWalk::new(&compiled.plan), &script)),
        TraceMachine::Table => print(run(TableMachine::new(&compiled.nondegenerate).map_err(too_large)?, &script)),
        TraceMachine::Matrix => print(run(MatrixProduct::new(&compiled.nondegenerate).map_err(too_large)?, &script)),
        TraceMachine::Counted => print(run(CountedRun::new(&compiled.machine), &script)),
    }
}

fn print<'p>(lines: impl Iterator<Item = TraceLine<'p>>) -> Result<(), CommandFailure> {
    let mut out = BufWriter::new(io::stdout().lock());
    report::printed(lines.into_iter().try_for_each(|line| writeln!(out, "{line}")).and_then(|()| out.flush()))
}
