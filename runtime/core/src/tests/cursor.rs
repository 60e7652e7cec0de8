//! Tests a cursor: the atom after a scope has ended, and the brackets that restart (docs/src/reference/semantics.md,
//! 5.3 and 6).

use std::vec::Vec;

use crate::fsm::{Atom, Bracket};
use crate::{Cursor, Fsm, Nanos};

/// `((a)^2, x) b`: the loop is inside the scope `x`.
const LOOP_IN_SCOPE: Fsm<'static> = Fsm {
    brackets: &[
        Bracket::scope(0, 0, 1, 0),
        Bracket::scope(1, 0, 0, 0),
        Bracket::repeat(2, 0, 1, 0, 0, 1),
        Bracket::scope(2, 0, 0, 2),
        Bracket::scope(1, 1, 1, 0),
    ],
    atoms: &[Atom::new(3, 1), Atom::new(4, 3)],
    termination: 4,
};

/// `(a, x)^2 b`: the scope `x` is inside the loop.
const SCOPE_IN_LOOP: Fsm<'static> = Fsm {
    brackets: &[
        Bracket::scope(0, 0, 1, 0),
        Bracket::repeat(2, 0, 1, 0, 0, 0),
        Bracket::scope(1, 0, 0, 1),
        Bracket::scope(2, 0, 0, 2),
        Bracket::scope(1, 1, 1, 0),
    ],
    atoms: &[Atom::new(3, 1), Atom::new(4, 3)],
    termination: 4,
};

/// Returns the brackets of `((a b)^2)^outer`, where one pass of the outer loop has `stride` states.
const fn loops(outer: u64, stride: u64) -> [Bracket; 5] {
    [
        Bracket::scope(0, 0, 1, 0),
        Bracket::repeat(outer, 0, stride, 0, 1, 0),
        Bracket::repeat(2, 1, 2, 0, 1, 1),
        Bracket::scope(1, 0, 0, 2),
        Bracket::scope(1, 1, 1, 2),
    ]
}

const PAIR: [Atom; 2] = [Atom::new(3, 1), Atom::new(4, 2)];

type Walk = Cursor<[Nanos; 3], [u64; 2]>;

/// Returns a cursor at the start, at time 100. The storage's earlier content does not matter.
fn start(fsm: Fsm<'_>) -> Walk {
    Cursor::start(fsm, [Nanos(77); 3], [77; 2], Nanos(100))
}

/// Returns at most `most` states that a plan passes through if a scope at this level ends in each of them.
fn states(fsm: Fsm<'_>, level: u16, most: usize) -> Vec<u64> {
    let mut cursor = start(fsm);
    let mut states = std::vec![cursor.state(fsm)];
    while states.len() < most && cursor.end(fsm, level, Nanos(100)) {
        states.push(cursor.state(fsm));
    }
    states
}

#[test]
fn a_plan_starts_at_its_first_atom_with_everything_afresh() {
    let cursor = start(LOOP_IN_SCOPE);
    assert_eq!((cursor.atom(), cursor.state(LOOP_IN_SCOPE)), (0, 1));
    assert_eq!([0, 1, 2].map(|level| cursor.since(level, Nanos(130))), [Nanos(30); 3]);
}

#[test]
fn a_level_is_the_scope_around_the_current_atom() {
    let mut cursor = start(LOOP_IN_SCOPE);
    let scopes = |cursor: &Walk| [0, 1, 2].map(|level| cursor.scope(LOOP_IN_SCOPE, level));
    assert_eq!(scopes(&cursor), [0, 1, 3]);
    cursor.end(LOOP_IN_SCOPE, 1, Nanos(100));
    assert_eq!(scopes(&cursor), [0, 4, 4], "the atom's own where there is none of this level");
}

#[test]
fn a_walk_outwards_ends_at_the_plan() {
    let outwards = |bracket| LOOP_IN_SCOPE.outwards(bracket).map(|(number, _)| number).collect::<Vec<_>>();
    assert_eq!((outwards(3), outwards(0)), (std::vec![3, 2, 1, 0], std::vec![0]));
}

#[test]
fn an_interrupt_around_a_loop_leaves_it() {
    assert_eq!(states(LOOP_IN_SCOPE, 1, 9), [1, 3]);
    assert_eq!(states(LOOP_IN_SCOPE, 2, 9), [1, 2, 3], "that of its body begins the next pass");
}

#[test]
fn an_interrupt_inside_a_loop_begins_its_next_pass() {
    assert_eq!(states(SCOPE_IN_LOOP, 1, 9), [1, 2, 3]);
    assert_eq!(states(SCOPE_IN_LOOP, 2, 9), [1, 2, 3]);
}

#[test]
fn the_end_of_the_plan_is_the_termination_state() {
    let mut cursor = start(LOOP_IN_SCOPE);
    assert!(!cursor.end(LOOP_IN_SCOPE, 0, Nanos(100)));
    assert_eq!((cursor.atom(), cursor.state(LOOP_IN_SCOPE)), (2, 4));
    assert_eq!([0, 1, 2].map(|level| cursor.scope(LOOP_IN_SCOPE, level)), [0; 3], "no scope but the plan's is left");
}

#[test]
fn loops_that_end_together_count_all_their_states() {
    let brackets = loops(3, 4);
    let fsm = Fsm { brackets: &brackets, atoms: &PAIR, termination: 13 };
    assert_eq!(states(fsm, 1, 99), (1..=12).collect::<Vec<_>>());
}

#[test]
fn the_passes_of_a_loop_without_end_share_their_states() {
    let brackets = loops(0, 0);
    let fsm = Fsm { brackets: &brackets, atoms: &PAIR, termination: 5 };
    assert_eq!(states(fsm, 1, 10), [1, 2, 3, 4, 1, 2, 3, 4, 1, 2]);
}

