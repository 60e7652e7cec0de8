//! Tests the rules of `way` (docs/src/reference/semantics.md, 3.3), of `FRAME here` (docs/src/reference/semantics.md,
//! 3.4) and of `stuck` (docs/src/reference/semantics.md, 3.5), each with a minimal plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::trace::Script;
use mdle_tests::pipeline::{Machines, compile};

/// Asserts that all machines print this trace, one line for each turn.
fn assert_trace(plan: &str, script: &[&str], expected: &[&str]) {
    let compiled = compile(plan).unwrap_or_else(|report| panic!("{report}"));
    let script = Script::read(&script.join("\n")).expect("a script");
    for (machine, trace) in Machines::new(&compiled).traces(&script) {
        let lines: Vec<_> = trace.iter().map(ToString::to_string).collect();
        assert_eq!(lines, expected, "machine {machine} on\n{plan}");
    }
}

#[test]
fn way_counts_from_its_own_scope_to_the_nanometre() {
    assert_trace(
        "{ Main { P (way > 3m) (Atom (way >= 100cm) idle) (Atom (way == 1.5) drift) (Atom (null) seek) } (Atom (way < 50mm) climb) }",
        &[
            r#"{"t":0,"way":10}"#,
            r#"{"t":1,"way":10.999999999}"#,
            r#"{"t":2,"way":11}"#,
            r#"{"t":3,"way":12.49}"#,
            r#"{"t":4,"way":13}"#,
            r#"{"t":5,"way":13.000000001}"#,
        ],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":2,"t":2.0,"state":2,"law":"drift","fired":[{"from":1,"level":2,"by":"way >= 1","operands":["way >= 1"]}]}"#,
            r#"{"turn":3,"t":3.0,"state":3,"law":"seek","fired":[{"from":2,"level":2,"by":"way == 1.5","operands":["way == 1.5"]}]}"#,
            r#"{"turn":4,"t":4.0,"state":3,"law":"seek","fired":[]}"#,
            concat!(
                r#"{"turn":5,"t":5.0,"state":5,"law":null,"fired":[{"from":3,"level":1,"by":"way > 3","operands":["way > 3"]},"#,
                r#"{"from":4,"level":1,"by":"way < 0.05","operands":["way < 0.05"]}]}"#
            ),
        ],
    );
}

#[test]
fn way_begins_anew_in_each_pass() {
    assert_trace(
        "{ Main (way >= 2.5m) (Atom (way >= 1m) idle)^inf }",
        &[r#"{"t":0}"#, r#"{"t":1,"way":1.2}"#, r#"{"t":2,"way":2.1}"#, r#"{"t":3,"way":2.2}"#, r#"{"t":4,"way":2.5}"#],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":1,"law":"idle","fired":[{"from":1,"level":1,"by":"way >= 1","operands":["way >= 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":3,"t":3.0,"state":1,"law":"idle","fired":[{"from":1,"level":1,"by":"way >= 1","operands":["way >= 1"]}]}"#,
            r#"{"turn":4,"t":4.0,"state":2,"law":null,"fired":[{"from":1,"level":0,"by":"way >= 2.5","operands":["way >= 2.5"]}]}"#,
        ],
    );
}

#[test]
fn rising_of_way_waits_until_it_was_low() {
    assert_trace(
        "{ Main (Atom (RISING way >= 1m) idle) (Atom (RISING way >= 0) drift) (Atom (NOT way < 1m AND a) climb) }",
        &[r#"{"t":0,"way":4}"#, r#"{"t":1,"way":5}"#, r#"{"t":2,"way":9}"#],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"drift","fired":[{"from":1,"level":1,"by":"RISING way >= 1","operands":["RISING way >= 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":2,"law":"drift","fired":[]}"#,
        ],
    );
}

#[test]
fn an_equal_comparison_of_way_is_another_function() {
    let compiled = compile("{ Main (way > 1m) { P (a) (Atom (way > 1m) idle) } }").unwrap();
    assert_eq!(compiled.nondegenerate.plan(), &compiled.plan);
}

