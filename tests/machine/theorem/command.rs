//! Tests `mdlec decompile` through the real binary: the paper's machines, and files that are not machines.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use mdle_tests::executable::{folder, run_mdlec, run_mdlec_reading};
use mdle_tests::repository::root;

/// The paper's Fig. 4, with the names of Eq. 6.
const FIG_4: &str = r#"{"states": ["s1", "s2", "s3", "s4"], "interrupts": [
  {"name": "ξ12", "moves": {"s1": "s2"}}, {"name": "ξ13", "moves": {"s1": "s3"}},
  {"name": "ξ2", "moves": {"s2": "s4"}}, {"name": "ξ3", "moves": {"s3": "s4"}}]}"#;

/// The paper's Fig. 3 with a single state for the atom that occurs twice.
const FIG_3: &str = r#"{"states": ["u1", "u2", "end"], "interrupts": [
  {"name": "ξ1", "moves": {"u1": "u2"}}, {"name": "ξ2", "moves": {"u2": "u1"}}, {"name": "ξ3", "moves": {"u1": "end"}}]}"#;

/// Matrices of the paper's Eq. 6.
const EQUATION_6: [&str; 4] = [
    "       [0 0 0 0]       [0 0 0 0]       [1 0 0 0]      [1 0 0 0]",
    "Π(t) = [1 1 0 0] ξ12 + [0 1 0 0] ξ13 + [0 0 0 0] ξ2 + [0 1 0 0] ξ3",
    "       [0 0 1 0]       [1 0 1 0]       [0 0 1 0]      [0 0 0 0]",
    "       [0 0 0 1]       [0 0 0 1]       [0 1 0 1]      [0 0 1 1]",
];

fn with_file(test: &str, text: &str) -> PathBuf {
    let folder = folder(&format!("decompile_{test}"));
    fs::write(folder.join("fsm.json"), text).unwrap();
    folder
}

/// Runs `mdlec decompile` on a file, and returns its output and messages, and the exit status.
fn message(test: &str, text: &str, options: &[&str]) -> (String, Option<i32>) {
    let output = run_mdlec(&with_file(test, text), &[&["decompile", "fsm.json"], options].concat());
    let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    (out + &err, output.status.code())
}

#[test]
fn the_machine_of_figure_4_has_no_string() {
    let (message, status) = message("figure_4", FIG_4, &[]);
    assert_eq!(status, Some(1));
    insta::assert_snapshot!(message);
}

#[test]
fn equation_6_is_printed_as_in_the_paper() {
    let (message, status) = message("equation_6", FIG_4, &["--as-printed"]);
    assert_eq!(status, Some(1));
    assert_eq!(message.lines().take(4).collect::<Vec<_>>(), EQUATION_6);
    insta::assert_snapshot!(message);
}

#[test]
fn the_machine_of_figure_4_has_a_plan_with_after() {
    let (message, status) = message("figure_4_augmented", FIG_4, &["--augment"]);
    assert_eq!(status, Some(0));
    insta::assert_snapshot!(message);
}

#[test]
fn the_string_of_figure_3_needs_a_state_for_each_of_its_atoms() {
    let (text, status) = message("figure_3", FIG_3, &[]);
    assert_eq!(status, Some(1));
    insta::assert_snapshot!(text);
    let folder = folder("decompile_figure_3_string");
    fs::write(folder.join("plan.mdle"), "{ P (Atom (wait 1) stop) (Atom (wait 2) (go 5 0)) (Atom (wait 3) stop) }\n")
        .unwrap();
    assert!(run_mdlec(&folder, &["plan.mdle", "--target", "sim", "--emit", "fsm=fsm.json"]).status.success());
    let plan = run_mdlec(&folder, &["decompile", "fsm.json"]);
    let plan = String::from_utf8(plan.stdout).unwrap();
    assert_eq!(
        plan,
        "{ Decompiled (null)\n  (Atom (wait 1) stop)      // 1: a1\n  (Atom (wait 2) go 5 0)    // 2: a2\n  \
         (Atom (wait 3) stop)      // 3: a3\n}    // 4: end\n"
    );
}

#[test]
fn every_plan_to_learn_from_comes_back_and_is_accepted() {
    let folder = folder("decompile_plans");
    for plan in fs::read_dir(root().join("plans")).unwrap().map(|entry| entry.unwrap().path()) {
        if !plan.is_file() {
            continue;
        }
        let emitted = run_mdlec(&folder, &[plan.to_str().unwrap(), "--emit", "fsm=fsm.json", "--target", "sim"]);
        if !emitted.status.success() {
            continue;
        }
        for options in [&["decompile", "fsm.json"][..], &["decompile", "fsm.json", "--augment"]] {
            let output = run_mdlec(&folder, options);
            let text = String::from_utf8(output.stdout).unwrap();
            assert_eq!(output.status.code(), Some(0), "{plan:?}: {}", String::from_utf8_lossy(&output.stderr));
            // Conditions with `after` are represented by the name of their interrupt, which is not a quark.
            if !fs::read_to_string(&plan).unwrap().contains("after ") {
                let checked = run_mdlec_reading(&folder, &["check", "-", "--target", "sim"], &text);
                let message = String::from_utf8_lossy(&checked.stderr).into_owned();
                assert_eq!(checked.status.code(), Some(0), "{plan:?}: {message}\n{text}");
            }
        }
    }
}

