//! Tests the tables of a plan, and the limit on its states, with values that were derived by hand from the rules
//! (docs/src/reference/semantics.md, 8.1).

use mdle_runtime::fsm::{Atom, Bracket};

use super::{Element, ElementKind, Exit, Visit};
use crate::samples::{compiled, judged};

#[test]
fn brackets_are_in_pre_order_and_count_the_scopes_and_loops_around_them() {
    let plan = "{ P (bumper)
        (Atom (wait 1) stop)
        (((Atom (wait 2) stop) { Q (wait 9) (Atom (wait 3) stop) })^2 (Atom (wait 4) stop))^3
        ((Atom (wait 5) stop)^4)^inf }";
    let machine = &compiled(plan)[0].machine;
    let brackets = [
        Bracket::scope(0, 0, 4, 0),
        Bracket::scope(1, 0, 0, 0),
        // A pass of the outer loop has five states: two passes of the inner loop with two states each, and an atom.
        Bracket::repeat(3, 0, 5, 1, 3, 0),
        Bracket::repeat(2, 1, 2, 1, 2, 2),
        Bracket::scope(1, 1, 1, 3),
        Bracket::scope(1, 2, 2, 3),
        Bracket::scope(2, 2, 2, 5),
        Bracket::scope(1, 3, 3, 2),
        // All passes of an endless loop use the same states.
        Bracket::repeat(0, 0, 0, 4, 4, 0),
        Bracket::repeat(4, 1, 1, 4, 4, 8),
        Bracket::scope(1, 4, 4, 9),
    ];
    assert_eq!(machine.tables().brackets, brackets);
    let atoms = [Atom::new(1, 1), Atom::new(4, 2), Atom::new(6, 3), Atom::new(7, 6), Atom::new(10, 17)];
    assert_eq!((machine.tables().atoms, machine.states()), (&atoms[..], 21));
    assert_eq!((machine.sizes().levels, machine.sizes().slots), (3, 2));
    let names = machine.elements().map(|element| element.interrupt().map(|_| element.name()));
    let (atom, of_loop) = (Some(""), None);
    let expected = [Some("P"), atom, of_loop, of_loop, atom, Some("Q"), atom, atom, of_loop, of_loop, atom];
    assert_eq!(names.collect::<Vec<_>>(), expected);
}

#[test]
fn a_plan_without_loops_has_no_place_for_a_counter() {
    let machine = &compiled("{ P (Atom (wait 1) stop) }")[0].machine;
    assert_eq!((machine.sizes().levels, machine.sizes().slots, machine.states()), (2, 0, 2));
}

#[test]
fn entry_times_have_places_down_to_the_last_level_that_has_a_wait() {
    let levels = |text: &str| compiled(text)[0].machine.sizes().levels;
    assert_eq!(levels("{ P (bumper) (Atom (bumper) stop) }"), 0);
    assert_eq!(levels("{ P (wait 1) { Q (Atom (bumper) stop) } }"), 1);
    assert_eq!(levels("{ P { Q (NOT (bumper AND wait 1)) (Atom (bumper) stop) } (Atom (bumper) stop) }"), 2);
}

#[test]
fn a_plan_of_more_than_two_to_the_53_states_is_refused() {
    let most = "ExecPlan 9007199254740991 { (Atom (wait 1) stop) }";
    let termination = |body: &str| compiled(&format!("{{ P {body} }}"))[0].machine.states();
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

/// The plan in the tests of elements: a scope in a loop, and an atom after the loop.
const NESTED: &str =
    "{ P (bumper) (((Atom (wait 1) stop) { Q (wait 9) (Atom (null) rotate 9) })^2 (Atom (wait 3) stop))^inf
    (Atom (wait 4) stop) }";

/// Returns a short text that identifies an element.
fn word(element: Element<'_>) -> String {
    match element.kind() {
        ElementKind::Scope => element.name().to_owned(),
        ElementKind::Loop { times } => times.map_or("inf".to_owned(), |times| times.to_string()),
        ElementKind::Atom(atom) => format!("a{}", atom.number() + 1),
    }
}

#[test]
fn elements_know_what_encloses_them_and_what_they_hold() {
    let machine = &compiled(NESTED)[0].machine;
    let rows = machine.elements().map(|element| {
        let children: Vec<_> = element.children().map(word).collect();
        let outwards: Vec<_> = element.outwards().skip(1).map(word).collect();
        let level = element.level().map_or("-".to_owned(), |level| level.to_string());
        let atoms = [element.first().number() + 1, element.last().number() + 1];
        format!("{} {level} {atoms:?} [{}] in {}", word(element), children.join(" "), outwards.join(" "))
    });
    let expected = [
        "P 0 [1, 4] [inf a4] in ",
        "inf - [1, 3] [2 a3] in P",
        "2 - [1, 2] [a1 Q] in inf P",
        "a1 1 [1, 1] [] in 2 inf P",
        "Q 1 [2, 2] [a2] in 2 inf P",
        "a2 2 [2, 2] [] in Q 2 inf P",
        "a3 1 [3, 3] [] in inf P",
        "a4 1 [4, 4] [] in P",
    ];
    assert_eq!(rows.collect::<Vec<_>>(), expected);
    assert_eq!((machine.depth(), machine.states()), (3, 7));
}

#[test]
fn an_exit_leads_one_step_outwards() {
    let machine = &compiled(NESTED)[0].machine;
    let exits = machine.elements().map(|element| match element.exit() {
        Exit::Over => "over".to_owned(),
        Exit::Next(next) => format!("next {}", word(next)),
        Exit::Last(parent) => format!("last of {}", word(parent)),
    });
    let expected = ["over", "next a4", "next a3", "next Q", "last of 2", "last of Q", "last of inf", "last of P"];
    assert_eq!(exits.collect::<Vec<_>>(), expected);
}

#[test]
fn a_walk_enters_and_leaves_each_element_once() {
    let machine = &compiled(NESTED)[0].machine;
    let walk: String = machine.walk().fold(String::new(), |text, visit| match visit {
        Visit::Enter(element) => format!("{text}({}", word(element)),
        Visit::Leave(_) => text + ")",
    });
    assert_eq!(walk, "(P(inf(2(a1)(Q(a2)))(a3))(a4))");
}

#[test]
fn an_element_tells_its_interrupt_and_a_loop_has_none() {
    let machine = &compiled(NESTED)[0].machine;
    let texts: Vec<_> = machine.elements().map(Element::condition_text).collect();
    assert_eq!(texts, ["bumper", "", "", "wait 1", "wait 9", "null", "wait 3", "wait 4"]);
    let completing: Vec<_> = machine.elements().filter(|element| element.completes()).map(word).collect();
    assert_eq!(completing, ["a2"]);
    let spans = machine.elements().map(|element| element.span()).collect::<Vec<_>>();
    assert_eq!((spans[3].end - spans[3].start) as usize, "(Atom (wait 1) stop)".len());
    assert!(spans[2].start < spans[3].start && spans[4].end < spans[2].end, "a loop encloses its string");
}
