//! The tables of a plan and the limit of its states, written out by hand from the rules
//! (docs/src/reference/semantics.md, 8.1).

use mdle_runtime::fsm::{Atom, Bracket};

use crate::samples::{compiled, judged};

#[test]
fn brackets_are_in_pre_order_and_count_the_scopes_and_loops_around_them() {
    let plan = "{ P (bumper)
        (Atom (wait 1) stop)
        (((Atom (wait 2) stop) { Q (wait 9) (Atom (wait 3) stop) })^2 (Atom (wait 4) stop))^3
        ((Atom (wait 5) stop)^4)^inf }";
    let lowered = &compiled(plan)[0].lowered;
    let brackets = [
        Bracket::scope(0, 0, 4, 0),
        Bracket::scope(1, 0, 0, 0),
        // A pass of the outer loop is two of the inner one and an atom.
        Bracket::repeat(3, 0, 5, 1, 3, 0),
        Bracket::repeat(2, 1, 2, 1, 2, 2),
        Bracket::scope(1, 1, 1, 3),
        Bracket::scope(1, 2, 2, 3),
        Bracket::scope(2, 2, 2, 5),
        Bracket::scope(1, 3, 3, 2),
        // Passes of a loop without end share their states.
        Bracket::repeat(0, 0, 0, 4, 4, 0),
        Bracket::repeat(4, 1, 1, 4, 4, 8),
        Bracket::scope(1, 4, 4, 9),
    ];
    assert_eq!(lowered.brackets, brackets);
    let atoms = [Atom::new(1, 1), Atom::new(4, 2), Atom::new(6, 3), Atom::new(7, 6), Atom::new(10, 17)];
    assert_eq!((&*lowered.atoms, lowered.termination), (&atoms[..], 21));
    assert_eq!((lowered.levels, lowered.slots), (3, 2));
    let names = lowered.scopes.iter().map(|scope| scope.as_ref().map(|scope| &*scope.name));
    let (atom, of_loop) = (Some(""), None);
    let expected = [Some("P"), atom, of_loop, of_loop, atom, Some("Q"), atom, atom, of_loop, of_loop, atom];
    assert_eq!(names.collect::<Vec<_>>(), expected);
}

#[test]
fn a_plan_without_loops_has_no_place_for_a_counter() {
    let lowered = &compiled("{ P (Atom (wait 1) stop) }")[0].lowered;
    assert_eq!((lowered.levels, lowered.slots, lowered.termination), (2, 0, 2));
}

#[test]
fn entry_times_have_places_down_to_the_last_level_that_has_a_wait() {
    let levels = |text: &str| compiled(text)[0].lowered.levels;
    assert_eq!(levels("{ P (bumper) (Atom (bumper) stop) }"), 0);
    assert_eq!(levels("{ P (wait 1) { Q (Atom (bumper) stop) } }"), 1);
    assert_eq!(levels("{ P { Q (NOT (bumper AND wait 1)) (Atom (bumper) stop) } (Atom (bumper) stop) }"), 2);
}

#[test]
fn a_plan_of_more_than_two_to_the_53_states_is_refused() {
    let most = "ExecPlan 9007199254740991 { (Atom (wait 1) stop) }";
    let termination = |body: &str| compiled(&format!("{{ P {body} }}"))[0].lowered.termination;
    assert_eq!(termination(most), 1 << 53, "the termination state is the last of them");
    let more = [
        "ExecPlan 9007199254740992 { (Atom (wait 1) stop) }",
        "ExecPlan 4503599627370496 { (Atom (wait 1) stop) (Atom (wait 2) stop) }",
        &format!("{most} (Atom (wait 2) stop)"),
        &format!("(Atom (wait 2) stop) {{ Q {most} }}"),
        &format!("({most})^3000"),
    ];
    for body in more {
        let judged = judged(&format!("{{ P {body} }}"), None);
        assert!(judged.contains("E0501"), "{judged}");
    }
    let judged = judged(&format!("{{ P {} }}", more[0]), None);
    assert!(judged.contains("plan.mdle:1:5"), "the loop is named, and not the plan: {judged}");
}
