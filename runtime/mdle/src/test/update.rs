//! `--update`: writes the results of runs into test files, for review as changes of these files.

use std::fs;
use std::io;
use std::ops::Range;
use std::path::Path;

use mdle_compiler::fsm::Machine;

use super::course::{TestCourse, TestEnd};
use super::file;
use super::judge::{judge, pose_words};
use super::report::Tested;
use super::runner::RunResult;
use super::subject::Subject;
use super::suite::{RunsOn, TestCase};

/// Radius and angle tolerance with which a pose is recorded for the first time.
const POSE: [&str; 2] = ["10cm", "5"];

/// A replacement of a range of a text.
type TextReplacement = (Range<usize>, String);

/// Updates a test file: replaces the expectations of atoms, of the end, of the pose and of numbers by the results of
/// the first run of each test. Returns the new text; `None` if nothing changes.
pub(super) fn updated(text: &str, tests: &[Tested<'_>]) -> Option<String> {
    let mut edits: Vec<TextReplacement> = tests.iter().flat_map(|test| edits(text, test)).collect();
    if edits.is_empty() {
        return None;
    }
    edits.sort_by_key(|(place, _)| std::cmp::Reverse(place.start));
    let mut text = text.to_owned();
    for (place, replacement) in edits {
        if text.get(place.clone()).is_some() {
            text.replace_range(place, &replacement);
        }
    }
    Some(text)
}

/// Writes the text of a test file, after checking that it is valid.
///
/// # Errors
/// Fails with a message if the text is not a test file, or cannot be written.
pub(super) fn write(path: &Path, text: &str) -> Result<(), String> {
    let name = path.display();
    file::read(text).map_err(|error| {
        format!("{name} cannot be updated: {}; write the expectations as in `expect.end = \"…\"`", error.message)
    })?;
    let beside = path.with_extension("toml.new");
    let written = fs::write(&beside, text).and_then(|()| fs::rename(&beside, path));
    written.map_err(|error: io::Error| format!("{name} cannot be written: {error}"))
}

/// Returns the changes of a test.
fn edits(text: &str, test: &Tested<'_>) -> Vec<TextReplacement> {
    let Some(RunResult::Judged(course, _)) = test.runs.first().map(|run| &run.result) else { return Vec::new() };
    let (case, subject) = (test.case, &test.suite.subject);
    if case.text.expect.is_empty() {
        let lines = recorded(case, subject, course);
        let after = text.get(case.text.name.span().end..).and_then(|rest| rest.find('\n'));
        let place = after.map_or(text.len(), |line| case.text.name.span().end + line + 1);
        let start = if after.is_none() { "\n" } else { "" };
        return vec![(place..place, format!("{start}{lines}"))];
    }
    let failures = judge(&case.expected, course, subject);
    let has_failed = |place: &Range<usize>| {
        failures.iter().any(|failure| place.start <= failure.place.start && failure.place.end <= place.end)
    };
    let expected = &case.text.expect;
    let mut edits = Vec::new();
    if let Some(atoms) = expected.atoms.as_ref().filter(|atoms| has_failed(&atoms.span())) {
        edits.push((atoms.span(), atoms_text(subject.machine(), course)));
    }
    if let (Some(end), Some(words)) = (&expected.end, end_text(subject, course))
        && has_failed(&end.span())
    {
        edits.push((end.span(), quoted(&words)));
    }
    if let (Some(pose), Some(got)) = (&expected.pose, &course.pose)
        && has_failed(&pose.span())
    {
        let parts: Vec<_> = pose.get_ref().split(',').map(str::trim).collect();
        let words = pose_words(got);
        let (place, heading) = words.rsplit_once(',').unwrap_or((&words, "0"));
        let radius = parts.get(2).unwrap_or(&POSE[0]);
        let heading = parts.get(4).map_or(String::new(), |tolerance| format!(",{heading},{tolerance}"));
        edits.push((pose.span(), quoted(&format!("{place},{radius}{heading}"))));
    }
    let counts = [(&expected.most_turns, course.turns), (&expected.most_transitions, course.steps.len() as u64)];
    for (most, count) in counts {
        if let Some(most) = most.as_ref().filter(|most| has_failed(&most.span())) {
            edits.push((most.span(), count.to_string()));
        }
    }
    edits
}

/// Returns the expectations for a test that has none yet.
fn recorded(case: &TestCase, subject: &Subject, course: &TestCourse) -> String {
    let mut lines = format!("expect.atoms = {}\n", atoms_text(subject.machine(), course));
    if let Some(end) = end_text(subject, course) {
        lines += &format!("expect.end = {}\n", quoted(&end));
    }
    let is_exact = matches!(&case.runs_on, RunsOn::Simulation(_)) && case.seeds(None, None).0.is_none();
    if let Some(pose) = course.pose.as_ref().filter(|_| is_exact) {
        let words = pose_words(pose);
        let (place, heading) = words.rsplit_once(',').unwrap_or((&words, "0"));
        let [radius, tolerance] = POSE;
        lines += &format!("expect.pose = {}\n", quoted(&format!("{place},{radius},{heading},{tolerance}")));
    }
    lines
}

fn atoms_text(machine: &Machine, course: &TestCourse) -> String {
    let laws = course.began.iter().map(|began| quoted(&machine.atom(began.atom).law().text));
    let laws: Vec<_> = laws.collect();
    let line = format!("[{}]", laws.join(", "));
    if line.chars().count() < 100 { line } else { format!("[\n    {},\n]", laws.join(",\n    ")) }
}

/// Returns the end of a run in the syntax of test files; `None` if it cannot be expressed.
fn end_text(subject: &Subject, course: &TestCourse) -> Option<String> {
    use mdle_runtime::Words as _;

    match (&course.ending, course.last()) {
        (TestEnd::Running, _) => Some("running".to_owned()),
        (TestEnd::Failed(_), _) => Some("failed".to_owned()),
        (TestEnd::Over, Some(step)) if step.has_completed => Some(mdle_runtime::trace::COMPLETED.to_owned()),
        (TestEnd::Over, Some(step)) => {
            let operand = subject.words.operand(step.scope, *step.operands.first()?)?;
            Some(operand.written.to_owned())
        }
        (TestEnd::Over, None) => None,
    }
}

/// Returns a text as a TOML string.
fn quoted(text: &str) -> String {
    if text.contains(['"', '\\']) && !text.contains('\'') {
        return format!("'{text}'");
    }
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
