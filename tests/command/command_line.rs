//! Tests the output of `mdlec` commands that succeed, through the real binary.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use mdle_compiler::alphabet::{ParameterKind, Unit};
use mdle_compiler::rust::Shape;
use mdle_host::Quantity;
use mdle_runtime::Radians;
use mdle_tests::executable::{folder, run_mdlec, run_mdlec_reading};
use mdle_tests::golden::{judge, rust};
use mdle_tests::repository::{TextFile, root};
use serde_json::Value;

/// A plan that each stage of the compiler changes: it has a unit, a plan by name, a repeated interrupt, and a loop.
const PLAN: &str = "\
/// Ahead, then a shake.
{ Outing (bumper)
  (Atom (bumper OR wait 20s) (go 20 0))
  Shake
}
{ Shake (wait 15s) ((Atom (wait 500ms) (go 5 0)) (Atom (bumper) rotate 90))^2 }
";

/// Kinds of `--emit` whose output is text.
const KINDS: [&str; 6] = ["tree", "plan", "nondegenerate", "expanded", "fsm", "rust"];

/// A script (docs/src/reference/interfaces.md, 3).
const SCRIPT: &str = r#"{"t": 0.0, "fired": [], "completed": []}
{"t": 0.1, "fired": ["atIsection 0100", "bumper"], "completed": ["align 7 9"]}
"#;

/// The trace (docs/src/reference/interfaces.md, 4) of the plan from lab 2 to lab 1 on this script.
const TRACE: &str = r#"{"turn":0,"t":0.0,"state":1,"law":"goAvoid 90 40 20","fired":[]}
{"turn":1,"t":0.1,"state":9,"law":null,"fired":[{"from":1,"level":0,"by":"bumper","operands":["bumper"]}]}
"#;

fn with_plan(test: &str, plan: &str) -> PathBuf {
    let folder = folder(test);
    fs::write(folder.join("plan.mdle"), plan).unwrap();
    folder
}

