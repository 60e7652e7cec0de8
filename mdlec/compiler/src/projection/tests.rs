//! Tests the projected plans of groups, as text, and the messages about groups.

use super::projected;
use crate::compile;
use crate::diagnostic::{Code, SourceId};
use crate::samples::{alphabet, judged};
use crate::syntax::NoFiles;

/// Returns the plans of the robots of the groups in `text`. Asserts that the text of these plans, which contains no
/// groups, compiles to the same plans.
fn plans(text: &str) -> String {
    let alphabet = alphabet(None);
    let (compiled, found) = compile(SourceId(0), text, &alphabet, None);
    assert_eq!(found, [], "{text}");
    let plans = projected(SourceId(0), text, &alphabet, None, &mut NoFiles);
    let (again, found) = compile(SourceId(0), &plans, &alphabet, None);
    assert_eq!(found, [], "{plans}");
    let forms = |compiled: &[crate::Compiled]| compiled.iter().map(|one| one.plan.formal()).collect::<Vec<_>>();
    assert_eq!(forms(&again), forms(&compiled), "{plans}");
    assert!(again.iter().all(|plan| plan.part.is_none()), "{plans}");
    plans
}

#[test]
fn each_robot_has_a_plan_and_the_first_one_decides() {
    insta::assert_snapshot!(plans(
        "{ Group [robot1 robot2 robot3] Round (any bumper OR wait 2min)
  (Atom (all rendezvous) stop)
  (Atom (robot1.x > 7m) (formation triangle 1m (goAvoid 0 7m 20)))
}"
    ));
}

#[test]
fn an_atom_whose_law_completes_is_followed_by_one_that_waits() {
    insta::assert_snapshot!(plans(
        "{ Group [a b c] R (wait 1min)
  (Atom (all rendezvous) stop)
  (Atom (null) (rotate 90))
  (Atom (b.rendezvous AND c.rendezvous OR wait 20) stop)
  (Atom (null) (advance 2m 20cm/s))
}"
    ));
}

#[test]
fn in_the_head_each_robot_reads_its_own() {
    insta::assert_snapshot!(plans(
        "{ Group [a b c] R (any bumper OR any x > y OR b.x > 3m AND NOT b.r 3 < 1m OR a.x > a.y OR wait 1min OR RISING a.v > 1cm/s)
  (Atom (wait 9) (go 20 0))
}"
    ));
}

#[test]
fn behaviors_strings_frames_and_labels_are_those_of_the_group() {
    insta::assert_snapshot!(plans(
        "{ Group [a b] R (wait 1min)
  { Inner (a.bumper OR wait 50) (Atom (all rendezvous) stop) (Atom (RISING a.x > 1m) (go 20 0)) }
  FRAME 90deg (x: (Atom (a.x > 3m OR wait 5) (rotate 0)) (Atom (after x (a.x > 3m)) stop))
  FRAME here (Atom (wait 5) (rotate 0))
  y: { Last (Atom (wait 2) stop) }
}"
    ));
}

#[test]
fn formations_have_slots_for_any_number_of_robots() {
    insta::assert_snapshot!(plans(
        "{ Group [a b c d e] R (wait 1min)
  (Atom (wait 9) formation line 80cm (goAvoid 0 7m 20))
  (Atom (wait 9) formation column 1.5m goAvoid(0, 7m))
  (Atom (wait 9) formation(line, 3ft, go(20cm/s, 0)))
  (Atom (wait 9) (formation column 1m stop))
}
{ Group [a b] Pair (wait 1min) (Atom (wait 9) formation line 1m (path way)) }"
    ));
}

/// Records the messages about each of these texts.
macro_rules! assert_refused {
    ($($text:literal),* $(,)?) => {
        insta::assert_snapshot!([$(judged($text, None)),*].join("\n════════\n"))
    };
}

#[test]
fn a_group_has_two_robots_or_more_with_names_of_their_own() {
    assert_refused!(
        "{ Group [robot1] R (any bumper OR wait 2min) (Atom (wait 5) stop) }",
        "{ Group [] R (wait 2min) (Atom (wait 5) stop) }",
        "{ Group [a b a] R (wait 2min) (Atom (wait 5) stop) }",
        "{ Group [a, 5] R (wait 2min) (Atom (wait 5) stop) }",
        "{ Group a b R (wait 5) (Atom (wait 5) stop) }",
        "{ Group [a b] R (v: speed) (wait 2min) (Atom (wait 5) stop) }",
        "{ Group [a b c d e f g h i j k] R (wait 2min) (Atom (wait 5) stop) }",
        "{ group [a b] R (wait 5) (Atom (wait 5) stop) }",
        "{ Group R [a b] (wait 5) (Atom (wait 5) stop) }",
    );
}

