//! Tests the messages of each lint, and plans that no lint reports.

use crate::samples::judged;

/// Records one snapshot: the text of a plan, its messages, and the resolved plan.
macro_rules! assert_judged {
    ($text:literal) => {
        insta::assert_snapshot!(judged($text, None))
    };
}

/// Checks that no lint reports these plans.
fn assert_silent(plans: &[&str]) {
    for plan in plans {
        let judged = judged(plan, None);
        assert!(!judged.contains("[W") && !judged.contains("[E"), "{judged}");
    }
}

#[test]
fn a_plan_that_nothing_ends() {
    assert_judged!("{ Cruise (Atom (wait 5) stop) { Ahead (Atom (wait inf) go 20 0) } }");
    assert_silent(&[
        "{ P (bumper) (Atom (null) go 20 0) }",
        "{ P { Q (wait 5) (Atom (null) go 20 0) } }",
        "{ P (Atom (null) rotate 90) }",
        // An endless loop counts as intended.
        "{ P ExecPlan inf { (Atom (wait 5) go 20 0) (Atom (null) rotate 90) } }",
    ]);
}

#[test]
fn frames_that_no_law_uses() {
    assert_judged!(
        "{ P (bumper)
  FRAME here (Atom (wait 5) align 7 9)
  FRAME here { Q (wait 9) (Atom (wait 5) advance 1m) (Atom (wait 5) stop) }
  FRAME here ((Atom (wait 5) go 20 0) FRAME here (Atom (wait 5) rotate 90))
  FRAME here ((Atom (null) advance 1m) (Atom (null) turn 90))^4
}"
    );
    assert_silent(&[
        "{ P (bumper) FRAME here { Q (Atom (wait 5) stop) FRAME 90 (Atom (wait 9) (goAvoid 0 3m)) } }",
        "{ P (bumper) FRAME here ExecPlan 3 { (Atom (wait 5) stop) (Atom (null) path walk) } }",
        "{ P (bumper) FRAME 90deg (Atom (wait 5) align 7 9) }",
    ]);
}

#[test]
fn a_drive_that_may_never_arrive() {
    assert_judged!(
        "{ P (bumper)
  (Atom (null) (goAvoid 0 4m))
  { Q (bumper) (Atom (bumper OR null) (goAvoid 90 4m))^2 }
  Leg
  { R (wait 1min) Leg }
  { S (bumper AND wait 60s) (Atom (null) (goAvoid 0 4m)) (Atom (bumper AND wait 9) (goAvoid 90 4m)) }
  (Atom (RISING bumper) (goAvoid 0 4m))
}
{ Leg (Atom (null) (goAvoid 180 4m)) }"
    );
    assert_silent(&[
        "{ P (bumper) (Atom (stuck 30) (goAvoid 0 4m)) (Atom (atIsection 1000) (goAvoid 0 40)) }",
        "{ P (bumper OR wait 2min) (Atom (null) (goAvoid 0 4m)) }",
        "{ P (bumper) { Q (t > 60) ((Atom (null) (goAvoid 0 4m)))^2 } (Atom (way > 20) (goAvoid 0 4m)) }",
        "{ P (lowBattery) (Atom (null) (goAvoid 0 4m)) }",
        "{ P (bumper AND wait 60s OR wait 2min AND way > 5) (Atom (null) (goAvoid 0 4m)) }",
        "{ P (stuck 30 AND (bumper OR wait 1min)) (Atom (null) (goAvoid 0 4m)) }",
        "{ P (bumper) (Atom (null) (goAvoid(sun module))) }",
    ]);
}

#[test]
fn a_stuck_without_a_goal() {
    assert_judged!(
        "{ P (bumper OR stuck 1min)
  (Atom (stuck 30) go 20 0)
  { Q (r0 < 1m AND NOT stuck 20) (Atom (stuck 5 OR bumper) (goAvoid(sun module)))^2 }
}"
    );
    assert_silent(&[
        "{ P (bumper) (Atom (stuck 30) (goAvoid 0 4m)) { Q (stuck 1min) (Atom (wait 5) stop) (Atom (null) goAvoid 0 3m) } }",
        "{ P (wait 9min) a: (Atom (stuck 30) (goAvoid 0 4m)) { Q (NOT after a (stuck 30)) (Atom (wait 2) go -15 0) } }",
        "{ P (stuck 1min) (Atom (null) lead 2m 0deg 3m) }",
    ]);
}

