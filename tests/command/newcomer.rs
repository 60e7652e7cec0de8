//! Tests a beginner's typical mistakes: each message, as text and as JSON, names what to type instead.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fs;

use mdle_tests::executable::{folder, run_mdlec};
use serde_json::Value;

/// Mistakes, each with a plan that contains it, and a part of the hint that corrects it.
const MISTAKES: &[(&str, &str, &str)] = &[
    ("a missing `)`", "{ Dock (bumper)\n  (Atom (wait 20) (go 20 0)\n  (Atom (wait 5) stop)\n}\n", "a `)` is missing"),
    ("a name with a letter too few", "{ Dock (bumpr)\n  (Atom (wait 20) (go 20 0))\n}\n", "did you mean `bumper`?"),
    ("degrees where radians are meant", "{ Dock (bumper)\n  (Atom (wait 20) (go 20 90))\n}\n", "write `90deg/s`"),
    ("radians where degrees are meant", "{ Dock (bumper)\n  (Atom (wait 20) rotate 1.57)\n}\n", "write `1.57rad`"),
    ("an argument too few", "{ Dock (bumper)\n  (Atom (wait 20) go 1)\n}\n", "`go 1 0`"),
    (
        "AND for OR",
        "{ Dock (bumper)\n  (Atom (atIsection 1000 AND atIsection 0100) (go 20 0))\n}\n",
        "`atIsection 1000 OR atIsection 0100`",
    ),
    ("the name before its plan", "Dock { (bumper)\n  (Atom (wait 20) (go 20 0))\n}\n", "`{ Dock … }`"),
    ("the name behind the condition", "{ (bumper) Dock\n  (Atom (wait 20) (go 20 0))\n}\n", "`{ Name (bumper) … }`"),
    ("a unit with a blank", "{ Dock (bumper)\n  (Atom (wait 500 ms) (go 20 0))\n}\n", "write `500ms`"),
    ("another unit with a blank", "{ Dock (bumper)\n  (Atom (wait 20) (go 20 cm/s 0))\n}\n", "write `20cm/s`"),
    ("a label inside its atom", "{ Dock (bumper)\n  (Atom s1: (wait 20) (go 20 0))\n}\n", "`s1: (Atom …)`"),
    ("a label before `Atom`", "{ Dock (bumper)\n  (s1: Atom (wait 20) (go 20 0))\n}\n", "`s1: (Atom …)`"),
    ("a label behind its atom", "{ Dock (bumper)\n  (Atom (wait 20) (go 20 0)) s1:\n}\n", "`s1: (Atom (bumper) stop)`"),
    (
        "a label before its plan",
        "s1: { Dock (bumper)\n  (Atom (wait 20) (go 20 0))\n}\n",
        "the first thing inside its braces",
    ),
    ("a loop of 0", "{ Dock (bumper)\n  ExecPlan 0 { (Atom (wait 20) (go 20 0)) }\n}\n", "write `1` or more, or `inf`"),
    (
        "a law where an interrupt belongs",
        "{ Dock (bumper)\n  (Atom (go 20 0) (wait 20))\n}\n",
        "`(Atom (wait 20) (go 20 0))`",
    ),
    ("`Atom` in small letters", "{ Dock (bumper)\n  (atom (wait 5) stop)\n}\n", "the keyword is `Atom`"),
    ("`Atom` with a letter too few", "{ Dock (bumper)\n  (Atm (wait 5) (go 20 0))\n}\n", "the keyword is `Atom`"),
    ("a law alone", "{ Dock (bumper)\n  (go 20 0)\n}\n", "`(Atom (wait 5) (go 20 0))`"),
    ("a condition alone", "{ Dock (bumper)\n  (r0 < 1m)\n}\n", "`(Atom (r0 < 1m) stop)`"),
    ("`if`", "{ Dock (bumper)\n  if (r0 < 1m)\n}\n", "`{ Branch (NOT r0 < 1m) (Atom (wait 5) stop) }`"),
    (
        "`if` and `else`",
        "{ Dock (bumper)\n  if (bumper) { (Atom (wait 5) stop) } else { (Atom (wait 5) (go 20 0)) }\n}\n",
        "MDLe has no `else`",
    ),
    (
        "`while`",
        "{ Dock (bumper)\n  while (r0 > 1m) { (Atom (wait 5) (go 20 0)) }\n}\n",
        "`{ Loop (NOT r0 > 1m) ExecPlan inf { (Atom (wait 5) stop) } }`",
    ),
    ("`repeat`", "{ Dock (bumper)\n  repeat 3 { (Atom (wait 5) (go 20 0)) }\n}\n", "`ExecPlan 3`"),
    ("`import`", "import \"lib.mdle\"\n{ Dock (Atom (wait 5) stop) }\n", "the keyword is `use`"),
    ("`use` without quotes", "use lib.mdle\n{ Dock (Atom (wait 5) stop) }\n", "written between double quotes"),
    ("a product of a string", "{ Dock (bumper)\n  ((Atom (wait 5) (go 20 0)))*3\n}\n", "write `^3`"),
    ("a unit of cars", "{ Dock (bumper)\n  (Atom (wait 5) (go 20km/h 0))\n}\n", "`5.5556m/s`"),
    ("a unit that nobody knows", "{ Dock (bumper)\n  (Atom (wait 5) (go 20knots 0))\n}\n", "the units are `m`"),
    (
        "arguments that do not touch",
        "{ Leg(d: length)\n  (Atom (null) (goAvoid 0 d))\n}\n{ Dock (bumper) Leg (3m) }\n",
        "write `Leg(3m)`",
    ),
    (
        "a parameter without a type",
        "{ Leg(d)\n  (Atom (null) (goAvoid 0 d))\n}\n{ Dock (bumper) Leg(3m) }\n",
        "`(d: length)`",
    ),
    (
        "parameters without types",
        "{ Leg(d, v)\n  (Atom (null) (goAvoid 0 d v))\n}\n{ Dock (bumper) Leg(3m, 10) }\n",
        "`(d: length, v: speed)`",
    ),
    ("a unit for a type", "{ Leg(d: m)\n  (Atom (null) (goAvoid 0 d))\n}\n{ Dock Leg(3m) }\n", "`length`"),
    ("an index", "{ Dock (bumper)\n  (Atom (r[0] < 1m) (go 20 0))\n}\n", "`r 0`"),
    ("a name of two words", "{ My Plan (bumper)\n  (Atom (wait 5) (go 20 0))\n}\n", "write `MyPlan`"),
    ("a comparison the wrong way round", "{ Dock\n  (Atom (0.5m < r0 < 1m) (go 20 0))\n}\n", "r0 > 0.5m AND r0 < 1m"),
    ("a word for a law", "{ Dock (bumper)\n  (Atom (wait 5) (drive 20 0))\n}\n", "did you mean `go "),
    (
        "a loop counted in parentheses",
        "{ Dock ExecPlan (3) { (Atom (wait 5) (go 20 0)) }\n}\n",
        "write `ExecPlan 3 { … }`",
    ),
    ("a variable", "{ Dock (bumper)\n  x = 5\n  (Atom (wait 5) (go 20 0))\n}\n", "no variables"),
    ("square brackets", "{ Dock (bumper)\n  (Atom [bumper] (go 20 0))\n}\n", "`(bumper)`"),
    ("a decimal comma", "{ Dock (bumper)\n  (Atom (wait 0,5) (go 20 0))\n}\n", "`0.5`"),
    ("a comma between arguments", "{ Dock (bumper)\n  (Atom (wait 5) align 3,5)\n}\n", "`align 3 5`"),
    ("a sum of signals", "{ Dock (bumper)\n  (Atom (r0 + r1 < 1) (go 20 0))\n}\n", "one signal on each side"),
    ("a product of numbers", "{ Dock (bumper)\n  (Atom (wait 2*5) (go 20 0))\n}\n", "write the result: `10`"),
    ("a name for a range", "{ Dock (bumper)\n  (Atom (null) (goAvoid 0 far))\n}\n", "expected a length"),
    ("no range", "{ Dock (bumper)\n  (Atom (null) (goAvoid 0))\n}\n", "`goAvoid 0 1m`"),
    (
        "an interval turned inside out",
        "{ Dock (bumper)\n  (Atom (r0 < 1 AND r0 > 2) (go 20 0))\n}\n",
        "`r0 < 1 OR r0 > 2`",
    ),
    (
        "a missing `}` of a loop",
        "{ Dock (bumper)\n  ExecPlan 3 {\n    (Atom (wait 5) (go 20 0))\n  { Inner (wait 3)\n    (Atom (wait 5) stop)\n  }\n}\n",
        "perhaps a `}` is missing before this",
    ),
    (
        "a law without its condition",
        "{ Dock (bumper)\n  (Atom (go 20 0))\n  (Atom turn 90)\n}\n",
        "`(wait 10) (go 20 0)`",
    ),
    ("a comma in a law", "{ Dock (bumper)\n  (Atom (null) (advance 1m, 20))\n}\n", "remove the comma"),
    ("a comma in a condition", "{ Dock\n  (Atom (bumper, wait 5) stop)\n}\n", "write `OR`"),
    ("a comma behind a condition", "{ Dock (bumper)\n  (Atom (wait 5), stop)\n}\n", "a space is enough"),
    (
        "`use` inside a plan",
        "{ Dock (bumper)\n  use \"lib.mdle\"\n  (Atom (wait 5) stop)\n}\n",
        "put it at the top of the file",
    ),
    ("a label without its colon", "{ Dock (bumper)\n  side1 (Atom (null) (advance 1m))\n}\n", "has a colon: `side1:`"),
    (
        "a word between elements",
        "{ Dock (bumper)\n  (Atom (wait 5) stop) THEN (Atom (null) turn 90)\n}\n",
        "without a word: remove it",
    ),
    (
        "a plan as in other languages",
        "plan Square(side: length) {\n  advance(side);\n  turn(90);\n}\n",
        "`{ Square (side: length)` …",
    ),
    ("a hyphen in a name", "{ Return-Home (bumper)\n  (Atom (wait 5) stop)\n}\n", "`Return_Home`"),
    (
        "`=` for the type of a parameter",
        "{ Dock Leg(3m) }\n{ Leg (far = length)\n  (Atom (null) (advance far))\n}\n",
        "`far: length`",
    ),
    (
        "a named argument",
        "{ Dock Leg(far: 3m) }\n{ Leg (far: length)\n  (Atom (null) (advance far))\n}\n",
        "remove `far:`",
    ),
    ("two conditions of a plan", "{ Dock (bumper) (wait 10s)\n  (Atom (null) turn 90)\n}\n", "`(bumper OR wait 10s)`"),
    ("a comment with one slash", "/ A tour\n{ Dock (Atom (wait 5) stop) }\n", "a comment begins with `//`"),
    ("a comment with dashes", "-- A tour\n{ Dock (Atom (wait 5) stop) }\n", "a comment begins with `//`"),
    ("a value for a parameter", "{ Leg(3m: length)\n  (Atom (null) turn 90)\n}\n", "a name, a colon and a type"),
    ("no sonars", "{ Dock (bumper)\n  (Atom (null) (align left))\n}\n", "`align 3 5`"),
    ("swapped arguments", "{ Dock (bumper)\n  (Atom (null) (advance 20cm/s 1m))\n}\n", "write `1m 20cm/s`"),
    ("`!` for NOT", "{ Dock\n  (Atom (!bumper) stop)\n}\n", "write `NOT` and a space"),
    ("law and condition swapped", "{ Dock\n  (Atom (go 20 0) (wait 5s))\n}\n", "`(Atom (wait 5s) (go 20 0))`"),
    ("a condition of a plan without parentheses", "{ Dock bumper\n  (Atom (null) turn 90)\n}\n", "`(bumper)`"),
    (
        "a number for a count",
        "{ Dock Leg(2) }\n{ Leg (times: number)\n  (Atom (null) turn 90)^times\n}\n",
        "`times: count`",
    ),
    ("a condition that is true at once", "{ Dock (bumper)\n  (Atom (way < 2m) (go 20 0))\n}\n", "`(way >= 2)`"),
    (
        "the same condition behind an atom",
        "{ Dock\n  (Atom (bumper) (go 20 0))\n  (Atom (bumper) (advance -50cm))\n}\n",
        "write `(null)`",
    ),
    (
        "an atom in square brackets",
        "{ Dock (bumper)\n  [Atom (wait 5s) (go 20 0)]\n}\n",
        "`(Atom (wait 5s) (go 20 0))`",
    ),
    ("two units apart", "{ Dock (bumper)\n  (Atom (wait 5 s) (go 20 cm/s 0))\n}\n", "write `5s`"),
    ("another unit apart", "{ Dock (bumper)\n  (Atom (null) (advance 1 m/s))\n}\n", "its unit is m, cm"),
    (
        "an operator at the end",
        "{ Dock (bumper)\n  (Atom (bumper OR) stop)\n  (Atom (NOT) stop)\n}\n",
        "or remove `OR`",
    ),
    ("a law outside of its atom", "{ Dock (bumper)\n  (Atom (r0 < 50cm)) (go 20 0)\n}\n", "after the law"),
    ("`int` for a count", "{ Dock Leg(4) }\n{ Leg (n: int)\n  (Atom (null) turn 90)^n\n}\n", "write `count`"),
    (
        "a missing `)` before a behavior",
        "{ Dock (bumper)\n  (Atom (null) (go 20 0)\n  { Inner (wait 10)\n    (Atom (null) turn 90)\n  }\n}\n",
        "a `)` is missing before this",
    ),
    (
        "a file in single quotes",
        "{ Dock (bumper)\n  (Atom (null) path 'home.csv')\n}\n",
        "this text is not between double quotes",
    ),
    (
        "a path of Windows",
        "{ Dock (bumper)\n  (Atom (null) path C:\\home.csv)\n}\n",
        "this text is not between double quotes",
    ),
    (
        "words for a movement",
        "{ Dock (bumper)\n  (Atom (null) (turnRight 90))\n  (Atom (null) (backup 50cm))\n  (Atom (bumper) (forward 20))\n  (Atom (null) (drive 1m))\n}\n",
        "`turn -90`",
    ),
    ("a time for `stop`", "{ Dock (bumper)\n  (Atom (null) (stop 5s))\n}\n", "`(Atom (wait 5s) stop)`"),
    (
        "a word before a cause",
        "{ Dock\n  ahead: (Atom (bumper OR wait 5) stop)\n  (Atom (NOT after ahead by wait 5) stop)\n}\n",
        "write `wait 5`",
    ),
    (
        "a colon after the label of `after`",
        "{ Dock\n  ahead: (Atom (bumper OR wait 5) stop)\n  (Atom (NOT after ahead: wait 5) stop)\n}\n",
        "a space is enough",
    ),
    (
        "a label of `after` in parentheses and in quotes",
        "{ Dock\n  ahead: (Atom (bumper) stop)\n  (Atom (after (ahead)) stop)\n  (Atom (after \"ahead\") stop)\n}\n",
        "write `after ahead`",
    ),
    ("a plan without a name", "{ Dock\n  { (wait 5s) (Atom (null) turn 90) }\n}\n", "a plan begins with its name"),
    ("a robot in quotes", "{ Dock\n  (Atom (sync \"robot2\") stop)\n}\n", "no quotes: `robot2`"),
    ("a robot with a space", "{ Dock\n  (Atom (sync robot 2) stop)\n}\n", "`sync robot2`"),
    ("two laws", "{ Dock\n  (Atom (wait 5s) ((go 20 0) (turn 90)))\n}\n", "a second law needs an atom of its own"),
    ("`times` in a loop", "{ Dock\n  ExecPlan 3 times { (Atom (wait 5s) stop) }\n}\n", "remove it"),
    ("two files of one `use`", "use \"a.mdle\" \"b.mdle\"\n{ Dock (Atom (wait 5) stop) }\n", "a `use` of its own"),
    ("another name of a file", "use \"a.mdle\" as a\n{ Dock a.Leg(3m) }\n", "called by their names alone"),
    ("`#include`", "#include \"lib.mdle\"\n{ Dock (Atom (wait 5) stop) }\n", "the keyword is `use`"),
    ("a label that begins with a digit", "{ Dock\n  1st: (Atom (wait 3s) stop)\n}\n", "begins with a letter: `st1`"),
    ("`=` for the colon of a label", "{ Dock\n  look = (Atom (null) turn 90)\n}\n", "a label has a colon: `look:`"),
    ("a label in quotes", "{ Dock\n  \"there\": (Atom (null) turn 90)\n}\n", "write `there:`"),
    (
        "`after` a behavior",
        "{ Dock\n  { Look (wait 9s) (Atom (null) turn 90) }\n  (Atom (NOT after Look) stop)\n}\n",
        "give it a label",
    ),
    ("a plan in parentheses", "( Dock (bumper)\n  (Atom (null) turn 180)\n)\n", "`{ Dock … }`"),
    (
        "a heading beyond half a turn",
        "{ Dock (bumper)\n  (Atom (theta > 400) (go 20 0))\n}\n",
        "the same heading is `40deg`",
    ),
];

