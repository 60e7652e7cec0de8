//! Tests random plans on random scripts: all machines print the same trace, and so do plans that are loaded at run time
//! (docs/src/reference/semantics.md, 9).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::sync::Arc;

use mdle_compiler::alphabet::Unit;
use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::fsm::{self, Element};
use mdle_compiler::load;
use mdle_compiler::syntax::{arena_for, parse};
use mdle_compiler::trace::{COMPLETED, Script, ScriptedInput, TraceLine, TurnResult};
use mdle_scripted::alphabet::Alphabet;
use mdle_scripted::drive;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::grammar;
use mdle_tests::outputs::outputs;
use mdle_tests::pipeline::{Machines, compile, scripted, sources};
use mdle_tests::productions::{self, Productions};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::random_script::script;

/// Number of random plans.
const PLANS: u64 = 3_400;

/// Counts of events in the runs of random plans, to check that the runs cover everything that should be tested.
#[derive(Debug, Default)]
struct Seen {
    plans: usize,
    refused: usize,
    turns: usize,
    over: usize,
    cut: usize,
    chains: usize,
    completions: usize,
    repeated: usize,
    /// Number of transitions caused by a condition with RISING. `after` and `compared` count transitions caused by
    /// `after` and by comparisons.
    rising: usize,
    after: usize,
    compared: usize,
    /// Number of occurrences, in the plans that were run, of each production of the grammar and of each unit.
    productions: Productions,
}

impl Seen {
    fn and(mut self, other: Self) -> Self {
        for (production, count) in other.productions {
            *self.productions.entry(production).or_default() += count;
        }
        Self {
            plans: self.plans + other.plans,
            refused: self.refused + other.refused,
            turns: self.turns + other.turns,
            over: self.over + other.over,
            cut: self.cut + other.cut,
            chains: self.chains + other.chains,
            completions: self.completions + other.completions,
            repeated: self.repeated + other.repeated,
            rising: self.rising + other.rising,
            after: self.after + other.after,
            compared: self.compared + other.compared,
            productions: self.productions,
        }
    }
}

#[test]
fn every_machine_prints_the_same_trace() {
    // Seeds are independent, so they are distributed to the cores.
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let seen = std::thread::scope(|scope| {
        let hands: Vec<_> = (0..cores).map(|hand| scope.spawn(move || seeds(hand, cores))).collect();
        hands.into_iter().map(|hand| hand.join().expect("no difference")).fold(Seen::default(), Seen::and)
    });
    println!("{seen:#?}");
    assert_every_production_is_met(&seen.productions);
    assert!(seen.refused < seen.plans / 50, "{seen:?}");
    let rare = [
        seen.over,
        seen.cut * 10,
        seen.chains,
        seen.completions,
        seen.repeated,
        seen.rising,
        seen.after,
        seen.compared,
    ];
    assert!(rare.iter().all(|count| *count > seen.plans / 10), "{seen:?}");
}

/// Units that no parameter of the robot's quarks has.
const UNMET_UNITS: &[&str] = &["Hz"];
/// Parts of the head of a group's plan. They do not occur here, because a group's plan is not run itself; the plans of
/// its robots are tested in `robots formation::`.
const GROUPS: &[&str] = &["Head = \"Group\" \"[\" ArgList? \"]\" Name Params? HeadCondition?", "Head … ArgList?"];

/// Asserts that every production, every optional part and every unit occurs in at least one plan.
fn assert_every_production_is_met(counts: &Productions) {
    let grammar = grammar::productions().into_iter().filter(|production| !production.recovers);
    let productions = grammar.flat_map(|production| [production.options(), vec![production.text]].concat());
    let units = Unit::ALL.iter().map(|unit| unit.name).filter(|unit| !UNMET_UNITS.contains(unit));
    let productions = productions.filter(|production| !GROUPS.contains(&production.as_str()));
    let mut all: Vec<_> = productions.chain(units.map(str::to_owned)).collect();
    all.sort();
    all.dedup();
    let unmet: Vec<_> = all.iter().filter(|name| !counts.contains_key(name.as_str())).collect();
    assert!(unmet.is_empty(), "no random plan has {unmet:#?}");
    let unknown: Vec<_> = counts.keys().filter(|name| all.iter().all(|known| known != *name)).collect();
    assert!(unknown.is_empty(), "the grammar does not have {unknown:#?}");
}