#[test]
fn a_frame_here_is_the_heading_at_the_entry_of_its_element() {
    assert_trace(
        "{ Main (Atom (a) idle) FRAME here { P (Atom (b) drift) FRAME 90 (Atom (c) climb) FRAME here (Atom (d) seek) } (Atom (null) veer 90) }",
        &[
            r#"{"t":0,"heading":10}"#,
            r#"{"t":1,"heading":30,"fired":["a"]}"#,
            r#"{"t":2,"heading":50}"#,
            r#"{"t":3,"heading":70,"fired":["b"]}"#,
            r#"{"t":4,"heading":-80,"fired":["c"]}"#,
            r#"{"t":5,"heading":0}"#,
            r#"{"t":6,"heading":5,"fired":["d"]}"#,
        ],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"drift","frame":30.0,"fired":[{"from":1,"level":1,"by":"a","operands":["a"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":2,"law":"drift","frame":30.0,"fired":[]}"#,
            r#"{"turn":3,"t":3.0,"state":3,"law":"climb","frame":120.0,"fired":[{"from":2,"level":2,"by":"b","operands":["b"]}]}"#,
            r#"{"turn":4,"t":4.0,"state":4,"law":"seek","frame":-80.0,"fired":[{"from":3,"level":2,"by":"c","operands":["c"]}]}"#,
            r#"{"turn":5,"t":5.0,"state":4,"law":"seek","frame":-80.0,"fired":[]}"#,
            r#"{"turn":6,"t":6.0,"state":5,"law":"veer 90","fired":[{"from":4,"level":2,"by":"d","operands":["d"]}]}"#,
        ],
    );
}

#[test]
fn a_frame_here_is_taken_anew_in_each_pass() {
    let script = [
        r#"{"t":0,"heading":10}"#,
        r#"{"t":1,"heading":100,"fired":["a"]}"#,
        r#"{"t":2,"heading":-170,"fired":["b"]}"#,
        r#"{"t":3,"heading":20,"fired":["a"]}"#,
    ];
    // `FRAME here` before a loop is taken in each pass, as before the string of a pass. Before a string in parentheses
    // that contains the loop, it is taken once, because this string is entered once.
    for (plan, again) in [
        ("{ Main FRAME here ((Atom (a) idle) (Atom (b) drift))^2 }", "-170.0"),
        ("{ Main FRAME here ExecPlan 2 { (Atom (a) idle) (Atom (b) drift) } }", "-170.0"),
        ("{ Main (FRAME here ((Atom (a) idle) (Atom (b) drift)))^2 }", "-170.0"),
        ("{ Main FRAME here (((Atom (a) idle) (Atom (b) drift))^2) }", "10.0"),
    ] {
        let third = format!(
            r#"{{"turn":2,"t":2.0,"state":3,"law":"idle","frame":{again},"fired":[{{"from":2,"level":2,"by":"b","operands":["b"]}}]}}"#
        );
        let last = format!(
            r#"{{"turn":3,"t":3.0,"state":4,"law":"drift","frame":{again},"fired":[{{"from":3,"level":2,"by":"a","operands":["a"]}}]}}"#
        );
        assert_trace(
            plan,
            &script,
            &[
                r#"{"turn":0,"t":0.0,"state":1,"law":"idle","frame":10.0,"fired":[]}"#,
                r#"{"turn":1,"t":1.0,"state":2,"law":"drift","frame":10.0,"fired":[{"from":1,"level":2,"by":"a","operands":["a"]}]}"#,
                &third,
                &last,
            ],
        );
    }
}

#[test]
fn a_string_or_a_pass_in_a_frame_here_is_a_scope() {
    // The levels are the plan (0), the string (1) and the atom (2). An atom or a behavior in a frame adds no scope,
    // because it is a scope already.
    assert_trace(
        "{ Main FRAME here ((Atom (a) idle)) FRAME here (Atom (b) drift) FRAME here { P (c) (Atom (null) idle) } }",
        &[r#"{"t":0}"#, r#"{"t":1,"fired":["a"]}"#, r#"{"t":2,"fired":["b"]}"#, r#"{"t":3,"fired":["c"]}"#],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","frame":0.0,"fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"drift","frame":0.0,"fired":[{"from":1,"level":2,"by":"a","operands":["a"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":3,"law":"idle","frame":0.0,"fired":[{"from":2,"level":1,"by":"b","operands":["b"]}]}"#,
            r#"{"turn":3,"t":3.0,"state":4,"law":null,"fired":[{"from":3,"level":1,"by":"c","operands":["c"]}]}"#,
        ],
    );
}

/// In the turn in which the first atom ends, the law of the second atom has not run yet. The second atom is therefore
/// not stuck, although the first one was.
#[test]
fn stuck_counts_from_its_own_scope_at_the_earliest() {
    assert_trace(
        "{ Main (stuck 5) (Atom (stuck 1) seek) (Atom (stuck 1s OR b) seek) { P (RISING stuck 1) (Atom (NOT stuck inf) climb) } }",
        &[
            r#"{"t":0,"fired":["stuck 1"]}"#,
            r#"{"t":0.999999999,"fired":["stuck 1"]}"#,
            r#"{"t":1,"fired":["stuck 1"]}"#,
            r#"{"t":1.5,"fired":["stuck 1"]}"#,
            r#"{"t":3}"#,
            r#"{"t":4,"fired":["stuck 1"]}"#,
        ],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"seek","fired":[]}"#,
            r#"{"turn":1,"t":0.999999999,"state":1,"law":"seek","fired":[]}"#,
            r#"{"turn":2,"t":1.0,"state":2,"law":"seek","fired":[{"from":1,"level":1,"by":"stuck 1","operands":["stuck 1"]}]}"#,
            r#"{"turn":3,"t":1.5,"state":2,"law":"seek","fired":[]}"#,
            r#"{"turn":4,"t":3.0,"state":2,"law":"seek","fired":[]}"#,
            concat!(
                r#"{"turn":5,"t":4.0,"state":4,"law":null,"fired":[{"from":2,"level":1,"by":"stuck 1 OR b","operands":["stuck 1"]},"#,
                r#"{"from":3,"level":2,"by":"NOT stuck inf","operands":["NOT stuck inf"]}]}"#
            ),
        ],
    );
}
