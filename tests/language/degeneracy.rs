//! Tests with random plans that removing degeneracy and expanding loops commute, and that neither changes a trace
//! (docs/src/reference/semantics.md, 6.3, 7.4 and 8.1).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::Compiled;
use mdle_compiler::fsm::expand;
use mdle_compiler::plan::{Node, Plan, Scope, remove_degeneracy};
use mdle_compiler::trace::{Script, TreeWalk, run};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;

/// Number of random plans. `STATES` is the maximum number of states of a plan whose loops are expanded.
const PLANS: u64 = 170;
const STATES: u64 = 2000;

/// Counts of plans with certain properties.
#[derive(Debug, Default)]
struct Seen {
    tried: u64,
    degenerate: u64,
    looping: u64,
    both: u64,
}

#[test]
fn removing_degeneracy_and_writing_loops_out_commute_and_change_no_trace() {
    let mut seen = Seen::default();
    let plans = repeated(PLANS);
    for seed in 0..plans {
        let mut chance = Chance::new(2_000_000 + seed);
        let text = RandomPlan::new(&mut chance, 12, false).to_string();
        let script = script(&mut chance, 12);
        // Nested loops can lead to too many states.
        let Ok(compiled) = compile(&text) else { continue };
        if compiled.machine.states() > STATES {
            continue;
        }
        let (degenerate, looping) = hold(&compiled, &Script::read(&script).unwrap(), &format!("{text}\n{script}"));
        seen.tried += 1;
        seen.degenerate += u64::from(degenerate);
        seen.looping += u64::from(looping);
        seen.both += u64::from(degenerate && looping);
    }
    println!("{seen:?}");
    assert!(seen.tried > plans / 10 * 9 && seen.both > plans / 10, "{seen:?}");
}

/// Checks the properties for a plan. Returns two flags: `true` if the plan repeats interrupts, and `true` if it has
/// loops to expand.
fn hold(compiled: &Compiled, script: &Script, text: &str) -> (bool, bool) {
    let Compiled { plan, nondegenerate, .. } = compiled;
    let expanded = Plan { root: written_out(&plan.root), quarks: plan.quarks.clone() };
    let (one_way, warnings) = remove_degeneracy(expanded.clone());
    let other_way = expand(nondegenerate).unwrap();
    assert_eq!(one_way.plan().numbered(), other_way.plan().numbered(), "{text}");
    assert_eq!(one_way, other_way, "{text}");
    // The copies of an interrupt in an expanded loop cause a single warning.
    assert_eq!(warnings, remove_degeneracy(plan.clone()).1, "{text}");
    let (again, warnings) = remove_degeneracy(nondegenerate.plan().clone());
    assert_eq!((&again, &*warnings), (nondegenerate, &[][..]), "{text}");

    let trace = |plan: &Plan| run(TreeWalk::new(plan), script).map(|line| format!("{line}\n")).collect::<String>();
    let expected = trace(plan);
    assert_eq!(trace(nondegenerate.plan()), expected, "without repeated interrupts:\n{text}");
    assert_eq!(trace(&expanded), expected, "written out:\n{text}");
    assert_eq!(trace(one_way.plan()), expected, "written out, without repeated interrupts:\n{text}");
    (nondegenerate.plan() != plan, &expanded != plan)
}

/// Returns a scope in which all finite loops are expanded, nested ones included.
fn written_out(scope: &Scope) -> Scope {
    let mut body = Vec::new();
    scope.body.iter().for_each(|node| write_out(node, &mut body));
    Scope { body, ..scope.clone() }
}

/// Appends an element to `all`, with all its finite loops expanded.
fn write_out(node: &Node, all: &mut Vec<Node>) {
    match node {
        Node::Atom(_) => all.push(node.clone()),
        Node::Scope(scope) => all.push(Node::Scope(written_out(scope))),
        Node::Loop(endless) if endless.times.is_none() => {
            let mut body = Vec::new();
            endless.body.iter().for_each(|node| write_out(node, &mut body));
            all.push(Node::Loop(mdle_compiler::plan::Loop { body, ..endless.clone() }));
        }
        Node::Loop(counted) => {
            for _ in 0..counted.times.unwrap() {
                counted.body.iter().for_each(|node| write_out(node, all));
            }
            // The labels of the loop go to its last element, which ends together with the loop.
            let marks = match all.last_mut().unwrap() {
                Node::Atom(atom) => &mut atom.marks,
                Node::Scope(scope) => &mut scope.marks,
                Node::Loop(endless) => &mut endless.marks,
            };
            marks.extend(counted.marks.iter().cloned());
        }
    }
}
