//! Tests name resolution, arguments, plans used by name and degeneracy; compares the resolved plans and the messages.

mod degeneracy;
mod files;
mod formal;
mod motion;
mod numbers;

use crate::samples::{compiled, judged, sources};

/// Records one snapshot: the text, its messages for a robot with all capabilities, and the plan.
macro_rules! assert_judged {
    ($text:literal) => {
        insta::assert_snapshot!(judged($text, None))
    };
    ($text:literal, $target:literal) => {
        insta::assert_snapshot!(judged($text, Some($target)))
    };
}

#[test]
fn every_form_resolves() {
    assert_judged!(
        "/// A tour.
{ Tour
  Leg
  FRAME 90deg { Inner (wait 1.50min OR bumper AND NOT (bumper OR sync ada)) FRAME 1rad Leg }
  ExecPlan 2 { (Atom (null) align(0, 15)) Leg }
  ((Atom (wait inf) rotate 180) here: (Atom (wait 500ms) go(0.50m/s 20deg/s)))^inf
  ExecPlan 3 Leg
}
{ Leg (atIsection 0100) (Atom (wait 0) goAvoid -0.0 1000cm) sigma_null }"
    );
}

#[test]
fn defaults_are_filled_in_and_texts_are_in_default_units() {
    assert_judged!(
        "{ P
  (Atom (wait 20) goAvoid 90.0 40 20)
  (Atom (wait 20) goAvoid(1.5rad, 10in))
  (Atom (wait 0.30min) goAvoid(heading module))
  (Atom (wait 1e1) path \"a b.txt\")
  (Atom (wait 10) path lastPath)
}"
    );
}

#[test]
fn unknown_names_come_with_the_nearest_known_one() {
    assert_judged!(
        "{ P (bumpr)
  (Atom (atintersection 0100) stop)
  (Atom (wait 5) Rotate 90)
  (Atom (wait 5) zigzag)
  Legg
}
{ Leg (Atom (wait 5) stop) }
{ Q Leg }"
    );
}

#[test]
fn a_quark_of_the_wrong_kind_has_a_help() {
    assert_judged!(
        "{ P (stop)
  (Atom (bumper) bumper)
  (Atom (x) stop)
  (Atom (wait 5) Leg)
  stop
  bumper
}
{ Leg (Atom (wait 5) stop) }
{ Q Leg }"
    );
}

#[test]
fn counts_of_arguments() {
    assert_judged!(
        "{ P
  (Atom (wait) stop)
  (Atom (wait 1 2) go 1)
  (Atom (bumper 3) go 1 2 3)
  (Atom (wait 1) goAvoid 90)
  (Atom (wait 1) goAvoid 1 2 3 4)
  Leg(5)
}
{ Leg (Atom (wait 5) stop) }"
    );
}

#[test]
fn types_of_arguments() {
    assert_judged!(
        "{ P
  (Atom (wait ada) go inf 0)
  (Atom (sync 7) go 20 \"fast\")
  (Atom (atIsection 0121) align 1.5 2)
  (Atom (atIsection 100) align left 2)
  (Atom (wait 1) align left right)
  (Atom (atIsection 0100cm) goAvoid(heading))
  (Atom (wait 1) goAvoid(90 module))
}"
    );
}

#[test]
fn units_of_arguments() {
    assert_judged!(
        "{ P
  (Atom (wait 20cm) go 20deg 0)
  (Atom (wait 5) rotate 90cm/s)
  (Atom (wait 5) align 7s 9)
  (Atom (wait 5) align 67.5deg -2.748893571891069rad) (Atom (wait 5) align 60deg 359.9deg)
  (Atom (wait 5) goAvoid 4m 0)
  (Atom (wait 5) goAvoid 4m 90deg 20)
  (Atom (wait 5) goAvoid 4s 3s)
  FRAME 3m (Atom (wait 5) stop)
}"
    );
}

#[test]
fn ranges_of_arguments() {
    assert_judged!(
        "{ P
  (Atom (wait -1) align 7 16)
  (Atom (wait 1e11) go 1e999 0)
  (Atom (stuck 1e11 OR stuck -5) goAvoid 0 4)
}"
    );
}

#[test]
fn frames_that_are_no_angle_worth_the_name() {
    assert_judged!("{ P FRAME 1e308rad { Q FRAME -2e5 (Atom (wait 1) stop) } FRAME 30 (Atom (wait 1) stop) }");
}

#[test]
fn loop_counts() {
    assert_judged!(
        "{ P
  ExecPlan 0 { (Atom (wait 5) stop) }
  (Atom (wait 5) stop)^1.5
  (Atom (wait 5) stop)^-2
  (Atom (wait 5) stop)^3s
}"
    );
}

