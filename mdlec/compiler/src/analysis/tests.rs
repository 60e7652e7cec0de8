//! Tests the analyses of small plans: each warning with a plan that causes it, and with a similar plan that does not.

mod texts;

use mdle_runtime::fsm::{Atom, Bracket};

use super::{Reach, analyze};
use crate::alphabet::{self, Alphabet};
use crate::compile;
use crate::diagnostic::{Code, SourceId};
use crate::fsm::{LawMeaning, Machine, ScopeMeaning};
use crate::samples::compiled;

/// Returns the lints of the first plan of a text, one per line, each with the texts of its secondary labels.
fn lints(text: &str) -> String {
    let compiled = compiled(text).swap_remove(0);
    let found = super::lints(&compiled.machine);
    let places = found.iter().map(|lint| {
        let notes: String = lint.labels.iter().skip(1).map(|label| format!(" [{}]", label.text)).collect();
        format!("{}: {}{notes}\n", lint.code, lint.message)
    });
    places.collect()
}

fn assert_silent(plans: &[&str]) {
    for plan in plans {
        assert_eq!(lints(plan), "", "{plan}");
    }
}

/// Returns for each atom its reachability, and the operands that can end it by themselves.
fn atoms(text: &str) -> Vec<(Reach, String)> {
    let analysis = analyze(&compiled(text)[0].machine);
    analysis.atoms.into_iter().map(|atom| (atom.reach, atom.ended_by.join(", "))).collect()
}

/// Returns the minimum and the maximum duration in seconds, and the number of turns to add to the maximum.
fn durations(text: &str) -> (Option<f64>, Option<f64>, Option<u64>) {
    let analysis = analyze(&compiled(text)[0].machine);
    (analysis.shortest, analysis.longest.seconds, analysis.longest.turns)
}

fn transitions(text: &str) -> u64 {
    analyze(&compiled(text)[0].machine).transitions
}

#[test]
fn uses_of_an_exclusive_interrupt_exclude_each_other() {
    let alphabet = "alphabet a; control stop; interrupt lamp(of: sonar); interrupt wait(of: time);
        interrupt door(of: sonar) exclusive; interrupt door(of: robot) exclusive; interrupt gate(of: sonar) exclusive;";
    let (alphabet, _) = alphabet::read(SourceId(0), alphabet);
    let alphabet = Alphabet::shared(alphabet.unwrap());
    let codes = |condition: &str| {
        let text = format!("{{ P (wait 9) (Atom ({condition}) stop) }}");
        let (_, found) = compile(SourceId(1), &text, &alphabet, None);
        found.iter().map(|found| found.code).collect::<Vec<_>>()
    };
    assert_eq!(codes("door 1 AND door 2"), [Code::W0203]);
    assert_eq!(codes("NOT (NOT door 1 OR NOT door 2)"), [Code::W0203]);
    for both in ["lamp 1 AND lamp 2", "door 1 AND gate 2", "door 1 AND door ada", "door 1 AND NOT door 2", "door 1"] {
        assert_eq!(codes(both), [], "{both}");
    }
}

#[test]
fn conditions_that_are_true_only_when_an_outer_one_is() {
    insta::assert_snapshot!(lints(
        "{ P (bumper OR r0 < 50cm)
  (Atom (bumper AND sync ada OR wait 5) stop)
  (Atom (r0 <= 20cm OR wait 5) stop)
  { Q (atIsection 1000 AND sync ada) (Atom (sync ada AND NOT sync bob AND atIsection 1000 OR wait 5) stop) }
  { R (NOT (sync ada OR wait 9) OR r1 == 1) (Atom (r1 == 1.01 OR wait 4) stop) }
}"
    ), @"
    W0205: `bumper AND sync ada` can never end this: `P` always ends first [`P` ends by this]
    W0205: `r0 <= 0.2` can never end this: `P` always ends first [`P` ends by this]
    W0205: `sync ada AND NOT sync bob AND atIsection 1000` can never end this: `Q` always ends first [`Q` ends by this]
    ");
    assert_silent(&[
        "{ P (bumper AND sync ada) (Atom (bumper OR wait 5) stop) }",
        "{ P (r0 < 50cm) (Atom (r0 < 60cm OR wait 5) stop) }",
        "{ P (r0 < 50cm) (Atom (r1 < 20cm OR wait 5) stop) }",
        "{ P (theta < 10deg) (Atom (theta < 5deg OR wait 5) stop) }",
        "{ P (rendezvous ada) (Atom (rendezvous ada AND bumper OR wait 5) stop) }",
        "{ P (RISING bumper) (Atom (bumper OR wait 5) stop) }",
        // The operand can end the atom in the other use of the plan.
        "{ P Leg { Q (bumper) Leg } } { Leg (Atom (bumper AND sync ada OR wait 5) stop) }",
    ]);
}

