//! Tests the reasons why an atom or a behavior did not begin, or did not begin again: in loops, in behaviors that ran,
//! and with all names that tests of plans accept.

use super::questions::answers;
use super::scripted::{outputs, ping};

/// The answer covers the time since the atom last began, and names the last of several chances to begin.
#[test]
fn later_passes_count() {
    let plan = "{ Rounds (wait 10s)
  ((Atom (wait 1s) go 20 0) (Atom (r0 < 50cm) go 1 0) (Atom (wait 500ms) go 10 0))^4
  (Atom (null) stop)
}
";
    let outputs = outputs(50, |turn, y| {
        // An obstacle is near at the beginning of the second pass, but not in the third.
        ping(y, 0, if (14..36).contains(&turn) { 0.4 } else { 2.0 });
    });
    let questions = ["--not go 1 0", "--not go 10 0", "--not go 20 0", "--not stop"];
    insta::assert_snapshot!(answers("rounds", plan, &outputs, &questions));
}

/// Each pass is a chance to begin; the answer names the first and the last chance.
#[test]
fn each_pass_is_a_chance() {
    let plan = "{ Passes (wait 10s)
  ({ Leg (wait 1s) (Atom (r0 < 50cm) go 20 0) (Atom (null) go 10 0) (Atom (null) go 5 0) })^3
  (Atom (null) stop)
}
";
    let outputs = outputs(35, |turn, y| ping(y, 0, if turn == 5 { 0.51 } else { 2.0 }));
    insta::assert_snapshot!(answers("passes", plan, &outputs, &["--not go 10 0", "--not go 5 0"]));
}

/// A behavior has begun when the law of any of its atoms is applied.
#[test]
fn a_behavior_began() {
    let plan = "{ Whole (wait 4s)
  (Atom (wait 1s) go 20 0)
  { Near (wait 1s) (Atom (r0 < 1m) go 10 0) (Atom (null) go 5 0) }
  { Gone (r0 < 1m) (Atom (wait 1s) go 4 0) (Atom (null) go 3 0) }
  (Atom (null) stop)
}
";
    let outputs = outputs(30, |_, y| ping(y, 0, 0.75));
    insta::assert_snapshot!(answers("behaviors", plan, &outputs, &["--not Near", "--not Gone", "--not Whole"]));
}

/// Laws can be named as in tests of plans: with other units, or by their names alone.
#[test]
fn laws_have_the_names_of_tests() {
    let plan =
        "{ Names (wait 4s)\n  (Atom (wait 1s) go 20 0)\n  (Atom (bumper) goAvoid 0 3)\n  (Atom (null) go 5 0)\n}\n";
    let outputs = outputs(20, |_, y| ping(y, 0, 2.0));
    let questions = ["--not go 5cm/s 0", "--not goAvoid", "--not go", "--not goAvoid 0rad 300cm", "--not gone"];
    insta::assert_snapshot!(answers("names", plan, &outputs, &questions));
}

/// A skipped law has not begun, even if the law has a goal.
#[test]
fn a_skipped_law_has_not_begun() {
    let plan = "{ Skipped (wait 4s)
  (Atom (wait 1s) go 20 0)
  (Atom (bumper OR stuck 2s) goAvoid 0 3)
  { Slow (stuck 1s) (Atom (wait 500ms) go 5 0) (Atom (wait 500ms) goAvoid 0 3) }
  (Atom (null) stop)
}
";
    let outputs = outputs(25, |turn, y| {
        (0..16).for_each(|sonar| ping(y, sonar, 2.0));
        y.switches = u32::from(turn == 10);
    });
    insta::assert_snapshot!(answers("skipped-law", plan, &outputs, &["1.0", "1.4", "1.5", "1.7", "--not 3"]));
}