#[test]
fn what_a_robot_cannot_do() {
    assert_judged!(
        "{ P (bumper)
  (Atom (wait 5) go 500 0)
  (Atom (wait 5) go 0 -7)
  (Atom (wait 5) goAvoid(heading module))
  (Atom (wait 5) goAvoid 90 40 2m/s)
}",
        "sim"
    );
}

#[test]
fn formal_notation_is_read() {
    assert_judged!(
        "{ P (stop, bumper, 3s)
  ((go 20 0, wait 5)(goAvoid(heading module), bumper OR r3 < 1, 500ms), sync ada, 10)^3
  (stop, null, 1min) (P2 (turn 90, null), wait 3, inf) (P2, (bumper OR wait 1), 2) FRAME 90deg (P3(7s, 2), null)
}
{ P2 (null) (rotate(90), RISING bumper, inf) }
{ P3 (T: time, n: count) (stop, bumper, T)^n }"
    );
}

#[test]
fn formal_notation_that_makes_no_sense() {
    assert_judged!(
        "{ P (bumper, bumper)
  (zigzag 3, bumper) (nowhere, bumper) (go 20, bumper) (stop, go 20 0) (stop, bumper, 3m) (stop, bumper, T) (stop, bumper, -1)
  (L: stop, bumper)
}"
    );
}

#[test]
fn a_plan_in_formal_notation_is_the_same_plan() {
    let text = "{ P (bumper OR wait 90)
  s1: (Atom (bumper OR wait 500ms) go 5 0)
  s2: ((Atom (NOT (bumper OR wait 5)) goAvoid(heading module))
      s3: { Q (after s1 (wait 0.5) OR after s2) FRAME 30deg (Atom (wait 1.5) path \"a b\") (Atom (null) stop) })
  ExecPlan 3 { { R (wait inf) ((Atom (wait inf) rotate 90))^inf } }
  ((Atom (r3 < 1 AND t > 5 OR RISING (bumper OR sync ada)) goAvoid 90 40) (Atom (bumper) goAvoid 90 40) (Atom (after s3) stop))^7
}";
    let plan = &compiled(text)[0].plan;
    let formal = plan.formal();
    insta::assert_snapshot!(formal);
    assert_eq!(compiled(&formal)[0].plan.formal(), formal);
    let nameless = |text: &str| text.replace("{ Q", "{ _").replace("{ R", "{ _");
    assert_eq!(nameless(&compiled(&formal)[0].plan.to_string()), nameless(&plan.to_string()));
}

#[test]
fn a_plan_without_an_interrupt_that_begins_with_a_loop_is_the_same_plan() {
    let plan = &compiled("{ P ((Atom (bumper) stop) (Atom (wait 1) go 5 0))^inf }")[0].plan;
    let formal = plan.formal();
    assert_eq!(formal, "{ P\n  ((stop, bumper)(go(5 0), null, 1s))^inf\n}\n");
    assert_eq!(compiled(&formal)[0].plan.formal(), formal);
}

#[test]
fn rising_and_after_keep_their_texts() {
    assert_judged!(
        "{ P (RISING bumper OR NOT (RISING (bumper AND wait 5)))
  s1: (Atom (bumper or (wait 500ms OR r3 < 1) OR r_3 < 2m) stop)
  (Atom (after s1 bumper OR after s1 (wait 0.5s OR r3 < 100cm) OR NOT (after s1 (r3 < 2))) stop)
  { Q (after s1) (Atom (after s1) stop) Leg Leg (Atom (RISING bumper) stop) }
  s2: { R (RISING bumper) (Atom (RISING bumper OR after s2 (RISING bumper)) stop) }
}
{ Leg (after s1) s1: (Atom (after s1) stop) }"
    );
}

#[test]
fn labels_and_causes_that_are_none() {
    assert_judged!(
        "{ P (after s OR after s3 OR after Leg)
  s1: (Atom (bumper OR wait 1 AND r3 < 1) stop)
  s2: ((Atom (bumper) stop))^2
  (Atom (after s1 (wait 1)) stop) (Atom (after s1 (wait 1 OR bumper)) stop) (Atom (after s2 bumper) stop)
  s4: Leg (Atom (after s4 bumper OR after s4 (r3 > 1)) stop)
}
{ Leg (bumper) s3: (Atom (wait 1) stop) }"
    );
    assert_judged!(
        "{ P s4: Leg (Atom (after s4 bumper OR after s4 (r3 > 1)) stop) } { Leg (bumper) (Atom (wait 1) stop) }"
    );
}

#[test]
fn signals_are_compared_in_their_units() {
    assert_judged!(
        "{ P (r_3(t) == r_5)
  (Atom (r 0 < 50cm OR x(t) ≥ -1.50 AND theta == 1rad) stop)
  { Q (t > 500ms OR NOT v \\leq 0.2m/s) (Atom (r3 == r5) align 3 5) (Atom (t > 0.5 OR NOT v <= 20) stop) }
  Until(inf) Until(1min)
}
{ Until (end: time) (Atom (t >= end OR t < inf) stop) }"
    );
}

