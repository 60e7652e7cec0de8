//! Tests that the SCXML machine of a plan behaves like the plan: in an SCXML interpreter, it leaves the same states in
//! the same turns as the machine `table`, and ends each turn with the same law.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::picture::scxml;
use mdle_compiler::plan::Nondegenerate;
use mdle_compiler::trace::{Script, ScriptedInput, TableMachine, TraceLine, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::ecmascript::Value;
use mdle_tests::golden::judge;
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;
use mdle_tests::repository::TextFile;
use mdle_tests::scxml::Machine;
use mdle_tests::xml::read;

/// Number of random plans.
const PLANS: u64 = 100;
/// Maximum number of states of a plan that is tested.
const STATES: u64 = 150;

/// Counts of events in the runs of the random plans.
#[derive(Debug, Default)]
struct Seen {
    plans: usize,
    transitions: usize,
    over: usize,
    cut: usize,
    rising: usize,
    after: usize,
    done: usize,
}

/// Returns a line of a script as the data of an SCXML event.
fn data(line: &str) -> Value {
    fn value(json: &serde_json::Value) -> Value {
        match json {
            serde_json::Value::Null => Value::Null,
            serde_json::Value::Bool(value) => Value::Bool(*value),
            serde_json::Value::Number(value) => Value::Number(value.as_f64().unwrap()),
            serde_json::Value::String(text) => Value::Text(text.clone()),
            serde_json::Value::Array(all) => Value::List(all.iter().map(value).collect()),
            serde_json::Value::Object(all) => {
                Value::Object(all.iter().map(|(key, member)| (key.clone(), value(member))).collect())
            }
        }
    }
    value(&serde_json::from_str(line).unwrap())
}

/// Compares the SCXML machine of a plan with the machine `table` on a script.
fn compare(plan: &Nondegenerate, script: &str, seen: &mut Seen) {
    let document = read(&scxml(plan).expect("a small plan"));
    let mut machine = Machine::new(&document);
    let turns = Script::read(script).unwrap();
    let trace: Vec<_> = run(TableMachine::new(plan).unwrap(), &turns).collect();
    let last = trace.last().map_or(0, |line| line.outcome.state);
    for (TraceLine { turn, outcome, .. }, line) in trace.iter().zip(script.lines()) {
        let left = machine.event("turn", data(line));
        let froms: Vec<_> = outcome.fired.iter().map(|fired| format!("a{}", fired.from)).collect();
        assert_eq!(left, froms, "turn {turn}");
        let (law, is_over) = match &outcome.applied {
            ScriptedInput::Law(text) => (Value::Text((*text).to_owned()), false),
            ScriptedInput::Cut => (Value::Null, false),
            ScriptedInput::Over => (Value::Null, true),
        };
        assert_eq!((&machine.data["law"], machine.is_over()), (&law, is_over), "turn {turn}");
        let name = if is_over { "end".to_owned() } else { format!("a{}", outcome.state) };
        assert_eq!(machine.state(), name, "turn {turn}");
        seen.cut += usize::from(outcome.applied == ScriptedInput::Cut);
        seen.over += usize::from(is_over);
        seen.transitions += froms.len();
        let by = |word: &str| outcome.fired.iter().filter(|fired| fired.by.contains(word)).count();
        seen.rising += by("RISING");
        seen.after += by("after s");
        seen.done += by("completed");
    }
    assert!(last > 0 || trace.is_empty());
    seen.plans += 1;
}

#[test]
fn the_machine_does_what_the_plan_does() {
    let mut seen = Seen::default();
    for seed in 0..repeated(PLANS) {
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 20) as usize, false).to_string();
        let script = script(&mut chance, 12);
        let Ok(compiled) = compile(&text) else { continue };
        if compiled.machine.states() <= STATES {
            println!("seed {seed}\n{text}\n{script}");
            compare(&compiled.nondegenerate, &script, &mut seen);
        }
    }
    println!("{seen:?}");
    let tried = repeated(PLANS) as usize;
    assert!(seen.plans > tried * 2 / 3 && seen.transitions > tried * 33, "{seen:?}");
    assert!(
        [seen.over, seen.cut * 10, seen.rising, seen.after, seen.done].iter().all(|count| *count > tried / 15),
        "{seen:?}"
    );
}

#[test]
fn the_outer_interrupt_wins_and_a_behavior_can_be_left_from_each_of_its_atoms() {
    let text = "{ P (bumper) { Q (wait 2) (Atom (wait 1) stop) (Atom (null) rotate 90) } (Atom (wait 1) (go 5 0)) }";
    let plan = TextFile { path: "plan.mdle".into(), text: text.into() };
    let (compiled, messages) = judge(&plan, None);
    assert_eq!(compiled.len(), 1, "{messages}");
    let script = "{\"t\":7}\n{\"t\":8.5}\n{\"t\":9}\n{\"t\":9.5}\n{\"t\":10,\"fired\":[\"bumper\"]}\n";
    compare(&compiled[0].nondegenerate, script, &mut Seen::default());
    insta::assert_snapshot!(scxml(&compiled[0].nondegenerate).unwrap());
}

#[test]
fn a_machine_is_no_larger_than_anybody_reads() {
    // Each of the 5,000 states would contain the long condition of the plan.
    let long: Vec<_> = (1..1000).map(|seconds| format!("atIsection 1000 AND wait {seconds}")).collect();
    let text = format!("{{ P ({}) (Atom (wait 1) stop)^5000 }}", long.join(" OR "));
    let plan = TextFile { path: "plan.mdle".into(), text };
    let refused = scxml(&judge(&plan, None).0[0].nondegenerate).unwrap_err();
    assert!(refused.message.contains("take more than 64 MB"), "{refused:?}");
}
