//! `mdle log export --script`: writes a record as a script of interrupts, for `mdlec trace` and the debugger.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::ExitCode;

use mdle_compiler::fsm::Machine;
use mdle_compiler::plan::Condition;
use mdle_runtime::trace::Seconds;
use mdle_runtime::{Examined, Nanometers, Nanos};
use serde_json::json;

use super::export::TableWriter;
use crate::examined::{ExaminedRun, ExaminedTurn, PlanMoment};
use crate::failure::Failure;
use crate::replay::{self, WantedPlan};

/// Writes a line for each turn of a record. The line lists the interrupts that the plan evaluated and that fired, and
/// the laws that completed. `plan` is the file of the plan, if the record does not contain the plan.
///
/// # Errors
/// Fails if the record or the plan cannot be read, if a script cannot express a turn, or if the file cannot be
/// written.
pub(super) fn script(log: &Path, plan: Option<&Path>, file: Option<&Path>) -> Result<ExitCode, Failure> {
    let (begin, record) = replay::record(log)?;
    let call = format!("mdle log export --script {}", log.display());
    let wanted = WantedPlan { log, file: plan, begin: &begin, call: &call, has_run: true };
    let mut run = ExaminedRun::of(&wanted, record)?;
    let mut table = TableWriter::created(file)?;
    let mut way = Nanometers(0);
    while let Some(turn) = run.turn() {
        let turn = match turn {
            Ok(turn) => turn,
            Err(stop) => {
                table.close()?;
                return stop.tell(&log.display().to_string(), plan);
            }
        };
        if turn.recorded.plan != 1 {
            table.close()?;
            return Err(replaced(log, &turn));
        }
        // The script begins when the plan begins; the plan may first wait for modules.
        let Some(examined) = run.plan() else { continue };
        way = turn.moments.first().and_then(|moment| moment.scopes.first()).map_or(way, |plan| plan.way);
        let line = line(&examined.machine, &turn, way).map_err(|text| untold(log, &turn, &text))?;
        table.write(&line)?;
    }
    table.close()?;
    Ok(ExitCode::SUCCESS)
}

/// Returns the line for a turn. If a condition is both true and false in the turn, fails with the text of the
/// condition.
fn line(machine: &Machine, turn: &ExaminedTurn, way: Nanometers) -> Result<String, String> {
    let (mut fired, mut completed) = (BTreeMap::new(), BTreeMap::new());
    for moment in &turn.moments {
        interrupts(machine, moment, &mut fired)?;
        note(&mut completed, &machine.atom(moment.atom).law().text, moment.is_completed)?;
    }
    let listed = |known: BTreeMap<&str, bool>| {
        known.into_iter().filter(|(_, is_so)| *is_so).map(|(text, _)| text.to_owned()).collect::<Vec<_>>()
    };
    let (fired, completed) = (listed(fired), listed(completed));
    // Nine decimals, because scripts have a resolution of a nanosecond and a nanometre.
    let [t, way] = [turn.recorded.t, Nanos(way.0)].map(|billionths| Seconds(billionths).to_string());
    let heading = turn.recorded.y.odometry.theta.degrees();
    let mut line = format!("{{\"t\":{t},\"way\":{way},\"heading\":{heading}");
    for (key, texts) in [("fired", fired), ("completed", completed)] {
        if !texts.is_empty() {
            line += &format!(",\"{key}\":{}", json!(texts));
        }
    }
    Ok(line + "}\n")
}

/// Records the values of the interrupts that are evaluated at a moment.
fn interrupts<'m>(
    machine: &'m Machine,
    moment: &PlanMoment,
    fired: &mut BTreeMap<&'m str, bool>,
) -> Result<(), String> {
    for scope in &moment.scopes {
        parts(machine, machine.element(scope.bracket).condition(), &mut scope.parts.iter(), fired)?;
    }
    Ok(())
}

/// Records the values of the quarks of a condition. `examined` yields the parts of the condition in the order in which
/// they were examined; `stuck` is treated as a single part.
fn parts<'m>(
    machine: &'m Machine,
    condition: &'m Condition,
    examined: &mut std::slice::Iter<'_, Examined>,
    fired: &mut BTreeMap<&'m str, bool>,
) -> Result<(), String> {
    let Some(part) = examined.next() else { return Ok(()) };
    if let Some((quark, _)) = condition.lasting() {
        return note(fired, &machine.quark(quark).text, part.fired);
    }
    if let Condition::Quark(quark) = condition {
        note(fired, &machine.quark(*quark).text, part.fired)?;
    }
    condition.children().iter().try_for_each(|operand| parts(machine, operand, examined, fired))
}

/// Records the value of the condition `text` in the turn. Fails with the text if the opposite value has already been
/// recorded.
fn note<'m>(known: &mut BTreeMap<&'m str, bool>, text: &'m str, is_so: bool) -> Result<(), String> {
    match known.insert(text, is_so) {
        Some(before) if before != is_so => Err(text.to_owned()),
        Some(_) | None => Ok(()),
    }
}

fn replaced(log: &Path, turn: &ExaminedTurn) -> Failure {
    let (log, number, t) = (log.display(), turn.recorded.number, Seconds(turn.recorded.t));
    Failure::Usage(format!(
        "from turn {number} of the record {log} on, at {t} s, another plan drove: a script is for one plan, and ends \
         before it"
    ))
}

fn untold(log: &Path, turn: &ExaminedTurn, text: &str) -> Failure {
    let (log, number, t) = (log.display(), turn.recorded.number, Seconds(turn.recorded.t));
    Failure::Usage(format!(
        "turn {number} of the record {log}, at {t} s, is none for a script: `{text}` ends an atom and begins again in the \
         same turn, which a script cannot say; the script ends before it"
    ))
}