#[test]
fn records_without_what_is_asked_of_them() {
    insta::assert_snapshot!(lints(
        "{ P (wait 60) s1: { Q (wait 9) s2: (Atom (after s3 OR bumper) stop) }
  (Atom (after s2 AND bumper OR wait 5) stop)
  (Atom (after s1 wait 9 AND NOT after s3 OR wait 5) stop)
  s3: (Atom (after s3) stop) }"
    ), @"
    W0203: `after s3` is never true: what it asks for never ends before this is read
    W0203: `after s3` is never true: what it asks for never ends before this is read
    ");
    assert_silent(&[
        "{ P (wait 60) s1: (Atom (bumper OR wait 5) stop) (Atom (after s1 bumper OR wait 5) stop) }",
        // In the second pass, the element `s2` of the first pass has ended.
        "{ P (wait 60) ((Atom (after s2 OR wait 5) stop) s2: (Atom (after s2 OR wait 1) stop))^2 }",
        "{ P (wait 60) { Q (after s1 OR bumper) s1: (Atom (wait 5) stop) } }",
    ]);
}

#[test]
fn timers_that_an_outer_one_beats() {
    insta::assert_snapshot!(lints(
        "{ P (wait 10)
  (Atom (wait 11 OR bumper) stop)
  { Q (wait 6) (Atom (wait 5) stop) (Atom (wait 5) stop) (Atom (wait 3 OR bumper) stop) }
}"
    ), @"
    W0206: `wait 11` can never end this: a timer of `P` always fires first [`P` ends by this]
    W0206: `wait 5` can never end this: a timer of `Q` always fires first [`Q` ends by this]
    W0202: this is never reached [the element with this never ends before an enclosing scope does]
    ");
    assert!(lints("{ R (wait 9) ((Atom (wait 2) stop))^4 (Atom (wait 1 OR bumper) stop) }").contains("W0206"));
    assert_silent(&[
        "{ P (wait 10) (Atom (wait 9 OR bumper) stop) (Atom (wait 9 OR bumper) stop) }",
        "{ P (wait 10) ((Atom (wait 2) stop))^4 (Atom (wait 1 OR bumper) stop) }",
        "{ P (wait 10) (Atom (wait 9) rotate 90) (Atom (wait 9 OR bumper) stop) }",
        "{ P { Q (wait 3) (Atom (wait 1) stop) } (Atom (wait 9) stop) }",
    ]);
}

#[test]
fn what_is_cut_off_and_what_is_always_skipped() {
    insta::assert_snapshot!(lints(
        "{ P (bumper)
  (Atom (r0 < 30cm) stop)
  (Atom (r0 < 50cm OR wait 2) stop)
  { Q (NOT bumper) (Atom (wait 1) stop) }
  (Atom (bumper AND sync ada) stop)
  (Atom (wait 5) stop)
  (Atom (wait 5) stop)
}"
    ), @"
    W0303: `r0 < 0.5 OR wait 2` is true whenever the element before this ends, so this is always skipped [the element before it ends when this is true]
    W0303: `NOT bumper` is true whenever this is entered, so it is always skipped
    W0205: `bumper AND sync ada` can never end this: `P` always ends first [`P` ends by this]
    W0202: this is never reached [the element with this never ends before an enclosing scope does]
    ");
    assert_silent(&[
        "{ P (Atom (r0 < 50cm) stop) (Atom (r0 < 30cm OR wait 2) stop) }",
        "{ P (Atom (r0 < 30cm) rotate 90) (Atom (r0 < 50cm OR wait 2) stop) }",
        "{ P (Atom (r0 < 30cm) stop) (Atom (RISING r0 < 50cm OR wait 2) stop) }",
        // The second pass begins again with the loop's first element.
        "{ P ExecPlan 2 { (Atom (sync ada) stop) (Atom (wait 1) stop) } (Atom (wait 1) stop) }",
        "{ P (Atom (bumper) stop) ExecPlan 2 { (Atom (bumper OR wait 1) stop) (Atom (wait 1) stop) } }",
    ]);
}

#[test]
fn atoms_that_never_run_are_found() {
    use Reach::{Never, Runs, Skipped};
    let plan = "{ P (bumper) (Atom (wait 5 OR bumper AND wait 1) rotate 90) { Q (NOT bumper) (Atom (wait 1) stop)
      (Atom (wait 1) stop) } (Atom (null) go 5 0) (Atom (wait 1) stop) }";
    let expected = [(Runs, "wait 5, completed"), (Skipped, ""), (Never, ""), (Runs, ""), (Never, "")];
    assert_eq!(atoms(plan), expected.map(|(reach, ended)| (reach, ended.to_owned())));
}