#[test]
fn only_what_lies_inside_the_holding_bracket_starts_afresh() {
    let since = |cursor: &Walk| [0, 1, 2].map(|level| cursor.since(level, Nanos(150)).0);
    let mut cursor = start(LOOP_IN_SCOPE);
    cursor.end(LOOP_IN_SCOPE, 2, Nanos(140));
    assert_eq!(since(&cursor), [50, 50, 10], "a pass of the loop in the scope");
    let mut cursor = start(SCOPE_IN_LOOP);
    cursor.end(SCOPE_IN_LOOP, 2, Nanos(140));
    assert_eq!(since(&cursor), [50, 10, 10], "a pass of the loop around the scope");
}

#[test]
fn a_loop_that_is_entered_again_has_all_its_passes() {
    // In `((a b)^2)^3` a counter that was not refilled would leave the second pass of the outer loop after two states.
    let brackets = loops(3, 4);
    let fsm = Fsm { brackets: &brackets, atoms: &PAIR, termination: 13 };
    let mut cursor = start(fsm);
    (0..4).for_each(|_| assert!(cursor.end(fsm, 1, Nanos(100))));
    assert_eq!(cursor.state(fsm), 5);
    (0..3).for_each(|_| assert!(cursor.end(fsm, 1, Nanos(100))));
    assert_eq!(cursor.state(fsm), 8);
}

#[test]
fn what_has_no_element_left_ends_with_its_last_one() {
    // `{ P { R { Q (a) (b) } } (c) }`.
    let brackets = [
        Bracket::scope(0, 0, 2, 0),
        Bracket::scope(1, 0, 1, 0),
        Bracket::scope(2, 0, 1, 1),
        Bracket::scope(3, 0, 0, 2),
        Bracket::scope(3, 1, 1, 2),
        Bracket::scope(1, 2, 2, 0),
    ];
    let fsm = Fsm { brackets: &brackets, atoms: &[Atom::new(3, 1), Atom::new(4, 2), Atom::new(5, 3)], termination: 4 };
    let mut cursor = start(fsm);
    let endings = |cursor: &Walk, level| cursor.ending(fsm, level).map(|(number, _)| number).collect::<Vec<_>>();
    assert_eq!([3, 2, 0].map(|level| endings(&cursor, level)), [std::vec![3], std::vec![2, 1], std::vec![0]]);
    cursor.end(fsm, 3, Nanos(100));
    assert_eq!(endings(&cursor, 3), [4, 2, 1]);
    cursor.end(fsm, 3, Nanos(100));
    assert_eq!(endings(&cursor, 1), [5, 0]);
}

#[test]
fn a_loop_ends_with_its_body_in_its_last_pass() {
    let brackets = |times| {
        [
            Bracket::scope(0, 0, 1, 0),
            Bracket::repeat(times, 0, 1, 0, 0, 0),
            Bracket::scope(1, 0, 0, 1),
            Bracket::scope(1, 1, 1, 0),
        ]
    };
    let endings = |times: u64, passes: u64| {
        let brackets = brackets(times);
        let fsm = Fsm { brackets: &brackets, atoms: &[Atom::new(2, 1), Atom::new(3, 2)], termination: 3 };
        let mut cursor = start(fsm);
        (0..passes).for_each(|_| assert!(cursor.end(fsm, 1, Nanos(100))));
        let without_counters = Cursor::start(fsm, [], [], Nanos(100));
        let endings = cursor.ending(fsm, 1).map(|(number, _)| number).collect::<Vec<_>>();
        (endings, without_counters.ending(fsm, 1).count())
    };
    assert_eq!(endings(1, 0), (std::vec![2, 1], 2));
    assert_eq!(endings(2, 0), (std::vec![2], 2), "a loop without a counter is in its last pass");
    assert_eq!(endings(2, 1), (std::vec![2, 1], 2));
    assert_eq!(endings(0, 3), (std::vec![2], 1), "a loop without end");
}

#[test]
fn tables_whose_parents_form_a_circle_hold_nobody_up() {
    let scopes = [Bracket::scope(5, 0, 0, 1), Bracket::scope(6, 0, 0, 0)];
    let loops =
        [Bracket::repeat(2, 0, 1, 0, 0, 1), Bracket::repeat(2, 1, 1, 0, 0, 2), Bracket::repeat(2, 0, 1, 0, 0, 0)];
    let atoms = [Atom::new(0, 1)];
    for brackets in [&scopes[..], &loops] {
        let fsm = Fsm { brackets, atoms: &atoms, termination: 2 };
        assert!(states(fsm, 0, 99).len() <= 99, "each step comes to an end");
        assert_eq!(start(fsm).scope(fsm, 7), 0);
    }
}

#[test]
fn tables_that_hold_too_little_are_no_reason_to_panic() {
    let none = Fsm { brackets: &[], atoms: &[], termination: 1 };
    assert_eq!(states(none, 0, 9), [1]);
    let atoms = [Atom::new(9, 1)];
    assert_eq!(states(Fsm { brackets: &[Bracket::scope(0, 0, 0, 7)], atoms: &atoms, termination: 2 }, 0, 9), [1]);
    let mut cursor = Cursor::start(SCOPE_IN_LOOP, [], [], Nanos(100));
    assert_eq!(cursor.since(1, Nanos(150)), Nanos::ZERO);
    assert_eq!(cursor.state(SCOPE_IN_LOOP), 2, "a loop without a counter is in its last pass");
    assert!(cursor.end(SCOPE_IN_LOOP, 1, Nanos(100)));
    assert_eq!(cursor.atom(), 1, "a loop without a counter is left");
}
