//! Tests the rules of loops (docs/src/reference/semantics.md, 6) and of the limit of a turn
//! (docs/src/reference/semantics.md, 5.5), each with a minimal plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;

use super::assert_trace::assert_trace;

#[test]
fn loops_run_exactly_n_times() {
    assert_trace(
        "{ Main (Atom (wait 1) idle)^3 (Atom (null) drift) }",
        &[(0.0, "", ""), (1.0, "", ""), (2.0, "", ""), (3.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"idle","fired":[{"from":1,"level":1,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":3,"law":"idle","fired":[{"from":2,"level":1,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":3,"t":3.0,"state":4,"law":"drift","fired":[{"from":3,"level":1,"by":"wait 1","operands":["wait 1"]}]}"#,
        ],
    );
    assert_trace(
        "{ Main ExecPlan 1 { (Atom (a) idle) } }",
        &[(0.0, "a", "")],
        &[r#"{"turn":0,"t":0.0,"state":2,"law":null,"fired":[{"from":1,"level":1,"by":"a","operands":["a"]}]}"#],
    );
}

#[test]
fn loops_in_loops_multiply_also_where_a_scope_ends_both() {
    let after = |from: u64, to: u64, law: &str, level: u64, turn: u64| {
        format!(
            r#"{{"turn":{turn},"t":{turn}.0,"state":{to},"law":{law},"fired":[{{"from":{from},"level":{level},"by":"wait 1","operands":["wait 1"]}}]}}"#
        )
    };
    let seek = r#""seek""#;
    assert_trace(
        "{ Main ((Atom (wait 1) idle) ({ P (wait 1) (Atom (wait 2) seek) })^2)^2 }",
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(|t| (t, "", "")),
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            &after(1, 2, seek, 1, 1),
            &after(2, 3, seek, 1, 2),
            &after(3, 4, r#""idle""#, 1, 3),
            &after(4, 5, seek, 1, 4),
            &after(5, 6, seek, 1, 5),
            &after(6, 7, "null", 1, 6),
        ],
    );
}

#[test]
fn an_interrupt_around_a_loop_leaves_it() {
    assert_trace(
        "{ Main { P (a AND wait 0.5) (Atom (wait 1) idle)^3 } (Atom (null) drift) }",
        &[(0.0, "", ""), (0.5, "a", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.5,"state":4,"law":"drift","fired":[{"from":1,"level":1,"by":"a AND wait 0.5","operands":["a","wait 0.5"]}]}"#,
        ],
    );
}

#[test]
fn an_interrupt_inside_a_loop_starts_the_next_pass() {
    assert_trace(
        "{ Main ({ P (a AND wait 0.5) (Atom (wait 1) idle) })^3 (Atom (null) drift) }",
        &[(0.0, "", ""), (0.5, "a", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.5,"state":2,"law":"idle","fired":[{"from":1,"level":1,"by":"a AND wait 0.5","operands":["a","wait 0.5"]}]}"#,
        ],
    );
}

#[test]
fn a_behavior_that_ends_a_pass_starts_afresh() {
    assert_trace(
        "{ Main ({ P (wait 1) (Atom (a AND wait 0.2) idle) })^2 (Atom (null) drift) }",
        &[(0.0, "", ""), (0.5, "a", ""), (1.4, "", ""), (1.5, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":0.5,"state":2,"law":"idle","fired":[{"from":1,"level":2,"by":"a AND wait 0.2","operands":["a","wait 0.2"]}]}"#,
            r#"{"turn":2,"t":1.4,"state":2,"law":"idle","fired":[]}"#,
            r#"{"turn":3,"t":1.5,"state":3,"law":"drift","fired":[{"from":2,"level":1,"by":"wait 1","operands":["wait 1"]}]}"#,
        ],
    );
}

#[test]
fn a_loop_that_is_entered_again_has_all_its_passes() {
    assert_trace(
        "{ Main ({ P (b) (Atom (wait 1) idle)^2 (Atom (a) drift) })^2 (Atom (null) seek) }",
        &[(0.0, "", ""), (1.0, "", ""), (1.0, "a, b", ""), (1.5, "", ""), (2.0, "", ""), (3.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"idle","fired":[{"from":1,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            concat!(
                r#"{"turn":2,"t":1.0,"state":7,"law":"seek","#,
                r#""fired":[{"from":2,"level":1,"by":"b","operands":["b"]},{"from":4,"level":1,"by":"b","operands":["b"]}]}"#
            ),
            r#"{"turn":3,"t":1.5,"state":7,"law":"seek","fired":[]}"#,
            r#"{"turn":4,"t":2.0,"state":7,"law":"seek","fired":[]}"#,
            r#"{"turn":5,"t":3.0,"state":7,"law":"seek","fired":[]}"#,
        ],
    );
    assert_trace(
        "{ Main ({ P (null) (Atom (wait 1) idle)^2 (Atom (a) drift) })^inf }",
        &[(0.0, "", ""), (1.0, "", ""), (2.0, "a", ""), (3.0, "", ""), (4.0, "", "")],
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":2,"law":"idle","fired":[{"from":1,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            concat!(
                r#"{"turn":2,"t":2.0,"state":1,"law":"idle","#,
                r#""fired":[{"from":2,"level":2,"by":"wait 1","operands":["wait 1"]},{"from":3,"level":2,"by":"a","operands":["a"]}]}"#
            ),
            r#"{"turn":3,"t":3.0,"state":2,"law":"idle","fired":[{"from":1,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":4,"t":4.0,"state":3,"law":"drift","fired":[{"from":2,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
        ],
    );
}

#[test]
fn passes_of_a_loop_without_end_share_their_states() {
    let line = |turn: usize, state: u64, law: &str, from: u64| {
        format!(
            r#"{{"turn":{turn},"t":{turn}.0,"state":{state},"law":"{law}","fired":[{{"from":{from},"level":1,"by":"wait 1","operands":["wait 1"]}}]}}"#
        )
    };
    assert_trace(
        "{ Main (Atom (wait 1) idle) ((Atom (wait 1) drift) (Atom (wait 1) seek)^2)^inf }",
        &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|t| (t, "", "")),
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            &line(1, 2, "drift", 1),
            &line(2, 3, "seek", 2),
            &line(3, 4, "seek", 3),
            &line(4, 2, "drift", 4),
            &line(5, 3, "seek", 2),
        ],
    );
    assert_trace(
        "{ Main ({ P (wait 2) (Atom (wait 1) idle)^inf })^2 }",
        &[0.0, 1.0, 2.0, 3.0, 4.0].map(|t| (t, "", "")),
        &[
            r#"{"turn":0,"t":0.0,"state":1,"law":"idle","fired":[]}"#,
            r#"{"turn":1,"t":1.0,"state":1,"law":"idle","fired":[{"from":1,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":2,"t":2.0,"state":2,"law":"idle","fired":[{"from":1,"level":1,"by":"wait 2","operands":["wait 2"]}]}"#,
            r#"{"turn":3,"t":3.0,"state":2,"law":"idle","fired":[{"from":2,"level":2,"by":"wait 1","operands":["wait 1"]}]}"#,
            r#"{"turn":4,"t":4.0,"state":3,"law":null,"fired":[{"from":2,"level":1,"by":"wait 2","operands":["wait 2"]}]}"#,
        ],
    );
}

/// Returns the list `fired` of transitions by the interrupt `a`, from atoms of level 1.
fn by_a(from: impl Iterator<Item = u64>) -> String {
    let mut list = String::new();
    for from in from {
        let comma = if list.is_empty() { "" } else { "," };
        write!(list, r#"{comma}{{"from":{from},"level":1,"by":"a","operands":["a"]}}"#).unwrap();
    }
    list
}

#[test]
fn an_infinite_loop_is_cut_at_the_limit() {
    assert_trace(
        "{ Main (Atom (a) idle)^inf }",
        &[(0.0, "a", ""), (0.1, "", "")],
        &[
            &format!(r#"{{"turn":0,"t":0.0,"state":1,"law":null,"fired":[{}]}}"#, by_a((0..4096).map(|_| 1))),
            r#"{"turn":1,"t":0.1,"state":1,"law":"idle","fired":[]}"#,
        ],
    );
}

#[test]
fn a_search_that_was_cut_goes_on_from_where_it_stopped() {
    let first = by_a(1..=4096);
    assert_trace(
        "{ Main (Atom (a) idle)^4097 (Atom (null) drift) }",
        &[(0.0, "a", ""), (0.1, "", ""), (0.2, "a", "")],
        &[
            &format!(r#"{{"turn":0,"t":0.0,"state":4097,"law":null,"fired":[{first}]}}"#),
            r#"{"turn":1,"t":0.1,"state":4097,"law":"idle","fired":[]}"#,
            &format!(r#"{{"turn":2,"t":0.2,"state":4098,"law":"drift","fired":[{}]}}"#, by_a(4097..=4097)),
        ],
    );
}

#[test]
fn a_turn_of_exactly_the_limit_is_not_cut() {
    let all = by_a(1..=4096);
    assert_trace(
        "{ Main (Atom (a) idle)^4096 (Atom (null) drift) }",
        &[(0.0, "a", "")],
        &[&format!(r#"{{"turn":0,"t":0.0,"state":4097,"law":"drift","fired":[{all}]}}"#)],
    );
    assert_trace(
        "{ Main (Atom (a) idle)^4096 }",
        &[(0.0, "a", ""), (0.1, "a", "")],
        &[&format!(r#"{{"turn":0,"t":0.0,"state":4097,"law":null,"fired":[{all}]}}"#)],
    );
}

#[test]
fn a_law_that_is_done_can_be_what_the_limit_cuts() {
    let completions = vec![r#"{"from":1,"level":1,"by":"completed","operands":[]}"#; 4096].join(",");
    assert_trace(
        "{ Main ExecPlan inf { (Atom (null) seek) } }",
        &[(0.0, "", "seek"), (0.1, "", "")],
        &[
            &format!(r#"{{"turn":0,"t":0.0,"state":1,"law":null,"fired":[{completions}]}}"#),
            r#"{"turn":1,"t":0.1,"state":1,"law":"seek","fired":[]}"#,
        ],
    );
}
