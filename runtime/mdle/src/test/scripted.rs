//! Runs a plan on the script of a test, without a robot.

use mdle_compiler::fsm::Machine;
use mdle_compiler::trace::{CountedRun, Reports, Script};
use mdle_host::{CauseText, Transitions};
use mdle_runtime::Turn;

use super::course::{CourseRecorder, TestCourse, TestEnd};
use super::coverage::Coverage;
use super::expected::{Expected, ForbiddenState};
use super::file::{At, ScriptTurn, TestFileError};
use super::subject::{Subject, TestCondition};

/// Reads the script of a test, and converts its conditions and laws to the texts that the plan has for them.
///
/// # Errors
/// Fails with a message if the script has no turns, or an impossible turn.
pub(super) fn script(turns: &At<Vec<At<ScriptTurn>>>, subject: &Subject) -> Result<Script, TestFileError> {
    let refused = |message: String| TestFileError::at(turns.span(), message);
    let turn = |line: usize| turns.get_ref().get(line.saturating_sub(1)).map_or(turns.span(), |turn| turn.span());
    if turns.get_ref().is_empty() {
        return Err(refused("the script has no turn".to_owned()).help("write the first turn, as in `[{ t = 0 }]`"));
    }
    let lines = turns.get_ref().iter().map(|turn| serde_json::to_string(turn.get_ref()).unwrap_or_default());
    let script = Script::read(&lines.collect::<Vec<_>>().join("\n"));
    let script = script.and_then(|script| subject.compiled.worded(script, &subject.target.alphabet));
    let script = script.map_err(|error| {
        TestFileError::at(turn(error.line), error.message.replace("previous line", "previous turn"))
    })?;
    for (number, reports) in script.turns().iter().enumerate() {
        if let Some(law) = reports.completed.iter().find(|law| never_completes(law, subject.machine())) {
            let help = "leave it out of `completed`: an interrupt ends its atom";
            return Err(TestFileError::at(turn(number + 1), format!("the law `{law}` never completes")).help(help));
        }
    }
    Ok(script)
}

/// Returns `true` if the plan has this law, and the law never completes.
fn never_completes(law: &str, machine: &Machine) -> bool {
    let mut laws = machine.atoms().filter(|atom| atom.law().text == law).peekable();
    laws.peek().is_some() && laws.all(|atom| !atom.law().completes)
}

/// Runs the plan on a script.
pub(super) fn run(subject: &Subject, expected: &Expected, script: &Script, coverage: &mut Coverage) -> TestCourse {
    let machine = subject.machine();
    let mut recorder = CourseRecorder::new(machine);
    let mut counted = CountedRun::new(machine);
    let mut transitions = Transitions::default();
    for reports in script.turns() {
        transitions.clear();
        let turn = counted.watched(reports, &mut transitions);
        let atom = counted.atom();
        recorder.turn(reports.t, atom, &transitions, |transition, operands| {
            CauseText { plan: subject, transition, operands }.to_string()
        });
        coverage.turn(machine, atom, &transitions, |scope, tell| counted.operands(scope, reports, tell));
        breaches(expected, reports, atom, &mut recorder);
        if turn == Turn::Over {
            recorder.course.ending = TestEnd::Over;
            break;
        }
    }
    recorder.course
}

/// Records the forbidden states that occur in a turn.
fn breaches(expected: &Expected, reports: &Reports, atom: Option<u32>, recorder: &mut CourseRecorder<'_>) {
    for (number, (_, never)) in expected.never.iter().enumerate() {
        let ForbiddenState::While { atoms, condition, .. } = never else { continue };
        let is_known = recorder.course.breaches.iter().any(|breach| breach.number == number);
        let runs = atoms.as_ref().is_none_or(|atoms| atom.is_some_and(|atom| atoms.holds(atom)));
        let is_true = |TestCondition { machine, .. }: &TestCondition| fires(machine, reports);
        if !is_known && runs && condition.as_deref().is_none_or(is_true) {
            recorder.breach(number, None);
        }
    }
}

/// Returns `true` if the interrupt of a plan fires in its first turn.
fn fires(machine: &Machine, reports: &Reports) -> bool {
    let mut transitions = Transitions::default();
    CountedRun::new(machine).watched(reports, &mut transitions);
    // The law of the plan may complete as well.
    transitions.iter().any(|(transition, _)| matches!(transition.cause, mdle_runtime::Cause::Fired(_)))
}
