//! Tests that reports, logs, batches and traces name exactly the operands that fired, with their values and places.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use mdle_compiler::trace::{COMPLETED, Reports, Script, TreeWalk, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::executable::{folder, run_mdlec};
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;

/// Number of random plans.
const PLANS: u64 = 1_000;

/// Returns the operands in a condition's text: the parts that AND and OR join, at any depth of parentheses.
fn operands(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut operand = String::new();
    // Depth of the parentheses that belong to NOT, RISING or `after`.
    let mut held = 0_usize;
    let spaced = text.replace('(', " ( ").replace(')', " ) ");
    for word in spaced.split_whitespace() {
        let is_operator = operand.ends_with("NOT") || operand.ends_with("RISING") || operand.contains("after ");
        match word {
            "(" if held > 0 || is_operator => {
                held += 1;
                operand += if operand.ends_with('(') { "(" } else { " (" };
            }
            ")" if held > 0 => {
                held -= 1;
                operand += ")";
            }
            "(" | ")" => {}
            "AND" | "OR" if held == 0 => found.push(std::mem::take(&mut operand)),
            word => {
                let between = if operand.is_empty() || operand.ends_with('(') { "" } else { " " };
                operand += between;
                operand += word;
            }
        }
    }
    found.push(operand);
    found
}

/// Returns the value of an operand in a turn, computed from its text and these arguments only. Returns `None` if its
/// value depends on anything else.
fn value(operand: &str, reports: &Reports, since: f64) -> Option<bool> {
    let now = reports.t.seconds();
    let seconds = |text: &str| text.parse::<f64>().ok();
    if let Some(inside) = operand.strip_prefix("NOT ") {
        return if inside.starts_with('(') { None } else { value(inside, reports, since).map(|fired| !fired) };
    }
    if let Some(inside) = operand.strip_prefix("RISING ") {
        // RISING does not fire if its operand does not fire.
        let fired = if inside.starts_with('(') { None } else { value(inside, reports, since) };
        return fired.filter(|fired| !fired);
    }
    let stuck = operand.strip_prefix("stuck ");
    if stuck.is_some() && !reports.fired.contains(operand) {
        return Some(false);
    }
    // `stuck` also needs its time since the entry of its scope.
    if let Some(wait) = stuck.or_else(|| operand.strip_prefix("wait ")) {
        let Some(wait) = seconds(wait) else { return Some(false) };
        // The scope was entered after the plan's beginning and not after the last transition.
        return if wait <= now - since - 1e-6 {
            Some(true)
        } else if wait > now + 1e-6 {
            Some(false)
        } else {
            None
        };
    }
    let word = operand.split(' ').next().unwrap_or_default();
    let is_remembered = ["after", "t", "way"].contains(&word);
    if is_remembered { None } else { Some(operand != "null" && reports.fired.contains(operand)) }
}

#[test]
fn the_operands_named_are_exactly_those_that_fired() {
    let (mut transitions, mut decided, mut all, mut several) = (0_u64, 0_u64, 0_u64, 0_u64);
    for seed in 0..repeated(PLANS) {
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 12) as usize, false).to_string();
        let script = script(&mut chance, 12);
        let Ok(compiled) = compile(&text) else { continue };
        let script = Script::read(&script).expect("a script");
        let mut last = script.turns().first().map_or(0.0, |first| first.t.seconds());
        // A condition fires in many turns.
        let mut read = BTreeMap::new();
        for (line, reports) in run(TreeWalk::new(&compiled.plan), &script).zip(script.turns()) {
            for fired in &line.outcome.fired {
                if fired.by == COMPLETED {
                    assert!(fired.operands.is_empty(), "seed {seed}: {line}");
                    last = reports.t.seconds();
                    continue;
                }
                let written: &Vec<String> = read.entry(fired.by).or_insert_with(|| operands(fired.by));
                transitions += 1;
                several += u64::from(fired.operands.len() > 1);
                assert!(!fired.operands.is_empty(), "seed {seed}: {line}\n{text}");
                assert!(fired.operands.iter().all(|operand| written.contains(operand)), "seed {seed}: {line}\n{text}");
                for operand in written {
                    all += 1;
                    let Some(value) = value(operand, reports, last) else { continue };
                    decided += 1;
                    assert_eq!(fired.operands.contains(operand), value, "seed {seed}: {operand}: {line}\n{text}");
                }
                last = reports.t.seconds();
            }
        }
    }
    println!("{transitions} transitions, {several} with several operands; {decided} of {all} operands decided");
    let tried = repeated(PLANS);
    assert!(
        transitions > tried && several > tried / 30 && decided > all / 2,
        "{transitions} {several} {decided} {all}"
    );
}