#[test]
fn a_group_is_a_plan_by_itself() {
    assert_refused!(
        "{ P (wait 5) { Group [a b] R (wait 5) (Atom (wait 5) stop) } }",
        "{ P (wait 5) R } { Group [a b] R (wait 5) (Atom (wait 5) stop) }",
        "{ Group [a b] R (wait 5) (Atom (wait 5) stop) R P { Q (v: time) (Atom (wait 5) stop) } } { P (Atom (wait 5) stop) }",
        "{ Group [a b] R (wait 5) ExecPlan 3 { (Atom (wait 5) stop) } (Atom (wait 5) stop)^2 (stop, bumper) }",
        "{ Group [a b] R (wait 5) (Atom (wait 9) stop) } { R (wait 5) (Atom (wait 5) stop) }",
        "{ Group [a b] R (wait 5) (Atom (wait 9) stop) } { R_a (wait 5) (Atom (wait 5) stop) }",
        "{ Group [a b] R (wait 5) (Atom (wait 9) stop) } { T (wait 50) (Atom (wait 1) (go 5 0)) R_a ExecPlan 2 R_b }",
        "{ Group [a b] R (wait 5) (Atom (wait 9) stop) R_b }",
    );
}

#[test]
fn conditions_of_other_robots_are_refused() {
    assert_refused!(
        "{ Group [a b] R (bumper OR all bumper OR wait 5)
  (Atom (x > 5m OR b.x > 5m) stop) (Atom (any bumper) stop) (Atom (c.bumper OR rendezvous) stop)
  { Q (all rendezvous) (Atom (wait 5) stop) } }",
        "{ Group [a b] R (a.x > 5m AND b.x > 5m OR wait 5)
  (Atom (any rendezvous) stop) (Atom (a.rendezvous) stop) (Atom (any) stop) (Atom (a.x > b.x OR a.x > x) stop) }",
        "{ Group [a b] R (any bumper) (Atom (wait 5) stop) }",
        "{ P (wait 5) (Atom (any bumper) formation line 1m (go 5 0)) (Atom (robot1.x > 3m OR all bumper) stop) }",
    );
}

#[test]
fn no_robot_reads_that_none_of_them_has_a_quark() {
    assert_refused!(
        "{ Group [a b] R (NOT any bumper AND wait 8 OR NOT (any x > 3m) OR NOT (any bumper OR wait 5) OR wait 20)
  (Atom (wait 12) (go 20 0)) }",
    );
    plans("{ Group [a b] R (NOT (NOT any bumper) OR NOT a.bumper AND wait 3 OR wait 20) (Atom (wait 12) stop) }");
}

#[test]
fn causes_are_those_of_the_labelled_atom() {
    insta::assert_snapshot!(plans(
        "{ Group [a b c] R (wait 1min)
  x: (Atom (all rendezvous OR b.rendezvous OR wait 5) stop)
  (Atom (after x (all rendezvous) OR after x b.rendezvous OR after x (wait 5)) stop) }"
    ));
    assert_refused!(
        "{ Group [a b] R (wait 1min)
  x: (Atom (all rendezvous OR wait 5) stop) (Atom (after x (past b 1) OR after x (b.bumper)) stop) }",
    );
}

#[test]
fn a_part_knows_the_words_of_its_group() {
    let text = "{ Group [a b c] R (any bumper OR wait 20)
  (Atom (all rendezvous) stop) (Atom (b.rendezvous) stop) (Atom (all rendezvous) stop) }";
    let (compiled, found) = compile(SourceId(0), text, &alphabet(None), None);
    assert_eq!(found, []);
    let part = |robot: usize| compiled[robot].part.as_ref().unwrap();
    let own = |text: &'static str| part(0).own_words(text).join(", ");
    assert_eq!(own(" all  rendezvous "), "past b 1, past b 3, past c 1, past c 3");
    assert_eq!([own("b.rendezvous"), own("c.rendezvous")], ["past b 2", "c.rendezvous"]);
    assert_eq!([own("any bumper"), own("a.x > 10cm"), own("anything")], ["bumper", "x > 10cm", "anything"]);
    assert_eq!(part(1).own_words("b.bumper"), ["bumper"]);
    assert_eq!(part(1).own_words("all rendezvous"), ["all rendezvous"]);
}

