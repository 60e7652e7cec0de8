//! Tests FSM files of endless loops. The expected transitions were derived by hand from the rules
//! (docs/src/reference/semantics.md, 8.3).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::fsm::{FsmFile, fsm_file};
use mdle_tests::golden::judge;
use mdle_tests::repository::TextFile;

fn file(plan: &str) -> FsmFile {
    let plan = TextFile { path: "plan.mdle".into(), text: plan.into() };
    let (compiled, message) = judge(&plan, None);
    assert_eq!(compiled.len(), 1, "{}: {message}", plan.text);
    fsm_file(&compiled[0].nondegenerate).unwrap()
}

/// Asserts the states in the FSM file of a plan, and a line for each interrupt, with its name, text and transitions.
fn assert_moves(plan: &str, states: &[&str], expected: &[&str]) {
    let file = file(plan);
    assert_eq!(file.states, states, "{plan}");
    let interrupts = file.interrupts.iter().map(|interrupt| {
        let moves: Vec<_> = interrupt.moves.0.iter().map(|(from, to)| format!("{from}→{to}")).collect();
        format!("{} = {}: {}", interrupt.name, interrupt.text, moves.join(" "))
    });
    assert_eq!(interrupts.collect::<Vec<_>>(), expected, "{plan}");
}

#[test]
fn the_last_of_a_loop_without_end_goes_to_its_first() {
    assert_moves(
        "{ P (bumper) (Atom (wait 1) stop) ((Atom (wait 2) stop) { B (atIsection 1000) (Atom (wait 3) stop) \
         (Atom (sync ada OR wait 4) stop) })^inf }",
        &["a1", "a2", "a3", "a4", "end"],
        &[
            "x1 = bumper: a1→end a2→end a3→end a4→end",
            "x2 = wait 1: a1→a2",
            "x3 = wait 2: a2→a3",
            // B ends together with a pass of the loop: the next pass begins.
            "x4 = atIsection 1000: a3→a2 a4→a2",
            "x5 = wait 3: a3→a4",
            "x6 = sync ada OR wait 4: a4→a2",
        ],
    );
}

#[test]
fn a_finite_loop_in_one_without_end_is_written_out() {
    assert_moves(
        "{ P (bumper) ((Atom (wait 1) stop)^2 { B (wait 9) (Atom (wait 2) stop) (Atom (wait 6) rotate 90)^2 \
         })^inf (Atom (wait 5) stop) }",
        &["a1", "a2", "a3", "a4", "a5", "a6", "end"],
        &[
            "x1 = bumper: a1→end a2→end a3→end a4→end a5→end a6→end",
            "x2 = wait 1: a1→a2",
            "x3 = wait 1: a2→a3",
            "x4 = wait 9: a3→a1 a4→a1 a5→a1",
            "x5 = wait 2: a3→a4",
            "x6 = wait 6: a4→a5",
            "x7 = wait 6: a5→a1",
            // No transition leads to this atom.
            "x8 = wait 5: a6→end",
            "completed = completed: a4→a5 a5→a1",
        ],
    );
}

#[test]
fn a_scope_keeps_endless_loops_apart() {
    assert_moves(
        "{ P (bumper) ({ B (wait 9) (Atom (wait 1) stop) (Atom (wait 2) stop)^inf })^inf }",
        &["a1", "a2", "end"],
        &[
            "x1 = bumper: a1→end a2→end",
            // B is inside the outer loop only; its last atom is inside both loops.
            "x2 = wait 9: a1→a1 a2→a1",
            "x3 = wait 1: a1→a2",
            "x4 = wait 2: a2→a2",
        ],
    );
    assert_moves(
        "{ P (bumper) (Atom (wait 1) stop)^inf }",
        &["a1", "end"],
        &["x1 = bumper: a1→end", "x2 = wait 1: a1→a1"],
    );
}

#[test]
fn a_loop_without_end_is_left_for_each_pass_of_the_finite_one_around_it() {
    assert_moves(
        "{ P (bumper) ({ B (wait 9) (Atom (wait 1) stop)^inf })^2 (Atom (wait 2) stop) }",
        &["a1", "a2", "a3", "end"],
        &[
            "x1 = bumper: a1→end a2→end a3→end",
            "x2 = wait 9: a1→a2",
            "x3 = wait 1: a1→a1",
            "x4 = wait 9: a2→a3",
            "x5 = wait 1: a2→a2",
            "x6 = wait 2: a3→end",
        ],
    );
}

#[test]
fn scopes_null_interrupts_and_laws_are_named_by_states() {
    let file = file("{ P (bumper) (Atom (null) rotate 90) { B (wait 9) (Atom (wait 1) stop)^2 } }");
    assert_eq!((file.source.as_str(), file.laws.len()), ("P", 3));
    assert_eq!(file.laws, ["rotate 90", "stop", "stop"]);
    assert_eq!(file.never, ["x2"]);
    let scopes =
        file.scopes.iter().map(|scope| format!("{} {:?} {}..{}", scope.interrupt, scope.name, scope.first, scope.last));
    let expected = [r#"x1 "P" a1..a3"#, r#"x2 "" a1..a1"#, r#"x3 "B" a2..a3"#, r#"x4 "" a2..a2"#, r#"x5 "" a3..a3"#];
    assert_eq!(scopes.collect::<Vec<_>>(), expected);
}