#[test]
fn comparisons_that_make_no_sense() {
    assert_judged!(
        "{ P (r17 < 1)
  (Atom (bumper > 1 OR stuck > 30s OR stuck >= 0.50min AND wait > 5) stop)
  (Atom (stuck < 30s OR stuck 5 > 3 OR stuck > 3m OR wait > x OR stuck > 0 OR q > 1) stop)
  (Atom (x > 90deg) stop)
  (Atom (x > theta) stop)
  (Atom (x(3) > 1) stop)
  (Atom (t < x) stop)
  (Atom (t > -1s) stop)
  (Atom (go == stop) stop)
  (Atom (r < 1) stop)
  (Atom (r3 < inf) stop)
}"
    );
}

#[test]
fn signals_that_a_robot_lacks() {
    let text = "target t : crate t; capability odometry; use atoms; control go;";
    let atoms = crate::builtin::alphabets().iter().find(|file| !file.target).expect("atoms");
    let read = |text: &str| crate::alphabet::read(crate::diagnostic::SourceId(0), text).0.expect("an alphabet");
    let (alphabet, _) = crate::alphabet::combine(read(text), &[read(atoms.text)]);
    let (_, found) = crate::compile(crate::diagnostic::SourceId(0), "{ P (Atom (r3 < x) go) }", &alphabet, None);
    assert_eq!(found.iter().map(|found| found.code).collect::<Vec<_>>(), [crate::diagnostic::Code::E0401]);
}

#[test]
fn a_name_stands_for_one_thing() {
    assert_judged!(
        "{ P L: (Atom (wait 1) stop) L: (Atom (wait 2) stop) Q }
{ Q L: (Atom (wait 1) stop) }
{ Q (Atom (wait 1) stop) }
{ stop (Atom (wait 1) stop) }"
    );
}

#[test]
fn recursion_shows_its_cycle() {
    assert_judged!(
        "{ A { In (bumper) B } }
{ B ExecPlan 2 C }
{ C (Atom (wait 1) stop) (A) }
{ Self Self }
{ Caller A (Atom (bumpr) stop) }"
    );
}

#[test]
fn plans_that_explode_are_refused_before_they_are_copied() {
    let mut text = String::from("{ P0 (Atom (wait 1) stop) }\n");
    (1..40).for_each(|level| text += &format!("{{ P{level} P{0} P{0} }}\n", level - 1));
    assert!(judged(&text, None).contains("E0501"));
    let mut text = String::from("{ P0 (Atom (wait 1) stop) }\n");
    (1..20_000).for_each(|level| text += &format!("{{ P{level} P{} }}\n", level - 1));
    assert!(judged(&text, None).contains("E0106"));
}

#[test]
fn a_plan_of_too_many_states_names_its_loop() {
    assert_judged!(
        "{ P
  ExecPlan 1000000 { ExecPlan 1000000 { ExecPlan 1000000 { (Atom (wait 1) stop) } } }
}"
    );
    assert!(judged("{ P ExecPlan 99999999999999999999999999 { (Atom (wait 1) stop) } }", None).contains("E0501"));
    assert_eq!(compiled("{ P ExecPlan 9007199254740991 { (Atom (wait 1) stop) } }")[0].machine.states(), 1 << 53);
}

#[test]
fn repeated_interrupts_are_removed() {
    assert_judged!(
        "{ P (bumper)
  (Atom (bumper) stop)
  (Atom (bumper) rotate 90)
  { Inner (wait 5s OR bumper)
    (Atom (bumper OR wait 5000ms) stop)
    { Same (NOT (NOT bumper)) (Atom (bumper AND bumper) stop) }
  }
  { Never (wait inf OR bumper) (Atom (bumper OR wait inf) stop) }
  (Atom (bumper AND wait 5) stop)
}"
    );
}

#[test]
fn what_is_not_the_same_function_is_not_repeated() {
    assert_judged!(
        "{ P (NOT wait 5)
  (Atom (NOT wait 5) stop)
  { Turned (rendezvous ada) (Atom (rendezvous ada) stop) }
  { Once (wait inf) (Atom (null) stop) }
  { Either (bumper OR NOT wait 5) (Atom (NOT wait 5 OR bumper) stop) }
}"
    );
}

#[test]
fn a_repeated_interrupt_is_warned_of_once_however_often_its_plan_is_used() {
    assert_judged!("{ P (bumper) ExecPlan 3 Leg Leg }\n{ Leg (Atom (bumper OR wait 1) stop) (Atom (bumper) stop) }");
}