#[test]
fn each_message_says_how_to_end_the_mistake() {
    let folder = folder("newcomer");
    let mut shown = String::new();
    for (mistake, plan, hint) in MISTAKES {
        fs::write(folder.join("plan.mdle"), plan).unwrap();
        let answer = |format: &str| {
            let output = run_mdlec(&folder, &["check", "plan.mdle", "--message-format", format]);
            assert_eq!(output.stdout, b"");
            (output.status.code(), String::from_utf8(output.stderr).unwrap())
        };
        let ((status, human), (status_of_json, json)) = (answer("human"), answer("json"));
        assert_eq!(status, status_of_json);
        assert!(human.contains(hint), "{mistake}\n{human}");
        let report: Vec<Value> = json.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert!(json.contains(hint), "{mistake}\n{json}");
        for message in &report {
            let text = message["message"].as_str().unwrap();
            assert!(human.contains(text), "{mistake}: {text}");
            assert!(message["spans"][0]["primary"].as_bool().unwrap(), "{mistake}");
        }
        shown += &format!("==== {mistake}\n{plan}----\n{human}{json}\n");
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn what_is_no_diagnostic_is_json_as_well() {
    let folder = folder("newcomer_json");
    fs::write(folder.join("plan.mdle"), "{ P (bumper) (Atom (wait 5) (go 0.5 0)) }\n").unwrap();
    let answer = |arguments: &[&str]| {
        let output = run_mdlec(&folder, arguments);
        let status = output.status.code().unwrap();
        format!("$ mdlec {}\n{}exit status {status}\n", arguments.join(" "), String::from_utf8(output.stderr).unwrap())
    };
    let json = ["--message-format", "json"];
    let answer = [
        answer(&["check", "plan.mdel", json[0], json[1]]),
        answer(&["check", "plan.mdle", "--deny-warnings", json[0], json[1]]),
        answer(&["plan.mdle", "--emit", "plan", json[0], json[1], "--target", "nowhere"]),
    ];
    insta::assert_snapshot!(answer.concat());
}

#[test]
fn a_signal_has_one_value() {
    let folder = folder("newcomer_signal");
    let plan = |low: &str| {
        format!("{{ P\n  ExecPlan inf {{ (Atom (battery < {low}) stop) (Atom (battery > 12.8) (go 20 0)) }}\n}}\n")
    };
    let codes = |low: &str| {
        fs::write(folder.join("plan.mdle"), plan(low)).unwrap();
        let output = run_mdlec(&folder, &["check", "plan.mdle", "--message-format", "json"]);
        let messages = String::from_utf8(output.stderr).unwrap();
        let codes = messages.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["code"].to_string());
        codes.collect::<Vec<_>>()
    };
    assert_eq!(codes("11.5"), [""; 0]);
    assert_eq!(codes("13"), ["\"W0301\""]);
}