/// Tests every `step`th seed, beginning with `first`.
fn seeds(first: usize, step: usize) -> Seen {
    let mut seen = Seen::default();
    for seed in (first as u64..repeated(PLANS)).step_by(step) {
        let mut chance = Chance::new(seed);
        // Small plans come first, so that the first failing plan is easy to read. Plans with long searches are rare,
        // because they are slow.
        let long = seed % 400 >= 398;
        let text =
            RandomPlan::new(&mut chance, 2 + (seed as usize) * 20 / (repeated(PLANS) as usize), long).to_string();
        let script = script(&mut chance, if long { 4 } else { 12 });
        let foresight = chance.percent(50);
        compare(seed, foresight, &text, &script, &mut seen);
    }
    seen
}

/// Compares the traces of all machines and of the loaded plan. With `foresight`, the rows of the loaded plan contain
/// the successors of scopes.
fn compare(seed: u64, foresight: bool, text: &str, script: &str, seen: &mut Seen) {
    let compiled = match compile(text) {
        Ok(compiled) => compiled,
        // Nested loops can lead to too many states.
        Err(report) if report.contains("E0501") => {
            seen.refused += 1;
            return;
        }
        Err(report) => panic!("seed {seed}: {report}"),
    };
    let machines = Machines::new(&compiled);
    let turns = Script::read(script).expect("a script");
    let traces = machines.traces(&turns);
    let (reference, tree) = &traces[0];
    for (machine, trace) in &traces[1..] {
        if trace != tree {
            panic!("seed {seed}: {}", difference((reference, tree), (machine, trace), text, script));
        }
    }
    let expected: String = tree.iter().map(|line| format!("{line}\n")).collect();
    let machine = &compiled.machine;
    let mut rows = fsm::rows(machine);
    if !foresight {
        for (guard, element) in rows.guards.iter_mut().zip(machine.elements()) {
            (guard.follows, guard.around) = (None, element.parent().map_or(0, Element::number));
        }
    }
    let words = fsm::words(machine, &sources(text), scripted());
    let loaded = load::with_rows::<Alphabet>(rows, words, machine, scripted()).expect("quarks that are bound");
    let loaded = Arc::new(loaded);
    let mut printed = String::new();
    drive(|| loaded.plan(), &outputs(&turns), &mut printed).expect("room for the trace");
    assert!(printed == expected, "seed {seed}\n{reference}:\n{expected}loaded:\n{printed}{text}\n{script}");
    let arena = arena_for(text);
    productions::count(text, &parse(SourceId(0), text, &arena).0, &mut seen.productions);
    seen.plans += 1;
    seen.repeated += usize::from(compiled.nondegenerate.plan() != &compiled.plan);
    for TraceLine { outcome: TurnResult { applied, fired, .. }, .. } in tree {
        seen.turns += 1;
        seen.over += usize::from(*applied == ScriptedInput::Over);
        seen.cut += usize::from(*applied == ScriptedInput::Cut);
        seen.chains += usize::from(fired.len() > 1);
        let by = |word: &str| usize::from(fired.iter().any(|transition| transition.by.contains(word)));
        seen.rising += by("RISING");
        seen.after += by("after s");
        seen.compared += by(" > ");
        seen.completions += usize::from(fired.iter().any(|transition| transition.by == COMPLETED));
    }
}

/// Returns the first lines that differ in two traces, with the plan and the script.
fn difference(one: (&str, &[TraceLine<'_>]), other: (&str, &[TraceLine<'_>]), text: &str, script: &str) -> String {
    let turn = one.1.iter().zip(other.1).take_while(|(one, other)| one == other).count();
    let line = |trace: &[TraceLine<'_>]| trace.get(turn).map_or("(no line)".into(), ToString::to_string);
    format!("turn {turn}\n{}: {}\n{}: {}\n{text}\n{script}", one.0, line(one.1), other.0, line(other.1))
}
