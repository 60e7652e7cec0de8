//! Tests messages about mistakes with a known intended text. A message must propose an edit that leads to this text,
//! and no edit that leads to a valid plan with another meaning.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::executable::{folder, run_mdlec};

/// Plans with a mistake, each with a part of the help, a text that must not be proposed, and the intended plan.
const PROPOSALS: &[(&str, &str, &str, &str)] = &[
    (
        "{ P (bumper) FRAME 90 deg (Atom (null) rotate 0) }",
        "write `90deg`",
        "a plan of this name",
        "{ P (bumper) FRAME 90deg (Atom (null) rotate 0) }",
    ),
    (
        "{ P (bumper) FRAME 90 degrees (Atom (null) rotate 0) }",
        "write `90deg`",
        "has a colon",
        "{ P (bumper) FRAME 90deg (Atom (null) rotate 0) }",
    ),
    (
        "{ P (bumper) parallel { (Atom (wait 5s) (go 20 0)) (Atom (null) turn 90) } }",
        "a robot runs one law at a time",
        "{ parallel",
        "{ P (bumper) ((Atom (wait 5s) (go 20 0)) (Atom (null) turn 90)) }",
    ),
    (
        "{ P (bumper) sequence { (Atom (wait 5s) (go 20 0)) (Atom (null) turn 90) } }",
        "elements run one after the other as they are written",
        "{ sequence",
        "{ P (bumper) ((Atom (wait 5s) (go 20 0)) (Atom (null) turn 90)) }",
    ),
    ("{ P (bumper) deg }", "`deg` is a unit", "a plan of this name", "{ P (bumper) (Atom (null) turn 5deg) }"),
    (
        "{ P (bumper) length }",
        "`length` is a type",
        "a plan of this name",
        "{ P (bumper) Leg(1m) } { Leg (x: length) (Atom (null) advance x) }",
    ),
    (
        "{ P a: (Atom (wait 5s) (go 20 0)) a: (Atom (after a wait 2s) (go -15 0)) }",
        "give one of them another name",
        "after a (",
        "{ P a: (Atom (wait 5s) (go 20 0)) b: (Atom (after a wait 5s) (go -15 0)) }",
    ),
    (
        "{ P a: (Atom (after a wait 2s) (go 20 0)) }",
        "leave the cause out: `after a`",
        "after a (",
        "{ P a: (Atom (after a) (go 20 0)) }",
    ),
    (
        "{ P a: (Atom (wait 5s) (go 20 0)) (Atom (after behind bumper) (go -15 0)) }",
        "the labels of this plan are `a`",
        "behind: (Atom",
        "{ P a: (Atom (wait 5s) (go 20 0)) (Atom (after a) (go -15 0)) }",
    ),
    (
        "{ P (bumper) Leg(3m) } { Leg (far: float) (Atom (null) advance far) }",
        "where it is used it has to be `length`",
        "`number`",
        "{ P (bumper) Leg(3m) } { Leg (far: length) (Atom (null) advance far) }",
    ),
    (
        "{ P (bumper) Leg(3m) } { Leg (far: double) (Atom (way > far) (go 20 0)) }",
        "the types are length, speed, angle",
        "did you mean",
        "{ P (bumper) Leg(3m) } { Leg (far: length) (Atom (way > far) (go 20 0)) }",
    ),
    (
        "{ P (bumper) Leg(3m) } { Leg (far: length) (Atom (way > fr) (go 20 0)) }",
        "did you mean `far`?",
        "`r <sonar",
        "{ P (bumper) Leg(3m) } { Leg (far: length) (Atom (way > far) (go 20 0)) }",
    ),
    (
        "{ P (bumper) Leg(90) } { Leg (a: angle) FRAME a (Atom (null) rotate 0) }",
        "the angle of a frame is a number, and cannot be a parameter",
        "a plan of this name",
        "{ P (bumper) Leg } { Leg FRAME 90deg (Atom (null) rotate 0) }",
    ),
    (
        "{ Q P(20) } { P (bumper, speed: speed) (Atom (wait 2s) (go speed 0)) }",
        "of its own: `(speed: speed) (bumper)`",
        "{ speed (",
        "{ Q P(20) } { P (speed: speed) (bumper) (Atom (wait 2s) (go speed 0)) }",
    ),
    (
        "{ Q P(1m, 20) } { P (far, v: speed) (Atom (null) advance far v) }",
        "a type follows each name: `(far: length, v: speed)`",
        "of its own",
        "{ Q P(1m, 20) } { P (far: length, v: speed) (Atom (null) advance far v) }",
    ),
    (
        "{ Q P(1m, 20) } { P (far: lenght, v speed) (Atom (null) advance far v) }",
        "write `v: speed`",
        "a plan of this name",
        "{ Q P(1m, 20) } { P (far: length, v: speed) (Atom (null) advance far v) }",
    ),
    (
        "{ P (bumper) Leg(3m) } { Leg (far: length = 1m) (Atom (null) advance far) }",
        "each use of the plan gives the values",
        "`[`",
        "{ P (bumper) Leg(3m) } { Leg (far: length) (Atom (null) advance far) }",
    ),
    (
        "{ P (bumper) (Atom (wait T#5s) (go 20 0)) }",
        "its unit touches: `5s`",
        "a comment begins",
        "{ P (bumper) (Atom (wait 5s) (go 20 0)) }",
    ),
    ("{ P (bumper) (Atom (null) turn pi/2) }", "write `90deg`", "20cm/s", "{ P (bumper) (Atom (null) turn 90deg) }"),
    (
        "{ P (bumper) (Atom (null) turn 2*pi) }",
        "or `6.2832rad`",
        "one signal on each side",
        "{ P (bumper) (Atom (null) turn 6.2832rad) }",
    ),
    (
        "{ P (bumper) Leg(90) } { Leg (a: angle) (Atom (null) turn -a) }",
        "its negative value where the plan is used, as in `Leg(-90)`",
        "one signal on each side",
        "{ P (bumper) Leg(-90) } { Leg (a: angle) (Atom (null) turn a) }",
    ),
    (
        "{ P (bumper) Leg(90) } { Leg (a: angle) (Atom (null) (turn (-a))) }",
        "its negative value where the plan is used",
        "a sign touches its number",
        "{ P (bumper) Leg(-90) } { Leg (a: angle) (Atom (null) (turn a)) }",
    ),
    (
        "{ P (bumper) (Atom (null) path bend.csv) }",
        "between double quotes: `\"bend.csv\"`",
        "`Leg(3m)`",
        "{ P (bumper) (Atom (null) path \"bend.csv\") }",
    ),
    (
        "{ P (bumper) (Atom (r0 != 50cm) (go 20 0)) }",
        "before an equality: `NOT r0 == 50cm`",
        "r 3",
        "{ P (bumper) (Atom (NOT r0 == 50cm) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (r0 < 2*r4) (go 20 0)) }",
        "without a factor: `r0 < r4`",
        "AND",
        "{ P (bumper) (Atom (r0 < r4) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (wait 5s) (go v=20 omega=0)) }",
        "write the values alone: `20 0`",
        "expected an argument",
        "{ P (bumper) (Atom (wait 5s) (go 20 0)) }",
    ),
    (
        "{ P (bumper) for i in 1..3 (Atom (wait 1s) (go 20 0)) }",
        "a loop is written `ExecPlan 3 {",
        "has one dot",
        "{ P (bumper) ExecPlan 3 { (Atom (wait 1s) (go 20 0)) } }",
    ),
    (
        "{ P (bumper)\n  for i in range(3):\n    (Atom (wait 1s) (go 20 0))\n}",
        "a loop is written `ExecPlan 3 {",
        "range (bumper)",
        "{ P (bumper)\n  ExecPlan 3 {\n    (Atom (wait 1s) (go 20 0))\n  }\n}",
    ),
    (
        "{ P (bumper)\n  for i = 1:3\n    (Atom (wait 1s) (go 20 0))\n}",
        "a loop is written `ExecPlan 3 {",
        "goAvoid",
        "{ P (bumper)\n  ExecPlan 3 {\n    (Atom (wait 1s) (go 20 0))\n  }\n}",
    ),
    (
        "{ P (bumper) (Atom (wait 5s) { go 20 0 }) }",
        "write `(go 20 0)`",
        "stop",
        "{ P (bumper) (Atom (wait 5s) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (wait 5s) (go 20 0) (turn 90)) }",
        "an atom of its own: `(Atom (null) turn 90)`",
        "stop",
        "{ P (bumper) (Atom (wait 5s) (go 20 0)) (Atom (null) turn 90) }",
    ),
    (
        "{ P (bumper) (Atom (RISING r0 < 50cm wait 5s) (go 20 0)) }",
        "if one of them is enough, write `OR` before it",
        "expected `OR`",
        "{ P (bumper) (Atom (RISING r0 < 50cm OR wait 5s) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (wait 2m) (go 20 0)) }",
        "for minutes write `2min`",
        "did you mean",
        "{ P (bumper) (Atom (wait 2min) (go 20 0)) }",
    ),
    (
        "{ P (bumper) a: (Atom (wait 5s) (go 20 0)) goto a }",
        "a plan has no jumps",
        "{ Drive",
        "{ P (bumper) ExecPlan 3 { (Atom (wait 5s) (go 20 0)) } }",
    ),
    (
        "{ P (bumper) (Atom (distance > 1m) (go 20 0)) }",
        "or `way`? The length of the path driven",
        "these are known",
        "{ P (bumper) (Atom (way > 1m) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (null) rotate here) }",
        "`here` is a frame, in front of an element: `FRAME here (Atom (null) rotate 90)`",
        "did you mean",
        "{ P (bumper) FRAME here (Atom (null) rotate 90) }",
    ),
    (
        "{ P (bumper) (Atom (wait -5s) (go 20 0)) }",
        "write it without the sign: `5s`",
        "10000000000",
        "{ P (bumper) (Atom (wait 5s) (go 20 0)) }",
    ),
    (
        "(* there *) { P (bumper) (* and (back) *) (Atom (wait 5s) (go 20 0)) }",
        "write `/* and (back) */`",
        "unexpected character",
        "/* there */ { P (bumper) /* and (back) */ (Atom (wait 5s) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (wait 1h30min) (go 20 0)) }",
        "write the sum in one of them: `90min`",
        "put a space before it",
        "{ P (bumper) (Atom (wait 90min) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (wait 1h30m) (go 20 0)) }",
        "write the sum in one of them: `90min`",
        "put a space before it",
        "{ P (bumper) (Atom (wait 90min) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (null) turn right 45deg) }",
        "a turn to the right is negative: `turn -45deg`",
        "one too many",
        "{ P (bumper) (Atom (null) turn -45deg) }",
    ),
    (
        "{ P (bumper) (Atom (null) turn -pi/2) }",
        "for an angle write `-90deg`",
        "has no sign",
        "{ P (bumper) (Atom (null) turn -90deg) }",
    ),
    (
        "{ P (bumper) (Atom (null) turn -pi) }",
        "for an angle write `-180deg`",
        "Leg(",
        "{ P (bumper) (Atom (null) turn -180deg) }",
    ),
    (
        "{ P (bumper) (turn 90,) }",
        "say when it ends, as in `(turn(90), bumper)` and `(turn(90), null)`, or remove the comma",
        "write a condition",
        "{ P (bumper) (turn(90), null) }",
    ),
    (
        "((go(20, 0), bumper)(turn(90), null))",
        "`((go(20, 0), bumper)(turn(90), null))σ_null`",
        "plans are not separated",
        "((go(20, 0), bumper)(turn(90), null), bumper)σ_null",
    ),
    (
        "{ P (bumper) (Atom (atIsection 1,0,0,0) (go 20 0)) }",
        "write them together: `atIsection 1000`",
        "1.0",
        "{ P (bumper) (Atom (atIsection 1000) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (atIsection 0b1000) (go 20 0)) }",
        "write `1000`",
        "is not a unit",
        "{ P (bumper) (Atom (atIsection 1000) (go 20 0)) }",
    ),
    (
        "{ P (bumper) (Atom (atIsection 10x0) (go 20 0)) }",
        "write both: `(atIsection 1000 OR atIsection 1010)`",
        "is not a unit",
        "{ P (bumper) (Atom ((atIsection 1000 OR atIsection 1010)) (go 20 0)) }",
    ),
    ("{ P (bumper) (Atom (wait 5s) (align 3-5)) }", "write `3 5`", "-2", "{ P (bumper) (Atom (wait 5s) (align 3 5)) }"),
    (
        "{ P (bumper) (Atom (wait 5s) (align 3, 5)) }",
        "or write them in parentheses that touch the name: `align(3, 5)`",
        "go(5, 0)",
        "{ P (bumper) (Atom (wait 5s) align(3, 5)) }",
    ),
    (
        "{ P (bumper) (Atom (stuck > 30s) (goAvoid 0 4m)) }",
        "the time is its argument: `stuck 30s`",
        "NOT stuck",
        "{ P (bumper) (Atom (stuck 30s) (goAvoid 0 4m)) }",
    ),
    (
        "{ P (bumper) (Atom (stuck -5s) (goAvoid 0 4m)) }",
        "write it without the sign: `5s`",
        "from 0",
        "{ P (bumper) (Atom (stuck 5s) (goAvoid 0 4m)) }",
    ),
];

