//! Tests the rules of plans with parameters (docs/src/reference/language.md, 3.4), each with a minimal plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use super::assert_trace::assert_trace;

#[test]
fn each_use_of_a_plan_is_a_copy_with_what_it_is_given() {
    assert_trace(
        "{ Main Leg(2, 20cm/s, 1) Leg(1, 0.5, 500ms) } { Leg (n: count, v: speed, T: time) ((Atom (faster v) drive v) (Atom (wait T) idle))^n }",
        &[(0.0, "faster 20", ""), (1.0, "", ""), (2.0, "faster 20", ""), (3.0, "faster 0.5", ""), (3.5, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":2,"law":"idle","fired":[{"from":1,"level":2,"by":"faster 20","operands":["faster 20"]}]}"#,
            r#"{"turn":1,"t":1.0,"state":3,"law":"drive 20 0","fired":[{"from":2,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":4,"law":"idle","fired":[{"from":3,"level":2,"by":"faster 20","operands":["faster 20"]}]}"#,
            concat!(
                r#"{"turn":3,"t":3.0,"state":6,"law":"idle","fired":["#,
                r#"{"from":4,"level":2,"by":"wait 1","operands":["wait 1"]},{"from":5,"level":2,"by":"faster 0.5","operands":["faster 0.5"]}]}"#
            ),
            r#"{"turn":4,"t":3.5,"state":7,"law":null,"fired":[{"from":6,"level":2,"by":"wait 0.5","operands":["wait 0.5"]}]}"#,
        ],
    );
}

#[test]
fn a_count_by_name_may_be_infinite_and_is_handed_on() {
    assert_trace(
        "{ Main (c) Round(inf, 2) } { Round (n: count, m: count) Twice(m)^n } { Twice (n: count) ExecPlan n { (Atom (a) idle) } }",
        &[(0.0, "a", ""), (0.1, "c", "")],
        &[
            &format!(
                r#"{{"turn":0,"t":0.0,"state":1,"law":null,"fired":[{}]}}"#,
                (0..4096)
                    .map(|made| format!(r#"{{"from":{},"level":3,"by":"a","operands":["a"]}}"#, 1 + made % 2))
                    .collect::<Vec<_>>()
                    .join(",")
            ),
            r#"{"turn":1,"t":0.1,"state":3,"law":null,"fired":[{"from":1,"level":0,"by":"c","operands":["c"]}]}"#,
        ],
    );
}
