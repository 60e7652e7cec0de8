//! Tests that a plan printed in formal notation resolves to the same plan again, including labels that `after` reads.

use crate::samples::{compiled, judged};

/// Returns the text of a plan in formal notation; checks that compiling and printing this text gives the same text.
fn formal(text: &str) -> String {
    let formal = compiled(text)[0].plan.formal();
    assert_eq!(compiled(&formal)[0].plan.formal(), formal);
    formal
}

#[test]
fn each_use_whose_labels_are_asked_is_a_plan() {
    let text = "{ P (bumper)
  Leg { In (wait 9) s1: Leg } (Leg)^2
  (Atom (after s1) stop)
}
{ Leg (wait 5 OR bumper) s1: (Atom (bumper) stop) (Atom (after s1 OR wait 1) stop) Plain }
{ Plain (wait 3) (Atom (null) stop) }";
    insta::assert_snapshot!(formal(text), @r"
    { P (bumper)
      Leg
      (s1: Leg_2, null, 9s)
      (Leg_3)^2
      (stop, after s1)
    }
    { Leg (wait 5 OR bumper)
      s1: (stop, bumper)
      (stop, after s1, 1s)
      ((stop, null), null, 3s)
    }
    { Leg_2 (wait 5 OR bumper)
      s1: (stop, bumper)
      (stop, after s1, 1s)
      ((stop, null), null, 3s)
    }
    { Leg_3 (wait 5 OR bumper)
      s1: (stop, bumper)
      (stop, after s1, 1s)
      ((stop, null), null, 3s)
    }
    ");
}

#[test]
fn nested_alternatives_are_in_parentheses() {
    let text = "{ P s1: (Atom (bumper OR (wait 1 OR r3 < 2) OR wait 7) stop) s2: (Atom (null OR wait 5) stop)
  s3: (Atom ((wait 3 OR bumper) OR wait 2) stop)
  (Atom (after s1 (wait 1 OR r3 < 2) OR after s1 (wait 7) OR after s2 (wait 5)) stop)
  (Atom (after s3 (wait 3 OR bumper)) stop) }";
    insta::assert_snapshot!(formal(text), @r"
    { P
      s1: (stop, bumper OR (wait 1 OR r3 < 2) OR wait 7)
      s2: (stop, null OR wait 5)
      s3: (stop, (wait 3 OR bumper) OR wait 2)
      (stop, after s1 (wait 1 OR r3 < 2) OR after s1 wait 7 OR after s2 wait 5)
      (stop, after s3 (wait 3 OR bumper))
    }
    ");
}

#[test]
fn plans_by_name_are_neither_a_condition_nor_one_name() {
    let text = "{ P (null) (Leg Leg)^2 (Atom (bumper) stop) ((Leg (Atom (wait 1) stop))^3 s2: Leg)^inf }
{ Leg s1: (Atom (bumper) stop) (Atom (after s1) stop) }";
    insta::assert_snapshot!(formal(text), @r"
    { P (null)
      (Leg Leg_2)^2
      (stop, bumper)
      ((Leg_3 (stop, null, 1s))^3 Leg_4)^inf
    }
    { Leg
      s1: (stop, bumper)
      (stop, after s1)
    }
    { Leg_2
      s1: (stop, bumper)
      (stop, after s1)
    }
    { Leg_3
      s1: (stop, bumper)
      (stop, after s1)
    }
    { Leg_4
      s1: (stop, bumper)
      (stop, after s1)
    }
    ");
}

#[test]
fn sonars_of_laws_may_be_written_as_their_ranges() {
    let printed = compiled("{ P (bumper) (Atom (r_7(t) == r_9(t)) align r_7 r_9) (align(r3, 5), r3 == r5) }");
    let written = compiled("{ P (bumper) (Atom (r7 == r9) (align 7 9)) (Atom (r3 == r5) (align 3 5)) }");
    assert_eq!(printed[0].plan.formal(), written[0].plan.formal());
    let judged = |law: &str| judged(&format!("{{ P (bumper) (Atom (null) {law}) }}"), None);
    assert!(judged("align r_16 r_9").contains("expected a sonar, 0 to 15, found `16`"));
    assert!(judged("rotate r_7").contains("expected an angle, found the name `r_7`"));
    assert!(judged("go r_7 0").contains("expected a speed, found the name `r_7`"));
    assert!(judged("align r_ r_9").contains("expected a sonar, 0 to 15, found the name `r_`"));
    assert!(judged("align x_7 r_9").contains("expected a sonar, 0 to 15, found the name `x_7`"));
}

#[test]
fn ranges_of_time_are_written_as_sonars() {
    let help = |plan: &str| {
        let judged = judged(plan, None);
        let help = judged.lines().filter_map(|line| line.trim().strip_prefix("= help: ")).collect::<Vec<_>>();
        assert!(judged.contains("error: 1 error") || judged.matches("error[").count() == 1, "{judged}");
        help.join("\n")
    };
    for (plan, text) in [
        ("{ P (bumper) (Atom (null) align(r_7(t), r_9(t))) }", "write `align(r_7, r_9)`"),
        ("{ P (bumper) (Atom (null) align r_7(t) r_9(t)) }", "write `align r_7 r_9`"),
        ("{ P (bumper) (Atom (null) align 7 r_9(t)) }", "write `align 7 r_9`"),
        ("{ P (bumper) (Atom (null) (align r_7 r9(t))) }", "write `align r_7 r9`"),
        ("{ P (bumper) (Atom (null) align r7(t), r9(t)) }", "write `align r7 r9`"),
        ("{ P (bumper) (Atom (null) align r_7 = r_9) }", "write `r_7 r_9`"),
        ("{ P (bumper) (align(r_7(t), r_9(t)), null) }", "write `align(r_7, r_9)`"),
        ("{ P (bumper) align r_7(t) r_9(t) (Atom (null) stop) }", "say when it ends: `(Atom (wait 10) align r_7 r_9)`"),
        ("{ P (bumper) align r_7 r_9 }", "say when it ends: `(Atom (wait 10) align r_7 r_9)`"),
        ("{ P (bumper) align }", "say when it ends: `(Atom (wait 10) align 3 5)`"),
    ] {
        assert_eq!(help(plan), text, "{plan}");
    }
    let condition = judged("{ P (bumper) (Atom (atIsection r_7(t)) stop) }", None);
    assert!(!condition.contains("not functions of time"), "{condition}");
}

#[test]
fn strings_without_a_name_are_one_plan_of_a_file() {
    let text = "((stop, bumper)(stop, wait 1), wait 3)σ_null";
    assert_eq!(compiled(text)[0].plan.root.name, "Plan");
    let two = judged(&format!("{text}\n{text}"), None);
    assert!(two.contains("error[E0203]: there are two plans called `Plan`"), "{two}");
    assert!(two.contains("write one of them with braces and a name of its own: `{ Name … }`"), "{two}");
    let named = judged(&format!("{{ Plan (wait 3) (Atom (wait 1) stop) }}\n{text}"), None);
    assert!(named.contains("write one of them with braces"), "{named}");
}

#[test]
fn commas_are_between_elements_and_not_in_conditions() {
    let of = |head: &str| judged(&format!("{{ P {head} (Atom (wait 1) stop) }}"), None);
    assert!(
        of("(bumper, atIsection 0100)").contains("`bumper` is an interrupt"),
        "{}",
        of("(bumper, atIsection 0100)")
    );
    assert!(of("(bumper),").contains("this comma is not between two elements"));
    assert!(of("(null) (Atom (wait r_7) stop)").contains("expected a time, found the name `r_7`"));
}