#[test]
fn durations_are_those_of_timers() {
    let cases = [
        ("{ P (Atom (wait 2) stop) (Atom (wait 3) stop) }", Some(5.0), Some(5.0), Some(2)),
        ("{ P (Atom (wait 2) rotate 90) ((Atom (wait 3) stop))^4 }", Some(12.0), Some(14.0), Some(5)),
        ("{ P (wait 7 OR bumper) ((Atom (bumper) stop))^4 }", Some(0.0), Some(7.0), Some(1)),
        ("{ P (wait 7) ((Atom (wait 1) stop))^inf }", Some(7.0), Some(7.0), Some(1)),
        ("{ P (Atom (bumper) stop) }", Some(0.0), None, None),
        ("{ P (Atom (wait 2 AND bumper) stop) }", Some(2.0), None, None),
        ("{ P (Atom (NOT (t < 3)) stop) }", Some(3.0), Some(3.0), Some(1)),
        ("{ P (Atom (null) stop) }", None, None, None),
        ("{ P (wait 4) { Q (wait 9) (Atom (null) stop) } }", Some(4.0), Some(4.0), Some(1)),
    ];
    for (plan, shortest, longest, turns) in cases {
        assert_eq!(durations(plan), (shortest, longest, turns), "{plan}");
    }
}

#[test]
fn transitions_of_a_turn_are_counted_for_one_output_at_a_time() {
    let cases = [
        ("{ P (Atom (wait 2) stop) (Atom (wait 3) stop) }", 1),
        ("{ P (Atom (bumper) stop) (Atom (sync ada) stop) (Atom (bumper) stop) }", 3),
        ("{ P (Atom (bumper) stop) (Atom (NOT bumper) stop) (Atom (bumper) stop) }", 1),
        ("{ P (Atom (atIsection 1000) stop) (Atom (atIsection 0100) stop) }", 1),
        ("{ P (bumper) (Atom (bumper OR wait 1) stop) (Atom (null) rotate 90) }", 2),
        ("{ P ((Atom (bumper) stop))^9 }", 9),
        ("{ P ((Atom (bumper) stop) (Atom (wait 1) stop))^9 }", 2),
        ("{ P ((Atom (bumper) stop))^inf }", 4096),
        ("{ P ((Atom (bumper) stop))^5000 }", 4096),
    ];
    for (plan, most) in cases {
        assert_eq!(transitions(plan), most, "{plan}");
    }
}

/// Returns a machine with `depth + 1` nested scopes, each with the name and condition of the plan in `text`, and one
/// atom.
fn nested(text: &str, depth: u32) -> Machine {
    let mut draft = compiled(text).swap_remove(0).machine.draft();
    let meaning: ScopeMeaning = draft.scopes[0].clone().expect("a plan");
    draft.brackets = (0..=depth).map(|level| Bracket::scope(level as u16, 0, 0, level.saturating_sub(1))).collect();
    draft.scopes = vec![Some(meaning); depth as usize + 1];
    draft.spans = vec![draft.spans[0]; depth as usize + 1];
    draft.atoms = vec![Atom::new(depth, 1)];
    draft.laws = vec![LawMeaning { quark: draft.laws[0].quark, frame: 0.0 }];
    draft.frames = vec![None];
    Machine::unvalidated(draft)
}

#[test]
fn nesting_as_deep_as_you_like_comes_to_a_result() {
    for plan in ["{ P (bumper AND sync ada OR wait 5) (Atom (null) stop) }", "{ P (null) (Atom (null) stop) }"] {
        let analysis = analyze(&nested(plan, 10_000));
        assert_eq!((analysis.depth, analysis.scopes.len(), analysis.atoms.len()), (10_001, 10_000, 1));
        assert!(analysis.to_text().len() > 100_000 && analysis.to_json().len() > 1_000_000);
    }
}

#[test]
fn loops_are_not_written_out() {
    let nested = |loops: u32| {
        let body = (0..loops).fold("(Atom (wait 1) stop)".to_owned(), |body, _| format!("ExecPlan 10 {{ {body} }}"));
        analyze(&compiled(&format!("{{ P {body} }}"))[0].machine)
    };
    assert_eq!((nested(9).states, nested(9).shortest), (1_000_000_001, Some(1e9)));
    let analysis = nested(12);
    // Durations are at most 2^64 nanoseconds.
    assert_eq!((analysis.states, analysis.shortest), (1_000_000_000_001, Some(18_446_744_073.709_553)));
    assert_eq!((analysis.longest.seconds, analysis.longest.turns), (Some(1e12), Some(1_000_000_000_000)));
}
