//! Tests the texts of lints, and checks that correct plans cause no lints.

use crate::samples::judged;

/// One snapshot: the text, its analysis, and the plan.
macro_rules! assert_judged {
    ($text:literal) => {
        insta::assert_snapshot!(judged($text, None))
    };
}

/// Asserts that these plans have no warnings.
fn assert_silent(plans: &[&str]) {
    for plan in plans {
        let judged = judged(plan, None);
        assert!(!judged.contains("[W") && !judged.contains("[E"), "{judged}");
    }
}

#[test]
fn conditions_that_are_always_or_never_true() {
    assert_judged!(
        "{ P (NOT bumper OR bumper)
  (Atom (wait 0) stop)
  (Atom (bumper AND wait inf) stop)
  (Atom (atIsection 1000 AND atIsection 0100) stop)
  { Q (sync ada OR NOT (sync bob OR NOT null)) (Atom (wait 5) stop) }
}"
    );
    assert_silent(&[
        "{ P (wait 60) (Atom (rendezvous ada OR NOT rendezvous ada) stop) }",
        "{ P (Atom (wait 5 AND NOT wait 9) stop) (Atom (wait inf OR bumper) stop) }",
        "{ P (Atom (atIsection 1000 AND atIsection 1000) stop) }",
    ]);
}

#[test]
fn conditions_that_an_outer_one_shadows() {
    assert_judged!(
        "{ P (bumper OR wait 60)
  (Atom (wait 20 OR bumper) go 20 0)
  { Q (NOT sync ada) (Atom (wait 60) stop) ExecPlan 2 { (Atom (atIsection 1000 OR NOT sync ada) stop) } }
}"
    );
    assert_silent(&[
        "{ P (rendezvous ada) (Atom (rendezvous ada OR wait 5) stop) }",
        "{ P { Q (bumper) (Atom (wait 5) stop) } (Atom (bumper OR wait 5) stop) }",
    ]);
}

#[test]
fn neighbours_that_are_always_skipped() {
    assert_judged!(
        "{ P
  (Atom (bumper) go 20 0)
  (Atom (bumper) go -10 0)
  (Atom (atIsection 1000 AND NOT sync ada) stop)
  { Q (atIsection 1000 AND NOT sync ada) (Atom (wait 5) stop) }
}"
    );
    assert_silent(&[
        // The first element may have ended because its law completed, or the condition may no longer be true.
        "{ P (Atom (bumper) rotate 90) (Atom (bumper) go 5 0) }",
        "{ P (Atom (wait 5) stop) (Atom (wait 5) stop) (Atom (bumper OR wait 5) stop) (Atom (bumper OR wait 5) stop) }",
        "{ P (wait 60) (Atom (rendezvous ada) stop) (Atom (rendezvous ada) stop) }",
    ]);
}

#[test]
fn conditions_that_are_true_on_entry() {
    assert_judged!(
        "{ P
  (Atom (way < 2m) go 20 0)
  (Atom (t <= 5) go 20 0)
  (Atom (NOT wait 5) go 20 0)
  (Atom (way >= 0m) go 20 0)
  { Q (bumper OR way < 2m) (Atom (wait 5) stop) }
  (Atom (way < 2m AND t < 5) stop)
}
{ R (NOT way > 2m) (Atom (wait 5) stop) }"
    );
    assert_silent(&[
        "{ P (Atom (way > 2m) stop) (Atom (t >= 5) stop) (Atom (way == 2m) stop) }",
        "{ P (Atom (way < 2m AND wait 5) stop) (Atom (RISING (way < 2m)) stop) (Atom (way < 2m AND bumper) stop) }",
    ]);
}

#[test]
fn pairs_that_have_one_value() {
    assert_judged!(
        "{ P
  (Atom (way > 5m AND way < 2m) stop)
  (Atom (t > 5 AND t < 2 OR bumper) stop)
  (Atom (r0 > 50cm OR r0 < 2m) stop)
  (Atom (way > 2m OR NOT way > 2m) stop)
  (Atom (sync ada OR r0 < 1 AND r0 > 2) stop)
}"
    );
    assert_silent(&[
        "{ P (Atom (way > 2m AND way < 5m) stop) (Atom (r0 < 50cm OR r0 > 2m) stop) }",
        "{ P (Atom (r0 > 50cm OR r1 < 2m) stop) (Atom (theta > 10 OR theta < 20) stop) }",
    ]);
}

#[test]
fn paths_that_an_outer_one_ends() {
    assert_judged!(
        "{ P (bumper OR way > 2m)
  (Atom (way > 3m) go 20 0)
  (Atom (way > 2m OR wait 5) go 20 0)
  { Q (way > 1m) (Atom (way >= 1500mm) go 20 0) }
}"
    );
    assert_silent(&[
        "{ P (way > 2m) (Atom (way > 1m) go 20 0) { Q (way > 150cm) (Atom (way > 1m) go 20 0) } }",
        "{ P { Q (way > 2m) (Atom (wait 5) stop) } (Atom (way > 3m) go 20 0) }",
        "{ P (NOT way > 2m AND bumper) (Atom (way > 3m) go 20 0) }",
    ]);
}
