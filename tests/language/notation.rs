//! Tests that formal notation (docs/src/reference/language.md, 3.2) has the same meaning as the notation of the
//! experiments.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use super::assert_trace::assert_trace;
use mdle_tests::pipeline::compile_plan;

#[test]
fn the_papers_example_is_a_scope_with_a_timer_and_three_passes() {
    for plan in [
        "{ Main ((idle, a)(drift, b), c, 10s)^3 }",
        "{ Main (((idle, a), (drift, b)), c, 10s)^3 }",
        "{ Main ExecPlan 3 { { Inner (c OR wait 10) (Atom (a) idle) (Atom (b) drift) } } }",
    ] {
        assert_trace(
            plan,
            &[(0.0, "", ""), (1.0, "a", ""), (11.0, "b", ""), (12.0, "a, c", ""), (20.0, "b", ""), (22.0, "", "")],
            &[
                r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
                r#"{"turn":1,"t":1.0,"state":2,"law":"drift","fired":[{"from":1,"level":2,"by":"a","operands":["a"]}]}"#,
                r#"{"turn":2,"t":11.0,"state":3,"law":"idle","fired":[{"from":2,"level":1,"by":"c OR wait 10","operands":["wait 10"]}]}"#,
                concat!(
                    r#"{"turn":3,"t":12.0,"state":7,"law":null,"fired":["#,
                    r#"{"from":3,"level":1,"by":"c OR wait 10","operands":["c"]},{"from":5,"level":1,"by":"c OR wait 10","operands":["c"]}]}"#
                ),
            ],
        );
    }
}

#[test]
fn a_timer_is_the_last_operand_and_may_be_a_cause() {
    assert_trace(
        "{ Main s1: (idle, a OR b, 1) (drift, NOT (after s1 (wait 1000ms))) s2: ((seek, null), null, 2s) (climb, after s2 (wait 2)) (idle, null) }",
        &[(0.0, "", ""), (1.0, "", ""), (1.5, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"drift","fired":[{"from":1,"level":1,"by":"a OR b OR wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":2,"t":1.5,"state":2,"law":"drift","fired":[]}"#,
        ],
    );
    assert_trace(
        "{ Main s2: ((seek, null), null, 2s) (climb, after s2 (wait 2)) (idle, null) }",
        &[(0.0, "", ""), (2.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"seek","fired":[]}"#,
            concat!(
                r#"{"turn":1,"t":2.0,"state":3,"law":"idle","fired":["#,
                r#"{"from":1,"level":1,"by":"wait 2","operands":["wait 2"]},{"from":2,"level":1,"by":"after s2 wait 2","operands":["after s2 wait 2"]}]}"#
            ),
        ],
    );
}

#[test]
fn a_string_before_sigma_null_is_a_plan() {
    let formal = |text: &str| compile_plan(text, "Plan").unwrap().plan.formal();
    for bare in ["((idle, a)(drift, b), c, 10s)^3 σ_null", "(((idle, a), (drift, b)), c, 10s)^3 \\sigma_{null}"] {
        assert_eq!(formal(bare), formal("{ Plan ((idle, a)(drift, b), c, 10s)^3 }"), "{bare}");
    }
    assert!(compile_plan("((idle, a)(drift, b), c, 10s)^3", "Plan").unwrap_err().contains("E0102"));
    assert!(compile_plan("σ_null", "Plan").unwrap_err().contains("E0102"));
}