/// Asserts that a command succeeded, and returns its standard output.
fn printed(output: Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Asserts that a command succeeded without output on standard error, and returns its standard output.
fn printed_alone(output: Output) -> String {
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    printed(output)
}

fn emitted(folder: &Path, kind: &str) -> String {
    printed(run_mdlec(folder, &["plan.mdle", "--target", "sim", "--emit", kind]))
}

/// Asserts that all four machines print this trace of a plan, one line for each turn.
fn assert_trace(folder: &Path, expected: &str) {
    for machine in [None, Some("tree"), Some("table"), Some("matrix"), Some("counted")] {
        let machine = machine.map_or(vec![], |machine| vec!["--machine", machine]);
        let arguments = [&["trace", "plan.mdle", "--script", "script.jsonl"][..], &machine].concat();
        assert_eq!(printed_alone(run_mdlec(folder, &arguments)), expected, "{machine:?}");
    }
}

#[test]
fn a_trace_is_a_line_for_each_turn() {
    let plan = fs::read_to_string(root().join("plans/paper/lab2_to_lab1.mdle")).unwrap();
    let folder = with_plan("trace", &plan);
    fs::write(folder.join("script.jsonl"), SCRIPT).unwrap();
    assert_trace(&folder, TRACE);
}

#[test]
fn a_trace_ends_with_the_plan_and_counts_every_pass() {
    let folder = with_plan(
        "trace_passes",
        "{ P (bumper) { Shake (wait 15s) ((Atom (wait 500ms) (go 5 0)) (Atom (null) rotate 90))^2 } (Atom (wait 1) stop) }",
    );
    let script = "{\"t\":3.0}\n{\"t\":3.5}\n{\"t\":4.0,\"completed\":[\"rotate 90\"]}\n\
                  {\"t\":4.5,\"completed\":[\"rotate 90\"]}\n{\"t\":5.5}\n{\"t\":6.5}\n";
    fs::write(folder.join("script.jsonl"), script).unwrap();
    let expected = [
        r#"{"turn":0,"t":0.0,"state":1,"law":"go 5 0","fired":[]}"#,
        r#"{"turn":1,"t":0.5,"state":2,"law":"rotate 90","fired":[{"from":1,"level":2,"by":"wait 0.5","operands":["wait 0.5"]}]}"#,
        r#"{"turn":2,"t":1.0,"state":3,"law":"go 5 0","fired":[{"from":2,"level":2,"by":"completed","operands":[]}]}"#,
        concat!(
            r#"{"turn":3,"t":1.5,"state":5,"law":"stop","#,
            r#""fired":[{"from":3,"level":2,"by":"wait 0.5","operands":["wait 0.5"]},{"from":4,"level":2,"by":"completed","operands":[]}]}"#
        ),
        r#"{"turn":4,"t":2.5,"state":6,"law":null,"fired":[{"from":5,"level":1,"by":"wait 1","operands":["wait 1"]}]}"#,
    ];
    assert_trace(&folder, &expected.map(|line| format!("{line}\n")).concat());
}

#[test]
fn a_script_can_come_from_standard_input() {
    let plan = fs::read_to_string(root().join("plans/paper/lab2_to_lab1.mdle")).unwrap();
    let folder = with_plan("trace_input", &plan);
    let output = run_mdlec_reading(&folder, &["trace", "plan.mdle", "--script", "-"], SCRIPT);
    assert_eq!(printed_alone(output), TRACE);
}

#[test]
fn stages_are_printed() {
    let folder = with_plan("stages", PLAN);
    // The emitted Rust is compared below, with the result of the emitter.
    let stages = KINDS.iter().filter(|kind| **kind != "rust");
    let stages: Vec<_> = stages.map(|kind| format!("$ --emit {kind}\n{}", emitted(&folder, kind))).collect();
    insta::assert_snapshot!(format!("{PLAN}----\n{}", stages.join("\n")));
}

#[test]
fn the_rust_that_is_printed_is_what_is_compiled() {
    let folder = with_plan("stage_rust", PLAN);
    let file = TextFile { path: "plan.mdle".into(), text: PLAN.into() };
    let (compiled, _) = judge(&file, Some("sim"));
    assert_eq!(emitted(&folder, "rust"), rust(&file, &compiled[0], Shape::Code));
}

#[test]
fn a_stage_is_the_same_in_a_file() {
    let folder = with_plan("stage_files", PLAN);
    for kind in KINDS.into_iter().chain(["formal", "dot", "mermaid", "scxml"]) {
        let emit = format!("{kind}=stage.{kind}");
        let nothing = printed(run_mdlec(&folder, &["plan.mdle", "--target", "sim", "--emit", &emit]));
        assert_eq!(nothing, "", "{kind}");
        let written = fs::read_to_string(folder.join(format!("stage.{kind}"))).expect(kind);
        assert!(!written.is_empty() && written == emitted(&folder, kind), "{kind}:\n{written}");
    }
}

#[test]
fn the_plans_of_a_group_are_printed_and_check() {
    let group =
        "{ Group [a b] Pair (any bumper OR wait 1min) (Atom (all rendezvous) stop) (Atom (a.x > 1m) (go 20 0)) }\n";
    let folder = with_plan("stage_projected", group);
    let plans = emitted(&folder, "projected");
    fs::write(folder.join("plans.mdle"), &plans).unwrap();
    printed_alone(run_mdlec(&folder, &["check", "plans.mdle", "--target", "sim"]));
    printed_alone(run_mdlec(&folder, &["fmt", "--check", "plans.mdle"]));
    let emit =
        |arguments: &[&str]| run_mdlec(&folder, &[arguments, &["--target", "sim", "--emit", "projected"]].concat());
    let second = printed_alone(emit(&["plan.mdle", "--plan", "Pair_b"]));
    assert!(plans.ends_with(&second) && second.starts_with("/// `b`") && second.len() < plans.len(), "{second}");
    let refused = |output: Output, status: i32| {
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{message}");
        message
    };
    let unknown = refused(emit(&["plan.mdle", "--plan", "Pair"]), 2);
    assert!(unknown.contains("its plans are Pair_a, Pair_b"), "{unknown}");
    assert!(refused(emit(&["plans.mdle"]), 2).contains("`plans.mdle` has no group of robots"));
    fs::write(folder.join("bad.mdle"), group.replace("a.x", "b.x")).unwrap();
    assert!(refused(emit(&["bad.mdle"]), 1).starts_with("error[E0209]"));
    let built = refused(run_mdlec(&folder, &["plan.mdle", "--target", "scout"]), 1);
    assert!(built.contains("error[E0403]: the group `Pair` needs the state link"), "{built}");
    assert!(built.contains("`mdle run PLAN --target TARGET --link LINK.toml` runs the part"), "{built}");
    let drawn = refused(run_mdlec(&folder, &["plan.mdle", "--emit", "dot"]), 2);
    assert!(drawn.contains("the plan of a group, and has one for each robot: Pair_a, Pair_b"), "{drawn}");
}

#[test]
fn an_fsm_file_has_the_keys_of_the_interfaces() {
    let folder = with_plan("fsm_keys", PLAN);
    let file: Value = serde_json::from_str(&emitted(&folder, "fsm")).expect("JSON");
    assert_eq!(keys(&file), ["interrupts", "laws", "never", "scopes", "source", "start", "states", "version"]);
    assert_eq!(file["start"], file["states"][0]);
    let states: BTreeSet<_> = file["states"].as_array().unwrap().iter().map(|state| state.as_str().unwrap()).collect();
    let interrupts = file["interrupts"].as_array().unwrap();
    assert!(!interrupts.is_empty());
    for interrupt in interrupts {
        assert_eq!(keys(interrupt), ["moves", "name", "text"]);
        for (from, to) in interrupt["moves"].as_object().unwrap() {
            assert!(states.contains(from.as_str()) && states.contains(to.as_str().unwrap()), "{interrupt}");
        }
    }
    let named = |name: &Value| interrupts.iter().any(|interrupt| interrupt["name"] == *name);
    let never = file["never"].as_array().unwrap();
    assert!(never.len() == 2 && never.iter().all(named), "one in each pass: {never:?}");
}

#[test]
fn options_have_the_units_of_plans() {
    let kinds = [
        (ParameterKind::Time, Quantity::Time, "s"),
        (ParameterKind::Length, Quantity::Length, "m"),
        (ParameterKind::Angle, Quantity::Angle, "deg"),
    ];
    let mut count = 0;
    for unit in Unit::ALL {
        let Some((_, quantity, bare)) = kinds.into_iter().find(|(kind, ..)| *kind == unit.kind) else { continue };
        let read = quantity.read(&format!("2.5{}", unit.name), bare).unwrap();
        let read = if quantity == Quantity::Angle { Radians::from_degrees(read).0 } else { read };
        assert!((read - unit.to_si(2.5)).abs() < 1e-12 * read, "{}: {read}", unit.name);
        count += 1;
    }
    assert_eq!(count, 11);
}

fn keys(object: &Value) -> Vec<&str> {
    let mut keys: Vec<_> = object.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

#[test]
fn targets_and_their_quarks_are_listed() {
    let folder = folder("lists");
    let list = |arguments: &[&str]| {
        format!("$ mdlec {}\n{}", arguments.join(" "), printed_alone(run_mdlec(&folder, arguments)))
    };
    insta::assert_snapshot!([list(&["targets"]), list(&["quarks", "--target", "sim"])].join("\n"));
}

#[test]
fn which_robots_can_run_which_plan_is_a_table() {
    let folder = with_plan("everywhere", "{ Meet (bumper) (Atom (sync ada) stop) (Atom (wait 5) (go 150 0)) }");
    fs::write(folder.join("good.mdle"), "{ Good (bumper) (Atom (wait 5) (go 50 0)) }").unwrap();
    insta::assert_snapshot!(printed(run_mdlec(&folder, &["check", "--target", "all", "plan.mdle", "good.mdle"])));
    fs::write(folder.join("bad.mdle"), "{ Bad (bumpr) (Atom (wait 5) stop) }").unwrap();
    let output = run_mdlec(&folder, &["check", "--target", "all", "bad.mdle", "good.mdle", "none.mdle"]);
    assert_eq!(output.status.code(), Some(2), "the worst of them");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (table, report) = (text(output.stdout), text(output.stderr));
    assert_eq!(table.lines().map(|line| line.split(' ').next().unwrap()).collect::<Vec<_>>(), ["plan", "good.mdle"]);
    assert_eq!(
        ["error[E0201]", "there is no file `none.mdle`"].map(|part| report.matches(part).count()),
        [1, 1],
        "{report}"
    );
}

#[test]
fn options_of_all_commands_may_come_before_the_command() {
    let folder = with_plan("options_first", PLAN);
    printed(run_mdlec(&folder, &["--color", "never", "check", "plan.mdle"]));
    let json = run_mdlec(&folder, &["--message-format=json", "check", "missing.mdle"]);
    assert_eq!(json.status.code(), Some(2));
    assert!(String::from_utf8(json.stderr).unwrap().starts_with('{'));
    let misspelled = run_mdlec(&folder, &["--color", "never", "chekc", "plan.mdle"]);
    assert!(String::from_utf8(misspelled.stderr).unwrap().contains("did you mean `mdlec check`?"));
}