/// A wall-following plan with everything that a report can name: operands with values, several operands at once, loops,
/// and behaviors.
const PLAN: &str = "\
{ Wall (bumper OR // contact
        wait 10min)
  ExecPlan 2 {
    { Leg
      (Atom (r0 < 60cm) (go 20 0))
      (Atom (wait 1s AND NOT bumper OR t > 5s) stop)
    }
    (Atom (null) turn 180)
    (Atom (RISING r0 < 1m) (go 20 0))
  }
  ((Atom (way > 20cm) (go 20 0)) (Atom (r0 < r8) turn 90))^inf
}
";

/// A plan that ends by contact, by time, or with its last atom.
const PUSH: &str = "\
{ Push (bumper OR wait 1min)
  (Atom (r0 < 60cm OR wait 10s) (go 20 0))
  (Atom (way > 1m) (go 20 0))
}
";

fn plans() -> &'static Path {
    static PLANS: OnceLock<PathBuf> = OnceLock::new();
    PLANS.get_or_init(|| {
        let folder = folder("operands");
        for (name, plan) in [("wall", PLAN), ("push", PUSH)] {
            let file = format!("{name}.mdle");
            fs::write(folder.join(&file), plan).unwrap();
            let output = run_mdlec(&folder, &[&file, "--target", "sim"]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
        folder
    })
}

/// Runs a plan in the hall; returns its exit status and its report.
fn reported(plan: &str, options: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(format!("./{plan}"));
    let output: Output = command.args(["--world", "hall"]).args(options).current_dir(plans()).output().unwrap();
    (output.status.code(), String::from_utf8(output.stdout).unwrap())
}

/// Options for a run of the wall follower at maximum speed, until the robot turns for the second time.
const TWICE: [&str; 5] = ["--start=1.5,5,0", "--speed", "max", "--timeout", "79"];

#[test]
fn a_report_names_operands_values_places_and_passes() {
    let (status, report) = reported("wall", &TWICE);
    assert_eq!(status, Some(4));
    insta::assert_snapshot!(report);
    let (status, report) = reported("push", &["--start=1.5,5,180", "--speed", "max"]);
    assert_eq!(status, Some(0), "{report}");
    insta::assert_snapshot!("report-of-the-end", report);
}

#[test]
fn a_log_names_the_operands() {
    reported("wall", &[&TWICE[..], &["--log", "log.jsonl"]].concat());
    let log = fs::read_to_string(plans().join("log.jsonl")).unwrap();
    let lines: Vec<_> = log.lines().filter(|line| !line.contains("\"fired\":[]")).collect();
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn a_batch_names_the_operands() {
    let noise = ["--start=1.5,5,180", "--start-noise", "0.3,180", "--runs", "6"];
    insta::assert_snapshot!(reported("push", &noise).1);
    insta::assert_snapshot!("batch-as-json", reported("push", &[&noise[..], &["--json"]].concat()).1);
}

#[test]
fn a_required_cause_is_read_as_the_compiler_reads_it() {
    let status = |cause: &str| reported("push", &["--start=1.5,5,180", "--speed", "max", "--require", cause]).0;
    // From this start, the run ends by contact.
    for cause in ["bumper", " bumper ", "Push"] {
        assert_eq!(status(cause), Some(0), "{cause}");
    }
    for cause in ["wait 1min", "wait 60", "wait 60000ms", "way > 1m", "way>100cm", "way > 1.0", "completed"] {
        assert_eq!(status(cause), Some(5), "{cause}");
    }
    for cause in ["r0 < 60cm", "r0<0.6", "wait 10s", "wait 1m", "way > 1s", "way < 1m", "bumpr", "bumper OR wait 1min"]
    {
        assert_eq!(status(cause), Some(2), "{cause}");
    }
}