#[test]
fn proposals_lead_to_what_was_meant() {
    let folder = folder("proposals");
    let check = |plan: &str| {
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        let output = run_mdlec(&folder, &["check", "plan.mdle"]);
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (plan, proposed, misleading, meant) in PROPOSALS {
        let (status, message) = check(plan);
        assert_eq!(status, Some(1), "{message}");
        let help: String = message.lines().filter(|line| line.trim_start().starts_with('=')).collect();
        assert!(help.contains(proposed), "{proposed}\n{message}");
        assert!(!message.contains(misleading), "{misleading}\n{message}");
        let (status, message) = check(meant);
        assert_eq!(status, Some(0), "{message}");
    }
}

#[test]
fn a_used_file_with_a_letter_too_few_names_the_near_one() {
    let folder = folder("proposals_use");
    fs::write(folder.join("corridors.mdle"), "{ Corridor (Atom (null) advance 1m) }").unwrap();
    fs::write(folder.join("plan.mdle"), "use \"coridors.mdle\"\n{ P (bumper) Corridor }").unwrap();
    let output = run_mdlec(&folder, &["check", "plan.mdle"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("there is no file `coridors.mdle`; did you mean `corridors.mdle`?"), "{message}");
}

#[test]
fn a_warning_names_an_operand_as_it_is_written() {
    let folder = folder("proposals_operand");
    fs::write(folder.join("plan.mdle"), "{ P (bumper OR lowBattery AND wait inf) (Atom (null) (go 20 0)) }").unwrap();
    let output = run_mdlec(&folder, &["check", "plan.mdle"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("`lowBattery AND wait inf` is never true") && !message.contains("null` is"), "{message}");
}

#[test]
fn a_robot_without_an_emulator_is_simulated() {
    let output = run_mdlec(&folder("proposals_emulator"), &["emulator", "sim"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(message.contains("help: `mdlec run PLAN --target sim` runs a plan on it"), "{message}");
}

#[test]
fn a_turn_rate_beyond_a_robot_may_be_in_degrees() {
    let folder = folder("proposals_rate");
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 5s) (go 20 45)) }").unwrap();
    let output = run_mdlec(&folder, &["check", "plan.mdle", "--target", "sim"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("E0402") && message.contains("for degrees per second write `45deg/s`"), "{message}");
}

/// Without its sign, the range would lead to a point in the opposite direction.
#[test]
fn a_negative_range_keeps_its_direction() {
    let folder = folder("proposals_range");
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 5s) (goAvoid 0 -3 20)) }").unwrap();
    let output = run_mdlec(&folder, &["check", "plan.mdle", "--target", "sim"]);
    let message = String::from_utf8(output.stderr).unwrap();
    let help = "for the opposite direction add 180 to the bearing, and write `3`";
    assert!(message.contains("E0402") && message.contains(help), "{message}");
}
