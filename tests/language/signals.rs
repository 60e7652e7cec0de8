//! Tests the rules of comparisons of signals and of `t` (docs/src/reference/semantics.md, 2.4), each with a minimal
//! plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use super::assert_trace::assert_trace;

#[test]
fn a_comparison_has_fired_while_it_holds_and_is_listed_by_its_text() {
    assert_trace(
        "{ Main (Atom (r_3(t) == r_5) idle) (Atom (NOT x > 40cm OR theta <= 1rad) drift) (Atom (v < 0.5m/s) seek) }",
        &[(0.0, "x > 0.4", ""), (0.1, "r3 == r5, x > 0.4", ""), (0.2, "v < 50", ""), (0.3, "v < 50", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":2,"law":"drift","fired":[{"from":1,"level":1,"by":"r3 == r5","operands":["r3 == r5"]}]}"#,
            concat!(
                r#"{"turn":2,"t":0.2,"state":4,"law":null,"fired":["#,
                r#"{"from":2,"level":1,"by":"NOT x > 0.4 OR theta <= 57.29577951308232","operands":["NOT x > 0.4"]},{"from":3,"level":1,"by":"v < 50","operands":["v < 50"]}]}"#
            ),
        ],
    );
}

#[test]
fn a_time_without_end_is_never_over() {
    assert_trace(
        "{ Main Leg(inf) } { Leg (end: time) (t >= end) (Atom (t < inf) idle) (Atom (wait 1 OR t > inf) seek) }",
        &[(0.0, "", ""), (0.5, "", ""), (1.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":2,"law":"seek","fired":[{"from":1,"level":2,"by":"t < inf","operands":["t < inf"]}]}"#,
            r#"{"turn":1,"t":0.5,"state":2,"law":"seek","fired":[]}"#,
            r#"{"turn":2,"t":1.0,"state":3,"law":null,"fired":[{"from":2,"level":2,"by":"wait 1 OR t > inf","operands":["wait 1"]}]}"#,
        ],
    );
}

#[test]
fn t_counts_from_its_own_scope_to_the_nanosecond() {
    assert_trace(
        "{ Main { P (t > 200ms) (Atom (t >= 0.1) idle) (Atom (t == 0.1) drift) } (Atom (t < 50ms) seek) (Atom (t <= 0) climb) \
         (Atom (NOT t <= 0) idle) }",
        &[(0.0, "t > 0.2", ""), (0.1, "", ""), (0.2, "", ""), (0.200000001, "", ""), (0.3, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":2,"law":"drift","fired":[{"from":1,"level":2,"by":"t >= 0.1","operands":["t >= 0.1"]}]}"#,
            concat!(
                r#"{"turn":2,"t":0.2,"state":5,"law":"idle","fired":[{"from":2,"level":2,"by":"t == 0.1","operands":["t == 0.1"]},"#,
                r#"{"from":3,"level":1,"by":"t < 0.05","operands":["t < 0.05"]},{"from":4,"level":1,"by":"t <= 0","operands":["t <= 0"]}]}"#
            ),
            r#"{"turn":3,"t":0.200000001,"state":6,"law":null,"fired":[{"from":5,"level":1,"by":"NOT t <= 0","operands":["NOT t <= 0"]}]}"#,
        ],
    );
}

#[test]
fn an_equal_comparison_of_an_outer_scope_wins_and_one_of_t_is_another_function() {
    assert_trace(
        "{ Main (x > 1) { P (t > 0.1) (Atom (x > 100cm OR t > 0.1) idle) (Atom (x > 1m) drift) (Atom (t > 0.1) climb) } \
         (Atom (null) seek) }",
        &[(0.0, "", ""), (0.05, "", "seek"), (0.100000001, "", ""), (0.2, "x > 1", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.05,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":2,"t":0.100000001,"state":4,"law":"seek","fired":[{"from":1,"level":1,"by":"t > 0.1","operands":["t > 0.1"]}]}"#,
            r#"{"turn":3,"t":0.2,"state":5,"law":null,"fired":[{"from":4,"level":0,"by":"x > 1","operands":["x > 1"]}]}"#,
        ],
    );
}