#[test]
fn a_stuck_without_time_for_progress() {
    assert_judged!(
        "{ P (bumper)
  (Atom (stuck 0.5ms OR wait 1min) (goAvoid 0 4m))
  { Q (stuck 0.9) (Atom (wait 5) stop) (Atom (null) (goAvoid 0 4m 10)) }
  (Atom (stuck 30) (goAvoid 0 4m 0.3cm/s))
  (Atom (stuck 0.5s) (goAvoid 90 4m))
  (Atom (stuck 2s) (goAvoid 90 4m 5cm/s))
}"
    );
    assert_silent(&[
        "{ P (bumper) (Atom (stuck 334) (goAvoid 0 4m 0.3cm/s)) }",
        "{ P (bumper) (Atom (stuck 0.501) (goAvoid 0 4m)) (Atom (stuck 0.11) (goAvoid 0 4m 100)) }",
        "{ P (bumper) (Atom (stuck 0.4) (goAvoid 0 18cm)) (Atom (stuck 0.1) lead 2m 0deg 3m) }",
        "{ P (bumper) { Q (stuck 0.6) (Atom (null) (goAvoid 0 4m 10)) (Atom (null) (goAvoid 90 4m 20)) } }",
        "{ P (bumper) (Atom (stuck inf OR wait 9) (goAvoid 0 4m)) }",
    ]);
}

#[test]
fn a_stuck_that_begins_anew_with_each_drive() {
    assert_judged!(
        "{ P (stuck 15s)
  ExecPlan 9 { (Atom (wait 4s) (goAvoid 0 4m)) { Q (bumper OR t > 9) (Atom (null) (goAvoid 90 4m))^2 } }
  { R (bumper AND NOT stuck 40) ((Atom (stuck 10) (goAvoid 0 4m)))^3 (Atom (null) turn 90) }
  (Atom (stuck 9 OR wait 5 AND wait 8) (goAvoid 180 4m))
}"
    );
    assert_silent(&[
        "{ P (stuck 15) ExecPlan inf { (Atom (wait 4) (goAvoid 0 4m)) (Atom (bumper) (goAvoid 90 4m)) } }",
        "{ P (stuck 15) ExecPlan inf { (Atom (wait 15) (goAvoid 0 4m)) (Atom (wait 14.5) (goAvoid 90 4m)) } }",
        "{ P (stuck 15) ExecPlan inf { (Atom (wait 4 AND r0 < 2m) (goAvoid 0 4m)) (Atom (null) turn 90) } }",
        "{ P (stuck 15) ExecPlan inf { (Atom (t == 4 OR rendezvous ada OR way > 1m) (goAvoid 0 4m)) } }",
        "{ P (stuck 15) ExecPlan inf { (Atom (wait 4) lead 2m 0deg 3m) } }",
        "{ P (stuck inf OR bumper) ExecPlan inf { (Atom (wait 4) (goAvoid 0 4m)) } }",
    ]);
}

#[test]
fn sonars_that_no_turn_makes_equal() {
    assert_judged!(
        "{ P (bumper)
  (Atom (wait 5) align 3 3)
  { Q (wait 1min) ((Atom (wait 5) align r_11 r_3))^2 (Atom (wait 5) stop) }
}"
    );
    assert_silent(&["{ P (bumper) (Atom (wait 5) align 3 5) (Atom (wait 5) align 15 1) (Atom (wait 5) align 3 10) }"]);
}

