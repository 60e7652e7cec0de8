//! The results of tests for programs: JSON, and JUnit's XML.

use std::fmt::Write as _;

use mdle_runtime::Words as _;
use serde::Serialize;

use super::course::{TestCourse, TestEnd};
use super::coverage_table::CoverageTable;
use super::judge::UnmetExpectation;
use super::report::Tested;
use super::runner::{CompletedRun, RunResult};

/// The results of all tests.
#[derive(Debug, Serialize)]
struct Results {
    passed: bool,
    tests: Vec<RunEntry>,
    coverage: Vec<CoverageTable>,
}

/// A run of a test.
#[derive(Debug, Serialize)]
struct RunEntry {
    file: String,
    test: String,
    seed: Option<u64>,
    passed: bool,
    /// Number of turns. `seconds` is the time of the last turn, and `end` describes the end of the run: `over`,
    /// `running`, `failed` or `crashed`.
    turns: u64,
    seconds: f64,
    end: &'static str,
    /// The fault that ended the run, or the reason why the run could not be made; `None` if there was neither.
    #[serde(skip_serializing_if = "Option::is_none")]
    fault: Option<String>,
    failures: Vec<FailureEntry>,
    /// The command that repeats the run.
    again: String,
}

/// An expectation that a run has not met.
#[derive(Debug, Serialize)]
struct FailureEntry {
    message: String,
    expected: String,
    got: String,
    /// Line number in the test file.
    line: usize,
    /// Line number in the plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    plan_line: Option<u32>,
    seconds: f64,
}

/// Returns the results as JSON in one line.
pub(super) fn json(tests: &[Tested<'_>], coverage: Vec<CoverageTable>) -> String {
    let passed = tests.iter().all(Tested::is_good);
    let results = Results { passed, tests: entries(tests), coverage };
    serde_json::to_string(&results).unwrap_or_default()
}

fn entries(tests: &[Tested<'_>]) -> Vec<RunEntry> {
    tests.iter().flat_map(|test| test.runs.iter().map(|run| entry(test, run))).collect()
}

fn entry(test: &Tested<'_>, run: &CompletedRun) -> RunEntry {
    let (course, failures): (Option<&TestCourse>, &[UnmetExpectation]) = match &run.result {
        RunResult::Judged(course, failures) => (Some(course), failures),
        RunResult::Crashed(_) => (None, &[]),
    };
    let (end, fault) = match (&run.result, course.map(|course| &course.ending)) {
        (RunResult::Crashed(reason), _) => ("crashed", Some(reason.clone())),
        (RunResult::Judged(..), Some(TestEnd::Failed(fault))) => ("failed", Some(fault.clone())),
        (RunResult::Judged(..), Some(TestEnd::Running) | None) => ("running", None),
        (RunResult::Judged(..), Some(TestEnd::Over)) => ("over", None),
    };
    RunEntry {
        file: test.suite.path.display().to_string(),
        test: test.case.name.clone(),
        seed: run.job.seed,
        passed: run.result.is_good(),
        turns: course.map_or(0, |course| course.turns),
        seconds: course.map_or(0.0, |course| course.t.seconds()),
        end,
        fault,
        failures: failures.iter().map(|failure| failed(test, failure)).collect(),
        again: test.again(run.job),
    }
}

fn failed(test: &Tested<'_>, failure: &UnmetExpectation) -> FailureEntry {
    let subject = &test.suite.subject;
    let plan_line = failure.atom.as_ref().and_then(|(atom, _)| {
        let element = subject.machine().atom(*atom).element().number();
        subject.words.bracket(element).map(|bracket| bracket.at.line)
    });
    let place = if failure.place.is_empty() { test.case.text.name.span() } else { failure.place.clone() };
    let before = test.sources.text(test.suite.source).get(..place.start).unwrap_or_default();
    FailureEntry {
        message: failure.message.clone(),
        expected: failure.expected.clone(),
        got: failure.got.clone(),
        line: before.matches('\n').count() + 1,
        plan_line,
        seconds: failure.t.seconds(),
    }
}

/// Returns the results in the XML of JUnit, which programs for continuous integration read.
pub(super) fn junit(tests: &[Tested<'_>]) -> String {
    let entries = entries(tests);
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
    for suite in entries.chunk_by(|one, next| one.file == next.file) {
        let Some(first) = suite.first() else { continue };
        let crashed = suite.iter().filter(|run| run.end == "crashed").count();
        let failed = suite.iter().filter(|run| !run.passed).count() - crashed;
        let (name, count) = (escaped(&first.file), suite.len());
        let _ =
            writeln!(xml, "  <testsuite name=\"{name}\" tests=\"{count}\" failures=\"{failed}\" errors=\"{crashed}\">");
        suite.iter().for_each(|run| case(&mut xml, run));
        xml += "  </testsuite>\n";
    }
    xml + "</testsuites>\n"
}

fn case(xml: &mut String, run: &RunEntry) {
    let seed = run.seed.map_or(String::new(), |seed| format!(", seed {seed}"));
    let (name, file) = (escaped(&format!("{}{seed}", run.test)), escaped(&run.file));
    let _ = write!(xml, "    <testcase name=\"{name}\" classname=\"{file}\"");
    if run.passed {
        *xml += "/>\n";
        return;
    }
    *xml += ">\n";
    if let (Some(reason), "crashed") = (&run.fault, run.end) {
        let _ = writeln!(xml, "      <error message=\"{}\">{}</error>", escaped(reason), escaped(&run.again));
    }
    for FailureEntry { message, expected, got, line, seconds, .. } in &run.failures {
        let text = format!("{}:{line}: {expected}\ngot: {got}\nat: {seconds} s\nagain: {}", run.file, run.again);
        let _ = writeln!(xml, "      <failure message=\"{}\">{}</failure>", escaped(message), escaped(&text));
    }
    *xml += "    </testcase>\n";
}

/// Escapes a text for XML, and removes the control characters that XML forbids.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\n' | '\t' => escaped.push(letter),
            _ if letter.is_control() => escaped.push('\u{fffd}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}
