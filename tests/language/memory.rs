//! Tests the rules of RISING (docs/src/reference/semantics.md, 2.2) and of `after` (docs/src/reference/semantics.md,
//! 2.3), each with a minimal plan.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use super::assert_trace::{Turn, assert_trace};
use mdle_compiler::trace::COMPLETED;

/// Returns a line of a trace. `fired` contains the transitions, each with the state that was left, the level, and the
/// condition. The operands that have fired follow the condition if they are only a part of it, as in `a OR b | b`.
fn line(turn: usize, t: &str, state: u64, law: Option<&str>, fired: &[(u64, usize, &str)]) -> String {
    let law = law.map_or("null".to_owned(), |law| format!("{law:?}"));
    let fired = fired.iter().map(|(from, level, by)| {
        let (by, operands) = by.split_once(" | ").unwrap_or((by, by));
        let operands: Vec<_> = operands.split(", ").filter(|operand| *operand != COMPLETED).collect();
        format!("{{\"from\":{from},\"level\":{level},\"by\":{by:?},\"operands\":{operands:?}}}")
            .replace("\", \"", "\",\"")
    });
    let fired: Vec<_> = fired.collect();
    format!("{{\"turn\":{turn},\"t\":{t},\"state\":{state},\"law\":{law},\"fired\":[{}]}}", fired.join(","))
}

/// An expected line of a trace: the state, the law, and the transitions, each with the state that was left, the level
/// and the cause.
type Expected<'t> = (u64, Option<&'t str>, &'t [(u64, usize, &'t str)]);