#[test]
fn a_wait_for_a_robot_that_may_never_come() {
    assert_judged!(
        "{ P (bumper)
  (Atom (sync ada) stop)
  { Q (bumper) (Atom (sync ada AND rendezvous bob) stop)^2 }
  (Atom (rendezvous ada OR bumper) (go 20 0))
}"
    );
    assert_silent(&[
        "{ P (bumper) (Atom (rendezvous ada OR wait 2min) stop) }",
        "{ P (bumper OR wait 10min) { Q (null) ((Atom (sync ada AND rendezvous bob) stop))^2 } }",
        "{ P (bumper) { Q (t > 60) (Atom (sync ada) stop) } (Atom (NOT sync ada) stop) }",
        "{ P (bumper) (Atom (sync ada) turn 90) }",
    ]);
}

#[test]
fn what_is_never_reached() {
    assert_judged!(
        "{ P (bumper)
  { Q (wait 90) (Atom (null) go 20 0) (Atom (wait 5) stop) (Atom (wait 6) stop) }
  ExecPlan 3 { (Atom (wait 1) stop) { R (Atom (null) stop) } }
}
{ S ((Atom (wait 5) go 20 0))^inf (Atom (wait 5) stop) }
{ U (wait 10) (Atom (null) stop) { V (wait 3) (Atom (null) go 20 0) (Atom (wait 1) stop) } }
{ T (bumper) (Atom (bumper) stop) (Atom (wait 5) stop) }"
    );
    assert_silent(&["{ P (bumper) { Q (wait 9) (Atom (null) stop)^1 } (Atom (wait 5) stop) }"]);
}

#[test]
fn loops_that_are_skipped_whole() {
    assert_judged!(
        "{ P
  ExecPlan inf { (Atom (bumper) go 20 0) (Atom (NOT sync ada) turn 90) }
  ({ Leg (atIsection 1000 OR wait 20) (Atom (wait 5) go 20 0) })^3
}
{ Q (((Atom (bumper) go 20 0))^2 (Atom (sync ada) stop))^2 }
{ R (r0 < 1m) ExecPlan inf { (Atom (bumper) go 20 0) (Atom (r0 < 50cm OR wait 4) go -20 0) } }"
    );
    assert_silent(&[
        // A pass takes time or cannot be skipped, or there is only one pass.
        "{ P ExecPlan 4 { (Atom (bumper) go 20 0) (Atom (wait 0.5) stop) } }",
        "{ P ExecPlan 4 { (Atom (bumper) go 20 0) (Atom (NOT bumper) stop) } }",
        "{ P ExecPlan 4 { (Atom (atIsection 1000) go 20 0) (Atom (atIsection 0100) stop) } }",
        "{ P ExecPlan 4 { (Atom (bumper) go 20 0) (Atom (null) turn 90) } }",
        "{ P ExecPlan 1 { (Atom (bumper) go 20 0) } }",
    ]);
}

#[test]
fn numbers_that_look_like_another_unit() {
    assert_judged!(
        "{ P
  (Atom (wait 20000) go 0.5 90)
  (Atom (wait 5) rotate(1.57))
  (Atom (wait 5000) advance 100)
  (Atom (t >= 1000) advance -50)
  Leg(60)
  (Atom (wait 5) goAvoid 90 4000 2000)
  FRAME 3.14 { Q (wait 86400) (Atom (wait 1) go -0.25 0.36) }
  (Atom (r0 < 50 OR way > 300) advance 300)
  (Atom (v > 500 OR NOT r 3 < 2000) goAvoid 0 400)
}
{ Leg (far: length) (Atom (null) advance far) }"
    );
    assert_silent(&[
        "{ P (Atom (wait 20000s) go 0.5cm/s 90rad/s) (Atom (wait 3600) rotate(1.57deg)) }",
        "{ P (Atom (wait 1800 OR t > 1260) advance 49) (Atom (wait 5000s) advance 100m) (Atom (wait 999) turn 90) }",
        "{ P (Atom (r0 < 50m OR way > 300m OR x > 90 OR r_3 < 3.5) advance 40) (Atom (age 3 > 50) stop) }",
        "{ P (Atom (wait 0.5) go 0 0.36) (Atom (wait 9) rotate 22.5) (Atom (wait 9) turn 3) (Atom (wait 9) goAvoid(heading module)) }",
    ]);
}