#[test]
fn lints_propose_no_words_of_a_single_robot() {
    assert_refused!(
        "{ Group [a b] R (wait 1min) (Atom (a.bumper) stop) (Atom (a.bumper) stop) (Atom (a.t < 30s) (go 20 0)) }",
    );
}

#[test]
fn wrong_arguments_are_those_of_the_law_as_written() {
    assert_refused!(
        "{ Group [a b] R (wait 1min)
  (Atom (wait 3) formation line 1m (goAvoid 0)) (Atom (wait 3) formation line 1m (goAvoid 0 7m 20 5))
  (Atom (wait 3) formation line 1m (goAvoid 0 7s)) (Atom (wait 3) formation line 1m (goAvoid inf 7m)) }",
    );
}

#[test]
fn no_robot_of_a_group_names_itself() {
    assert_refused!(
        "{ Group [a b c] R (wait 1min) (Atom (wait 3) (Follow b)) (Atom (wait 3) formation line 1m (Follow a)) }",
        "{ Group [a b] R (any sync b OR any sync d OR b.past b 1 OR wait 1min)
  (Atom (a.sync a OR wait 5) stop) (Atom (wait 5) (slot b 1m 0m)) }",
    );
    plans("{ Group [a b] R (any sync d OR b.past a 1 OR wait 1min) (Atom (a.sync b OR wait 3) (Follow d)) }");
    plans("{ Group [a way] R (wait 1min) (Atom (wait 3) (path way)) }");
}

#[test]
fn an_infinite_timer_ends_no_group() {
    assert_refused!("{ Group [a b] R (any bumper OR wait inf) (Atom (wait 5) stop) }");
}

#[test]
fn the_others_have_a_frame_where_their_law_uses_it() {
    insta::assert_snapshot!(plans(
        "{ Group [a b] R (wait 1min)
  FRAME here (Atom (wait 5) formation column 1m (goAvoid 0 7m 20))
  FRAME here ((Atom (wait 5) formation column 1m (rotate 0)) (Atom (wait 5) stop))
  FRAME 90deg ((Atom (wait 5) formation column 1m (rotate 0)) FRAME here (Atom (wait 5) (rotate 90)))
  FRAME here { Inner (wait 9) (Atom (wait 5) (rotate 0)) }
}"
    ));
}

#[test]
fn a_frame_that_no_robot_uses_is_reported() {
    assert_refused!("{ Group [a b] R (wait 1min) FRAME here (Atom (wait 5) formation column 1m (go 20 0)) }");
}

#[test]
fn formations_that_make_no_sense_are_refused() {
    assert_refused!(
        "{ Group [a b] R (wait 5min)
  (Atom (wait 5) formation colum 1m (goAvoid 0 7m 20))
  (Atom (wait 5) formation triangle 1m (goAvoid 0 7m 20))
  (Atom (wait 5) formation line 0m (goAvoid 0 7m 20))
  (Atom (wait 5) formation line -1m (goAvoid 0 7m 20))
  (Atom (wait 5) formation line 1 (goAvoid 0 7m 20))
  (Atom (wait 5) formation line 1s (goAvoid 0 7m 20))
  (Atom (wait 5) formation line)
  (Atom (wait 5) formation)
  (Atom (wait 5) formation line 1m)
  (Atom (wait 5) formation 5 1m (go 5 0))
  (Atom (wait 5) formation line 1m (formation line 1m (go 5 0)))
  (Atom (wait 5) formation line 1m (goAvoid(h module)))
  (Atom (wait 5) formation line 1m 5)
  (Atom (wait 5) formation line c (go 5 0))
}",
        "{ Group [a b] R (wait 5min)
  (Atom (wait 5) formation line 1m (goAvoid 0 7s 20))
  (Atom (wait 5) formation line 1m (gooAvoid 0 7m 20))
  (Atom (wait 5) formation line 1000m (go 20 0))
}",
    );
}

#[test]
fn an_executable_has_no_groups() {
    let mut alphabet = alphabet(Some("scout"));
    alphabet.has_engine = false;
    let text = "{ Group [a b] R (wait 5) (Atom (all rendezvous) stop) } { P (wait 5) R }";
    let (compiled, found) = compile(SourceId(0), text, &alphabet, None);
    let messages: Vec<_> = found.iter().map(|found| found.message.as_str()).collect();
    assert_eq!(found[0].code, Code::E0403);
    let link = "the group `R` needs the state link, and an executable has none";
    assert_eq!(messages, [link, "the group `R` cannot be part of a plan"]);
    assert!(compiled.is_empty());
}
