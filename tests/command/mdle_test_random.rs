//! Tests that `mdle test` accepts every expectation that a run meets. The expectations are those of random plans on
//! random scripts, computed by another machine.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use mdle_compiler::Compiled;
use mdle_compiler::trace::{COMPLETED, Script, ScriptedInput, TreeWalk, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, mdle};
use mdle_tests::pipeline::{LIBRARY, LIBRARY_FILE, compile};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_tests::repository::root;
use serde_json::Value;

/// Number of random plans.
const PLANS: u64 = 120;
/// Number of scripts of each plan.
const SCRIPTS: usize = 4;

/// Returns a test that expects the behavior of a plan on a script, and the number of expected transitions. Returns
/// `None` if a turn is cut, because it then enters an atom whose law is not applied.
fn test(compiled: &Compiled, number: usize, script: &str) -> Option<(String, usize)> {
    let (mut atoms, mut transitions) = (Vec::new(), Vec::new());
    let mut before: Option<String> = None;
    for line in run(TreeWalk::new(&compiled.plan), &Script::read(script).unwrap()) {
        let law = match line.outcome.applied {
            ScriptedInput::Law(law) => Some(law.to_owned()),
            ScriptedInput::Over => None,
            ScriptedInput::Cut => return None,
        };
        if let ([fired], Some(before)) = (line.outcome.fired.as_slice(), &before) {
            let by = if fired.by == COMPLETED { COMPLETED } else { &fired.operands[0] };
            let to = law.as_deref().unwrap_or("end");
            transitions.push(format!("{{ from = {before:?}, to = {to:?}, by = {by:?} }}"));
        }
        if before.is_none() || !line.outcome.fired.is_empty() {
            atoms.extend(law.clone());
        }
        before = law;
    }
    let turns: Vec<_> = script.lines().map(|line| turn(compiled, line)).collect();
    let mut text = format!("[[test]]\nname = \"{number}\"\nscript = [\n{}\n]\n", turns.join(",\n"));
    writeln!(text, "expect.atoms = {atoms:?}\nexpect.order = {atoms:?}").unwrap();
    writeln!(text, "expect.transitions = [{}]", transitions.join(", ")).unwrap();
    Some((text, transitions.len()))
}

/// Returns a line of a script as TOML, with only those texts that occur in the plan.
fn turn(compiled: &Compiled, line: &str) -> String {
    let line: Value = serde_json::from_str(line).unwrap();
    let [fired, completed] = ["fired", "completed"].map(|key| {
        // In `completed`, a law that never completes is an error.
        let is_known = |text: &&Value| {
            let mut quarks = compiled.machine.quarks().iter().filter(|quark| quark.text == text.as_str().unwrap());
            quarks.any(|quark| key == "fired" || quark.completes)
        };
        let texts = line[key].as_array().unwrap().iter().filter(is_known).map(Value::to_string);
        texts.collect::<Vec<_>>().join(", ")
    });
    let [t, way, heading] = ["t", "way", "heading"].map(|key| line[key].to_string());
    format!("{{ t = {t}, way = {way}, heading = {heading}, fired = [{fired}], completed = [{completed}] }}")
}

#[test]
fn what_a_run_does_can_be_expected() {
    let folder = folder("random-tests");
    let target = root().join("tests/scripted");
    let mut expected = 0;
    for seed in 0..repeated(PLANS) {
        let mut chance = Chance::new(seed);
        let plan = RandomPlan::new(&mut chance, 3 + (seed % 8) as usize, false).to_string();
        let Ok(compiled) = compile(&plan) else { continue };
        let tests = (0..SCRIPTS).filter_map(|number| test(&compiled, number, &script(&mut chance, 12)));
        let tests: Vec<_> = tests.collect();
        expected += tests.iter().map(|(_, transitions)| transitions).sum::<usize>();
        let tests: String = tests.into_iter().map(|(text, _)| text).collect();
        if tests.is_empty() {
            continue;
        }
        fs::write(folder.join("plan.mdle"), &plan).unwrap();
        fs::write(folder.join(LIBRARY_FILE), LIBRARY).unwrap();
        let head = format!("name = \"Main\"\ntarget = {:?}\n", target.display().to_string());
        fs::write(folder.join("plan.test.toml"), head + &tests).unwrap();
        let output = Command::new(mdle()).args(["test", "plan.test.toml"]).current_dir(&folder).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "seed {seed}\n{message}\n{plan}");
    }
    assert!(expected > 100, "{expected} transitions");
}
