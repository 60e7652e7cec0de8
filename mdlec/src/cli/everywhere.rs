//! `mdlec check --target all`: shows which robots can run a plan, and why other robots cannot.

use std::path::Path;

use super::each::each;
use super::{CheckArguments, CommandFailure, report};
use mdle_compiler::diagnostic::{Severity, has_errors};
use mdle_files::Target;
use mdle_files::read::LARGEST_PLAN;

/// Value of `--target` that selects all built-in robots.
pub(super) const ALL: &str = "all";

/// A plan file, with its errors for each robot. A robot without errors can run the plan.
struct PlanRow {
    name: String,
    refusals: Vec<Vec<String>>,
}

/// Checks each plan file for a robot with every capability, then for each robot. It is not an error if a robot cannot
/// run a plan.
pub(super) fn everywhere(options: &CheckArguments) -> Result<(), CommandFailure> {
    let everything = mdle_files::target(None)?;
    let names =
        mdle_compiler::builtin::alphabets().iter().filter(|alphabet| alphabet.target).map(|alphabet| alphabet.name);
    let robots =
        names.map(|name| Ok((name, mdle_files::target(Some(name))?))).collect::<Result<Vec<_>, CommandFailure>>()?;
    let mut rows = Vec::new();
    let checked = each(&options.plans, |path| {
        let text = mdle_files::read_text(path, LARGEST_PLAN)?;
        let mut plan = mdle_files::plan(path, text.clone(), &everything)?;
        let found = plan.check(&everything.alphabet);
        let good = report::diagnostics(&plan.sources, &found, options.deny_warnings);
        if !good || has_errors(&found) {
            return Err(CommandFailure::PLAN);
        }
        let refusals = robots.iter().map(|(_, robot)| refusals(path, &text, robot)).collect::<Result<_, _>>()?;
        rows.push(PlanRow { name: path.display().to_string(), refusals });
        Ok(())
    });
    let names: Vec<_> = robots.iter().map(|(name, _)| *name).collect();
    report::print(&(table(&names, &rows) + &reasons(&rows)))?;
    checked
}

/// Returns the errors of a plan file for a robot, with their places and messages.
fn refusals(path: &Path, text: &str, robot: &Target) -> Result<Vec<String>, CommandFailure> {
    let mut plan = mdle_files::plan(path, text.to_owned(), robot)?;
    let found = plan.check(&robot.alphabet);
    let errors = found.iter().filter(|found| found.code.severity() == Severity::Error);
    let refusals = errors.map(|error| {
        let message = plan.sources.message(error);
        let place = message.spans.first().map(|place| format!("{}:{}:{}: ", place.file, place.line, place.column));
        format!("{}{}", place.unwrap_or_default(), message.message)
    });
    Ok(refusals.collect())
}

/// Returns a table with a line for each plan and a column for each robot.
fn table(robots: &[&str], rows: &[PlanRow]) -> String {
    let width = rows.iter().map(|row| row.name.chars().count()).chain(["plan".len()]).max().unwrap_or(0);
    let line = |name: &str, cells: Vec<&str>| {
        let cells: String =
            robots.iter().zip(cells).map(|(robot, cell)| format!("  {cell:w$}", w = robot.len())).collect();
        format!("{}\n", format!("{name:width$}{cells}").trim_end())
    };
    let can = |refusals: &Vec<String>| if refusals.is_empty() { "yes" } else { "no" };
    let lines = rows.iter().map(|row| line(&row.name, row.refusals.iter().map(can).collect()));
    line("plan", robots.to_vec()) + &lines.collect::<String>()
}

/// Returns the errors of all plans and robots, one per line.
fn reasons(rows: &[PlanRow]) -> String {
    let refusals = rows.iter().flat_map(|row| row.refusals.iter().flatten());
    let lines: Vec<_> = refusals.map(|refusal| format!("{refusal}\n")).collect();
    if lines.is_empty() { String::new() } else { format!("\n{}", lines.concat()) }
}
