//! Asserts that all machines print a trace that was derived from the rules by hand.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::trace::Script;
use mdle_tests::pipeline::{Machines, compile};

/// Reports of a turn: the time in seconds, the interrupts that have fired, and the laws that have completed. Names are
/// separated by commas.
pub(crate) type Turn = (f64, &'static str, &'static str);

/// Asserts that all machines print this trace, one line for each turn.
pub(crate) fn assert_trace(plan: &str, script: &[Turn], expected: &[&str]) {
    let compiled = compile(plan).unwrap_or_else(|report| panic!("{report}"));
    let script = Script::read(&written(script)).expect("a script");
    for (machine, trace) in Machines::new(&compiled).traces(&script) {
        let lines: Vec<_> = trace.iter().map(ToString::to_string).collect();
        assert_eq!(lines, expected, "machine {machine} on\n{plan}");
    }
}

fn written(script: &[Turn]) -> String {
    let list = |texts: &str| {
        let texts = texts.split(',').map(str::trim).filter(|text| !text.is_empty());
        texts.map(|text| format!("{text:?}")).collect::<Vec<_>>().join(",")
    };
    let lines = script.iter().map(|(t, fired, completed)| {
        format!("{{\"t\":{t:?},\"fired\":[{}],\"completed\":[{}]}}\n", list(fired), list(completed))
    });
    lines.collect()
}
