//! Tests the result of degeneracy removal (docs/src/reference/semantics.md, 7.4). Traces cannot show the result, since
//! the outer interrupt always wins.

use crate::alphabet;
use crate::diagnostic::SourceId;
use crate::plan::{Condition, Interrupt, Node};
use crate::samples::compiled;
use crate::{Compiled, compile};

/// Returns the interrupt of the plan's first atom.
fn of_first_atom(compiled: &Compiled) -> &Interrupt {
    match &compiled.nondegenerate.plan().root.body[0] {
        Node::Atom(atom) => &atom.interrupt,
        other @ (Node::Scope(_) | Node::Loop(_)) => panic!("{other:?}"),
    }
}

#[test]
fn a_removed_interrupt_is_null_and_keeps_its_text() {
    let compiled = compiled("{ P (bumper OR wait 5) (Atom (wait 5 OR bumper) rotate 90) }");
    let interrupt = of_first_atom(&compiled[0]);
    assert_eq!((&interrupt.condition, interrupt.removed), (&Condition::Null, true));
    assert_eq!(interrupt.text, "wait 5 OR bumper");
}

#[test]
fn an_interrupt_that_is_not_repeated_stays_as_it_is() {
    let compiled = compiled("{ P (bumper) (Atom (NOT bumper) stop) }");
    let interrupt = of_first_atom(&compiled[0]);
    assert!(matches!(interrupt.condition, Condition::Not(_)) && !interrupt.removed);
}

#[test]
fn a_condition_is_repeated_only_where_it_is_the_same_function() {
    let removed = |interrupt: &str, label: &str| {
        let compiled = compiled(&format!("{{ P {label} {{ Q ({interrupt}) (Atom ({interrupt}) stop) }} }}"));
        let body = &compiled[0].nondegenerate.plan().root.body;
        let Some(Node::Scope(scope)) = body.last() else { panic!("{body:?}") };
        matches!(&scope.body[..], [Node::Atom(atom)] if atom.interrupt.removed)
    };
    // The record that `after` reads is the same in both places, but RISING and `t` depend on the entry of each scope.
    assert!(removed("after s bumper", "s: (Atom (bumper) stop)"));
    assert!(!removed("RISING bumper", ""));
    assert!(!removed("t > 5s", ""));
}

#[test]
fn a_file_is_the_same_with_and_without_quotes() {
    let text = "target t : crate t, period 1s; interrupt played(tune: file); control stop;";
    let (alphabet, found) = alphabet::combine(alphabet::read(SourceId(0), text).0.expect("an alphabet"), &[]);
    assert_eq!(found, []);
    let removed = |plan: &str| {
        let (compiled, found) = compile(SourceId(0), plan, &alphabet, None);
        of_first_atom(compiled.first().unwrap_or_else(|| panic!("{found:?}"))).removed
    };
    assert!(removed("{ P (played \"a\") (Atom (played a) stop) }"));
    assert!(!removed("{ P (played \"a\") (Atom (played b) stop) }"));
}

#[test]
fn degrees_and_radians_are_never_the_same() {
    let text = "target t : crate t, period 1s; interrupt facing(bearing: angle deg); control stop;";
    let (alphabet, found) = alphabet::combine(alphabet::read(SourceId(0), text).0.expect("an alphabet"), &[]);
    assert_eq!(found, []);
    let removed = |inner: &str| {
        let plan = format!("{{ P (facing 180) (Atom (facing {inner}) stop) }}");
        let (compiled, found) = compile(SourceId(0), &plan, &alphabet, None);
        of_first_atom(compiled.first().unwrap_or_else(|| panic!("{found:?}"))).removed
    };
    assert!(removed("180deg") && removed("1.8e2"));
    // The float nearest to half a turn is nevertheless a different number.
    assert!(!removed("3.141592653589793rad"));
}

#[test]
fn the_null_interrupt_in_disguise_is_null() {
    for condition in
        ["wait inf OR wait inf", "NOT (NOT wait inf)", "null AND wait inf", "RISING (NOT null)", "NOT (NOT null)"]
    {
        let compiled = compiled(&format!("{{ P (bumper) (Atom ({condition}) stop) }}"));
        let interrupt = of_first_atom(&compiled[0]);
        assert_eq!((&interrupt.condition, interrupt.memories, interrupt.removed), (&Condition::Null, 0, false));
        assert_eq!(interrupt.text, condition);
        assert_eq!(interrupt.operands.len(), 1);
    }
    for condition in ["wait inf OR wait 1", "NOT wait inf", "bumper AND null"] {
        let compiled = compiled(&format!("{{ P (atIsection 1000) (Atom ({condition}) stop) }}"));
        assert_ne!(of_first_atom(&compiled[0]).condition, Condition::Null, "{condition}");
    }
}
