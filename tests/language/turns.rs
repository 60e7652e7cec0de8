//! Tests the rules of turns, time and completion (docs/src/reference/semantics.md, 2 to 5), each with a minimal plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use super::assert_trace::assert_trace;

#[test]
fn outer_interrupt_wins() {
    assert_trace(
        "{ Main (a) { Inner (b) (Atom (c) idle) } (Atom (null) drift) }",
        &[(0.0, "", ""), (0.1, "c, b, a", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":3,"law":null,"fired":[{"from":1,"level":0,"by":"a","operands":["a"]}]}"#,
        ],
    );
    assert_trace(
        "{ Main (a) { Inner (b) (Atom (c) idle) (Atom (c) seek) } (Atom (null) drift) }",
        &[(0.0, "c, b", "")],
        &[r#"{"turn":0,"t":0.0,"state":3,"law":"drift","fired":[{"from":1,"level":1,"by":"b","operands":["b"]}]}"#],
    );
}

#[test]
fn a_skipped_atom_is_never_computed() {
    assert_trace(
        "{ Main (Atom (a) idle) (Atom (b) drift) (Atom (c) seek) }",
        &[(0.0, "a, b", "")],
        &[concat!(
            r#"{"turn":0,"t":0.0,"state":3,"law":"seek","#,
            r#""fired":[{"from":1,"level":1,"by":"a","operands":["a"]},{"from":2,"level":1,"by":"b","operands":["b"]}]}"#
        )],
    );
}

#[test]
fn a_plan_whose_interrupt_has_fired_is_over_in_its_first_turn() {
    assert_trace(
        "{ Main (a) (Atom (b) idle) (Atom (c) drift) }",
        &[(0.0, "a", ""), (0.1, "", "")],
        &[r#"{"turn":0,"t":0.0,"state":3,"law":null,"fired":[{"from":1,"level":0,"by":"a","operands":["a"]}]}"#],
    );
}

#[test]
fn completion_is_read_on_entry() {
    assert_trace(
        "{ Main (Atom (a) idle) (Atom (b) seek) (Atom (c) drift) }",
        &[(0.0, "", "seek"), (0.1, "a", "seek")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            concat!(
                r#"{"turn":1,"t":0.1,"state":3,"law":"drift","#,
                r#""fired":[{"from":1,"level":1,"by":"a","operands":["a"]},{"from":2,"level":1,"by":"completed","operands":[]}]}"#
            ),
        ],
    );
}

#[test]
fn a_law_that_never_completes_cannot_be_completed_by_a_script() {
    assert_trace(
        "{ Main (Atom (a) idle) }",
        &[(0.0, "", "idle"), (0.1, "a", "idle")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":2,"law":null,"fired":[{"from":1,"level":1,"by":"a","operands":["a"]}]}"#,
        ],
    );
}

#[test]
fn the_interrupt_is_named_when_completion_coincides() {
    assert_trace(
        "{ Main { P (b) (Atom (a) seek) (Atom (null) climb) } (Atom (null) drift) }",
        &[(0.0, "a", "seek"), (0.1, "b", "climb")],
        &[
            r#"{"turn":0,"t":0.0,"state":2,"law":"climb","fired":[{"from":1,"level":2,"by":"a","operands":["a"]}]}"#,
            r#"{"turn":1,"t":0.1,"state":3,"law":"drift","fired":[{"from":2,"level":1,"by":"b","operands":["b"]}]}"#,
        ],
    );
}

#[test]
fn conditions_combine_what_has_fired() {
    assert_trace(
        "{ Main (Atom (a OR b AND NOT c) idle) (Atom (NOT (a OR wait 1)) drift) (Atom (NOT wait 1) seek) (Atom (null) climb) }",
        &[(0.0, "b, c", ""), (0.5, "b, a, c", ""), (1.0, "a", ""), (1.25, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.5,"state":2,"law":"drift","fired":[{"from":1,"level":1,"by":"a OR b AND NOT c","operands":["a","b"]}]}"#,
            r#"{"turn":2,"t":1.0,"state":2,"law":"drift","fired":[]}"#,
            concat!(
                r#"{"turn":3,"t":1.25,"state":4,"law":"climb","fired":[{"from":2,"level":1,"by":"NOT (a OR wait 1)","operands":["NOT (a OR wait 1)"]},"#,
                r#"{"from":3,"level":1,"by":"NOT wait 1","operands":["NOT wait 1"]}]}"#
            ),
        ],
    );
}

#[test]
fn wait_counts_from_its_own_scope() {
    assert_trace(
        "{ Main (wait 3) { P (wait 2) (Atom (wait 1) idle) (Atom (wait 1.5) drift) } (Atom (null) climb) }",
        &[(0.0, "", ""), (1.0, "", ""), (2.0, "", ""), (3.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"drift","fired":[{"from":1,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":3,"law":"climb","fired":[{"from":2,"level":1,"by":"wait 2","operands":["wait 2"]}]}"#,
            r#"{"turn":3,"t":3.0,"state":4,"law":null,"fired":[{"from":3,"level":0,"by":"wait 3","operands":["wait 3"]}]}"#,
        ],
    );
}

#[test]
fn wait_is_over_to_the_nanosecond_and_wait_inf_never() {
    assert_trace(
        "{ Main (Atom (wait 0) idle) (Atom (wait 100ms) drift) (Atom (wait inf) seek) }",
        &[(5.0, "", ""), (5.099999999, "", ""), (5.1, "", ""), (1e9, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":2,"law":"drift","fired":[{"from":1,"level":1,"by":"wait 0","operands":["wait 0"]}]}"#,
            r#"{"turn":1,"t":0.099999999,"state":2,"law":"drift","fired":[]}"#,
            r#"{"turn":2,"t":0.1,"state":3,"law":"seek","fired":[{"from":2,"level":1,"by":"wait 0.1","operands":["wait 0.1"]}]}"#,
            r#"{"turn":3,"t":999999995.0,"state":3,"law":"seek","fired":[]}"#,
        ],
    );
}

#[test]
fn a_removed_interrupt_changes_no_trace() {
    assert_trace(
        "{ Main (a OR b) { P (b or a) (Atom (a OR b) seek) } (Atom (b OR a OR b) drift) }",
        &[(0.0, "", ""), (0.1, "", "seek"), (0.2, "b", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"seek","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":2,"law":"drift","fired":[{"from":1,"level":2,"by":"completed","operands":[]}]}"#,
            r#"{"turn":2,"t":0.2,"state":3,"law":null,"fired":[{"from":2,"level":0,"by":"a OR b","operands":["b"]}]}"#,
        ],
    );
}

#[test]
fn four_hundred_scopes_around_an_atom_are_all_read_in_one_turn() {
    let inner = (1..400).map(|level| format!("{{ P{level} (b) P{} }}\n", level + 1));
    let plan =
        format!("{{ Main (b) P1 (Atom (null) drift) }}\n{}{{ P400 (c) (Atom (a) idle) }}", inner.collect::<String>());
    assert_trace(
        &plan,
        &[(0.0, "", ""), (0.1, "a, c", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.1,"state":2,"law":"drift","fired":[{"from":1,"level":400,"by":"c","operands":["c"]}]}"#,
        ],
    );
}