#[test]
fn what_is_no_machine_is_an_error() {
    let bad = [
        ("an unknown state", r#"{"states": ["go", "end"], "interrupts": [{"name": "x", "moves": {"go": "ent"}}]}"#),
        ("no states", r#"{"states": [], "interrupts": []}"#),
        ("no atom", r#"{"states": ["end"], "interrupts": []}"#),
        ("two of a name", r#"{"states": ["a", "a", "end"], "interrupts": []}"#),
        (
            "two destinations",
            "{\"states\": [\"a\", \"b\", \"end\"],\n \"interrupts\": [{\"name\": \"x\", \"moves\": {\"a\": \"b\", \"a\": \"end\"}}]}",
        ),
        (
            "two destinations in two entries",
            r#"{"states": ["a", "b", "end"], "interrupts": [{"name": "x", "moves": {"a": "b"}}, {"name": "x", "moves": {"a": "end"}}]}"#,
        ),
        (
            "an end that is left",
            r#"{"states": ["a", "end"], "interrupts": [{"name": "x", "moves": {"a": "end", "end": "a"}}]}"#,
        ),
        (
            "a state that is not left",
            r#"{"states": ["a", "b", "end"], "interrupts": [{"name": "x", "moves": {"a": "end"}}]}"#,
        ),
        ("a start at the end", r#"{"states": ["a", "end"], "start": "end", "interrupts": []}"#),
        (
            "a start in the middle",
            r#"{"states": ["a", "b", "end"], "start": "b", "interrupts": [{"name": "x", "moves": {"a": "b"}}, {"name": "y", "moves": {"b": "end"}}]}"#,
        ),
        ("too few laws", r#"{"states": ["a", "b", "end"], "laws": ["stop"], "interrupts": []}"#),
        (
            "laws that are none",
            r#"{"states": ["a", "end"], "laws": ["stop)"], "interrupts": [{"name": "x", "moves": {"a": "end"}}]}"#,
        ),
        ("no object", "[]"),
        ("a list for moves", "{\"states\": [\"a\"],\n\"interrupts\": [{\"name\": \"x\", \"moves\": []}]}"),
        ("no interrupts", r#"{"states": ["a", "end"]}"#),
        ("half a file", "{\"states\": [\"a\",\n  \"end\""),
        ("an empty file", ""),
        ("too short a search", FIG_3),
    ];
    let mut all = String::new();
    for (what, text) in bad {
        let options: &[&str] = if what == "too short a search" { &["--steps", "2"] } else { &[] };
        let (message, status) = message("bad", text, options);
        assert_eq!(status, Some(1), "{what}: {message}");
        writeln!(all, "# {what}\n{message}").unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_file_that_cannot_be_read_is_wrong_usage() {
    let folder = folder("decompile_no_file");
    let output = run_mdlec(&folder, &["decompile", "fsm.json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "error: there is no file `fsm.json`\n");
    let both = run_mdlec(&with_file("both", FIG_4), &["decompile", "fsm.json", "--augment", "--as-printed"]);
    assert_eq!(both.status.code(), Some(2));
}

/// Returns a machine that is a chain of `states` states. Each of the first `depth` states begins a nested scope, and
/// all these scopes end with the last state.
fn chain(states: usize, depth: usize) -> String {
    let names: Vec<_> = (1..=states).map(|number| format!("\"s{number}\"")).collect();
    let mut interrupts: Vec<_> = (1..states)
        .map(|number| format!("{{\"name\": \"x{number}\", \"moves\": {{\"s{number}\": \"s{}\"}}}}", number + 1))
        .collect();
    for first in 1..=depth {
        let moves: Vec<_> = (first..states).map(|from| format!("\"s{from}\": \"s{states}\"")).collect();
        interrupts.push(format!("{{\"name\": \"y{first}\", \"moves\": {{{}}}}}", moves.join(", ")));
    }
    format!("{{\"states\": [{}],\n\"interrupts\": [{}]}}", names.join(", "), interrupts.join(",\n"))
}

#[test]
fn ten_thousand_states_are_no_trouble() {
    let (text, status) = message("ten_thousand", &chain(10_000, 2), &[]);
    assert_eq!(status, Some(0), "{text}");
    assert_eq!(text.lines().count(), 10_003, "a line for each atom, two scopes, and the end");
    assert!(text.ends_with("// 9999: s9999\n  }\n}    // 10000: s10000\n"), "{}", &text[text.len() - 200..]);
}

#[test]
fn scopes_nest_deeper_than_brackets_may() {
    let (text, status) = message("deep", &chain(400, 398), &[]);
    assert_eq!(status, Some(0), "{text}");
    assert!(text.contains("Part"), "{text}");
}