#[test]
fn what_two_plans_copy_is_warned_of_once() {
    assert_judged!("{ A B }\n{ B (bumper) (Atom (bumper) stop) }\n{ C B }");
}

#[test]
fn an_infinite_wait_keeps_its_text_and_never_fires() {
    assert_judged!("{ P (wait inf OR bumper) (Atom (NOT wait inf) stop) { Q (wait inf) (Atom (wait inf) stop) } }");
}

#[test]
fn a_plan_may_be_called_as_a_signal_is() {
    assert_judged!("{ t (Atom (wait 1) stop) }");
}

#[test]
fn a_string_after_a_plan_name_has_a_help() {
    assert_judged!("{ P (Q) R }\n{ Q (Atom (wait 1) stop) }\n{ R (Atom (wait 1) stop) }");
}

#[test]
fn a_plan_with_parameters_is_copied_with_what_is_given() {
    assert_judged!(
        "{ Main Twice(3, 15cm/s) Leg(20, 90, 0.5rad, 0100, 7, ada, 1.5, inf, heading module) Twice(inf, 0.1m/s) }
{ Twice (n: count, v: speed) ExecPlan n { Pair(v, n) } }
{ Pair (v: speed, again: count) ((Atom (wait 1) go v 0) (Atom (wait 1) go(v -1)))^again }
{ Leg (v: speed, far: length, by: angle, b: bits[4], s: sonar, who: robot, d: time, T: time, m: module) (x > far OR wait T)
  (Atom (atIsection b OR t < T) goAvoid by far v)
  { Inner (t >= d OR v > v) (Atom (sync who OR wait d) align s 3) (Atom (wait inf) goAvoid(m)) }
}"
    );
}

#[test]
fn what_is_given_is_not_what_a_parameter_is() {
    assert_judged!(
        "{ Main Leg(5) Leg(90deg, 3) Leg(1, 1.5) Leg(1, 2, 3) Leg Rest(5) Leg(w, 2) }
{ Leg (v: speed, n: count) (Atom (wait v) go v n) (Atom (x > v) go v 0)^v ExecPlan m { (Atom (wait 1) stop) } }
{ Rest (Atom (wait 1) stop) }
{ Odd (v: spead, v: speed, v: time, w: bits) { Inner (u: length) (Atom (x > u) go v 0) } }"
    );
}

#[test]
fn an_unknown_type_is_one_error() {
    assert_judged!(
        "{ Main Leg(20) Twice(3) Far(2m) }
{ Leg (v: spead) (bumper) (Atom (x > v) go v 0) }
{ Twice (n: cuont) (Atom (wait 1) stop)^n }
{ Far(d: distance) Leg(d) { Near (far: Length) (Atom (r0 < far) stop) } }"
    );
}

#[test]
fn a_value_that_is_out_of_range_is_shown_where_it_is_given() {
    assert_judged!(
        "{ Main Leg(5m/s) Leg(20) }\n{ Leg (v: speed) (Atom (wait 1) go v 0) (Atom (wait 1) go v 0) }",
        "sim"
    );
}

#[test]
fn a_plan_that_nothing_gives_its_parameters() {
    assert_judged!("{ Leg (v: speed) (Atom (wait 1) go v 0) }");
    let sample = crate::samples::alphabet(None);
    let text = "{ Leg (v: speed) (Atom (wait 1) go v 0) }";
    let (_, found) = crate::compile(crate::diagnostic::SourceId(0), text, &sample, Some("Leg"));
    assert_eq!(found.iter().map(|found| found.code).collect::<Vec<_>>(), [crate::diagnostic::Code::E0301]);
}

#[test]
fn a_label_behind_a_plans_name_is_no_parameter() {
    assert_judged!(
        "{ P (s1: (Atom (bumper) stop) s2: Q)^3 (s3: Speed) (s4: spede)^2 }
{ Q (s1: R (s2: R)) }
{ R (null) (one: { S (Atom (bumper) stop) }) }
{ Speed (s1: spede) }
{ spede (s1: R)^2 }"
    );
}

#[test]
fn one_letter_is_not_similar_to_another() {
    assert_judged!("{ A (q) (Atom (wait 1) Z) B }");
}

#[test]
fn the_loop_that_makes_most_states_is_named() {
    let text = "{ P ExecPlan 2000 { (Atom (wait 1) stop) } ExecPlan 1000 { ((Atom (wait 1) stop))^500 } }";
    let too_large = crate::fsm::expand(&compiled(text)[0].nondegenerate).expect_err("502001 states");
    let source = sources().add("plan.mdle", text);
    let range = too_large.span().expect("a place").within(source);
    assert!(text[range].starts_with("ExecPlan 1000"));
    assert!(too_large.labels[0].text.contains("500000"), "{too_large:?}");
}