/// Asserts the behavior of a plan in turns at 0, 1, 2 … seconds. `turns` contains the interrupts that fire and the laws
/// that complete in each turn.
fn assert_turns(plan: &str, turns: &[(&'static str, &'static str)], expected: &[Expected<'_>]) {
    let script: Vec<Turn> =
        turns.iter().enumerate().map(|(turn, (fired, completed))| (turn as f64, *fired, *completed)).collect();
    let lines: Vec<_> = expected
        .iter()
        .enumerate()
        .map(|(turn, (state, law, fired))| line(turn, &format!("{turn}.0"), *state, *law, fired))
        .collect();
    let lines: Vec<_> = lines.iter().map(String::as_str).collect();
    assert_trace(plan, &script, &lines);
}

#[test]
fn rising_fires_only_once_it_has_not_fired_since_its_scope_was_entered() {
    assert_turns(
        "{ Main (Atom (RISING a) idle)^2 (Atom (null) drift) }",
        &[("a", ""), ("a", ""), ("", ""), ("a", ""), ("a", ""), ("", ""), ("", ""), ("a", "")],
        &[
            (1, Some("idle"), &[]),
            (1, Some("idle"), &[]),
            (1, Some("idle"), &[]),
            (2, Some("idle"), &[(1, 1, "RISING a")]),
            (2, Some("idle"), &[]),
            (2, Some("idle"), &[]),
            (2, Some("idle"), &[]),
            (3, Some("drift"), &[(2, 1, "RISING a")]),
        ],
    );
}

#[test]
fn rising_of_an_outer_scope_remembers_over_its_atoms() {
    assert_turns(
        "{ Main (RISING (a AND NOT d) OR RISING e) (Atom (b) idle) (Atom (c) drift) }",
        &[("e", ""), ("b, a, d, e", ""), ("d", ""), ("a", "")],
        &[
            (1, Some("idle"), &[]),
            (2, Some("drift"), &[(1, 1, "b")]),
            (2, Some("drift"), &[]),
            (3, None, &[(2, 0, "RISING (a AND NOT d) OR RISING e | RISING (a AND NOT d)")]),
        ],
    );
}

#[test]
fn rising_in_rising_and_under_not() {
    assert_turns(
        "{ Main (Atom (RISING (RISING a OR b)) idle) (Atom (NOT (RISING a)) drift) (Atom (c) seek) }",
        &[("b", ""), ("", ""), ("a", ""), ("", "")],
        &[
            (1, Some("idle"), &[]),
            (1, Some("idle"), &[]),
            (3, Some("seek"), &[(1, 1, "RISING (RISING a OR b)"), (2, 1, "NOT (RISING a)")]),
            (3, Some("seek"), &[]),
        ],
    );
}

#[test]
fn an_operand_is_remembered_whatever_the_others_say() {
    // In the first turn neither `c` nor `d` has fired, but the operands of RISING beside them are evaluated anyway.
    assert_turns(
        "{ Main (Atom (c AND RISING b OR d AND RISING a) idle) (Atom (NOT (e OR RISING b)) drift) (Atom (null) seek) }",
        &[("", ""), ("b", ""), ("b, c, e", ""), ("e", ""), ("b", ""), ("", "")],
        &[
            (1, Some("idle"), &[]),
            (1, Some("idle"), &[]),
            (2, Some("drift"), &[(1, 1, "c AND RISING b OR d AND RISING a | c, RISING b")]),
            (2, Some("drift"), &[]),
            // The memory of RISING was set in the turn before, in which `b` had not fired, although `e` had.
            (2, Some("drift"), &[]),
            (3, Some("seek"), &[(2, 1, "NOT (e OR RISING b)")]),
        ],
    );
}

#[test]
fn a_turn_that_the_limit_cuts_sets_the_memory_as_well() {
    let cut: Vec<(u64, usize, &str)> = (0..4096).map(|_| (1, 1, "a")).collect();
    assert_turns(
        "{ Main (RISING b) ExecPlan inf { (Atom (a) idle) } }",
        &[("a", ""), ("a, b", "")],
        &[(1, None, &cut), (2, None, &[(1, 0, "RISING b")])],
    );
}

const FIGURE_4: &str = "{ Main s1: (Atom (a OR b) idle) (Atom (c OR NOT (after s1 a)) drift) (Atom (d OR NOT (after s1 b)) seek) \
                        (Atom (null) climb) }";

#[test]
fn after_tells_which_operand_ended_an_element_the_first_as_written() {
    assert_turns(
        FIGURE_4,
        &[("", ""), ("b, a", ""), ("c", "")],
        &[
            (1, Some("idle"), &[]),
            (2, Some("drift"), &[(1, 1, "a OR b | a, b")]),
            (4, Some("climb"), &[(2, 1, "c OR NOT after s1 a | c"), (3, 1, "d OR NOT after s1 b | NOT after s1 b")]),
        ],
    );
    assert_turns(
        FIGURE_4,
        &[("b", ""), ("d", "")],
        &[
            (3, Some("seek"), &[(1, 1, "a OR b | b"), (2, 1, "c OR NOT after s1 a | NOT after s1 a")]),
            (4, Some("climb"), &[(3, 1, "d OR NOT after s1 b | d")]),
        ],
    );
}

#[test]
fn an_element_ends_by_completion_and_with_its_last_element_too() {
    let plan = "{ Main L: { P (b) M: (Atom (a OR c) seek) } (Atom (after L b OR after M a) idle) (Atom (after L AND after M) drift) \
                (Atom (null) climb) }";
    // By completion, both elements end, neither of them by an operand of its own interrupt.
    assert_turns(plan, &[("", "seek")], &[(2, Some("idle"), &[(1, 2, "completed")])]);
    // The operand of the inner interrupt is the cause of the inner element's end, but not of the outer element's.
    assert_turns(
        plan,
        &[("a", "")],
        &[(
            4,
            Some("climb"),
            &[
                (1, 2, "a OR c | a"),
                (2, 1, "after L b OR after M a | after M a"),
                (3, 1, "after L AND after M | after L, after M"),
            ],
        )],
    );
    // The inner element is left by the enclosing scope, so it has not ended.
    assert_turns(
        plan,
        &[("b", "")],
        &[(3, Some("drift"), &[(1, 1, "b"), (2, 1, "after L b OR after M a | after L b")])],
    );
}

#[test]
fn a_loop_ends_with_its_last_pass_and_a_string_with_its_last_element() {
    let plan = "{ Main L: ((Atom (a OR after L) idle) (Atom (b) drift))^2 N: ((Atom (c) seek) (Atom (after L) climb)) (Atom (after N) idle) \
                (Atom (null) drift) }";
    assert_turns(
        plan,
        &[("a, b", ""), ("c", "")],
        &[
            (5, Some("seek"), &[(1, 1, "a OR after L | a"), (2, 1, "b"), (3, 1, "a OR after L | a"), (4, 1, "b")]),
            (8, Some("drift"), &[(5, 1, "c"), (6, 1, "after L"), (7, 1, "after N")]),
        ],
    );
}

#[test]
fn every_transition_that_ends_labelled_elements_replaces_the_record() {
    // The record is replaced neither by the end of an element without a label, nor by that of a label that no `after`
    // reads.
    assert_turns(
        "{ Main s1: (Atom (a) idle) (Atom (b) idle) (Atom (NOT after s1) drift) s2: (Atom (c) seek) (Atom (after s1) climb) }",
        &[("a, b", ""), ("", ""), ("c", "")],
        &[(3, Some("drift"), &[(1, 1, "a"), (2, 1, "b")]), (3, Some("drift"), &[]), (3, Some("drift"), &[])],
    );
    assert_turns(
        "{ Main s1: (Atom (a) idle) (Atom (after s1) drift) s2: (Atom (c) seek) (Atom (NOT after s1) climb) (Atom (after s1) idle) }",
        &[("a, c", "")],
        &[(5, Some("idle"), &[(1, 1, "a"), (2, 1, "after s1"), (3, 1, "c"), (4, 1, "NOT after s1")])],
    );
}

#[test]
fn each_use_of_a_plan_has_a_record_that_is_empty_when_it_is_entered() {
    assert_turns(
        "{ Main P P L: Q (Atom (NOT after L) climb) (Atom (after L) idle) (Atom (null) seek) }
         { P (Atom (after s OR b) drift) { In s: (Atom (a) idle) } (Atom (after s) seek) }
         { Q L: (Atom (c) idle) (Atom (NOT after L OR d) idle) }",
        &[("b, a", ""), ("c", ""), ("d", "")],
        &[
            (
                7,
                Some("idle"),
                &[
                    (1, 2, "after s OR b | b"),
                    (2, 3, "a"),
                    (3, 2, "after s"),
                    (4, 2, "after s OR b | b"),
                    (5, 3, "a"),
                    (6, 2, "after s"),
                ],
            ),
            (8, Some("idle"), &[(7, 2, "c")]),
            (9, Some("climb"), &[(8, 2, "NOT after L OR d | d")]),
        ],
    );
    assert_turns(
        "{ Main ExecPlan 2 P (Atom (null) climb) } { P (Atom (after s OR b) drift) s: (Atom (a) idle) }",
        &[("b, a", ""), ("a", "")],
        &[
            (5, Some("climb"), &[(1, 2, "after s OR b | b"), (2, 2, "a"), (3, 2, "after s OR b | b"), (4, 2, "a")]),
            (5, Some("climb"), &[]),
        ],
    );
    // Each use of a plan has its own record: only this record lets the second use continue.
    assert_turns(
        "{ Main ExecPlan 2 P } { P (Atom (after s OR b) drift) s: (Atom (a) idle) }",
        &[("b, a", ""), ("", "")],
        &[(5, None, &[(1, 2, "after s OR b | b"), (2, 2, "a"), (3, 2, "after s OR b | b"), (4, 2, "a")])],
    );
    assert_turns(
        "{ Main ExecPlan 2 P } { P (Atom (after s OR RISING b) drift) s: (Atom (a) idle) }",
        &[("", ""), ("b, a", ""), ("", "")],
        &[
            (1, Some("drift"), &[]),
            (3, Some("drift"), &[(1, 2, "after s OR RISING b | RISING b"), (2, 2, "a")]),
            (3, Some("drift"), &[]),
        ],
    );
}
