//! Tests the theorem as the inverse of Algorithm 1: the machine of a plan, with its states shuffled, has a string, and
//! this string has the same machine.

use std::collections::BTreeMap;

use mdle_compiler::diagnostic::SourceId;
use mdle_compiler::fsm::{FsmFile, fsm_file};
use mdle_compiler::syntax::{arena_for, parse};
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::pipeline::{compile, compile_plan};
use mdle_tests::random_plan::RandomPlan;
use mdle_theory::theorem::{TheoremResult, augment, decompile, read, string};

use super::definition::assert_is_string;
use super::loops::plan_of_loops;

/// Number of plans that are decompiled and compiled again.
const PLANS: u64 = 340;

/// Number of hostile texts.
const TEXTS: u64 = 7_000;

/// Maximum number of states of a plan that is decompiled.
const STATES: usize = 200;

/// Maximum number of steps of the search.
const STEPS: u64 = 20_000;

/// Counts over the random plans.
#[derive(Debug, Default)]
struct Seen {
    plans: usize,
    states: usize,
    with_loops: usize,
    /// Plans that use `after`. An FSM file lacks the information to compile them again.
    asking: usize,
    /// Plans for which the search takes too long.
    stopped: usize,
}

/// Returns the machine with its states in random order.
fn disordered(file: &FsmFile, chance: &mut Chance) -> FsmFile {
    let mut file = file.clone();
    for place in (1..file.laws.len()).rev() {
        let other = chance.below(place + 1);
        file.states.swap(place, other);
        file.laws.swap(place, other);
    }
    file
}

/// Returns the meaning of a machine, with positions in place of state names: the laws, and the transitions of each
/// condition.
fn meaning(file: &FsmFile, place: &BTreeMap<String, usize>) -> (Vec<String>, Vec<(String, usize, usize)>) {
    let mut laws = vec![String::new(); file.laws.len()];
    for (state, law) in file.states.iter().zip(&file.laws) {
        laws[place[state]].clone_from(law);
    }
    let mut moves: Vec<_> = Vec::new();
    for interrupt in &file.interrupts {
        let all = interrupt.moves.0.iter();
        moves.extend(all.map(|(from, to)| (interrupt.text.clone(), place[from], place[to])));
    }
    moves.sort();
    (laws, moves)
}

/// Decompiles a machine with shuffled states, compiles the resulting plan, and asserts that its machine has the same
/// meaning.
fn go_round(file: &FsmFile, chance: &mut Chance, what: &str, seen: &mut Seen) {
    let disordered = disordered(file, chance);
    let machine = read(&disordered.to_json()).unwrap_or_else(|error| panic!("{what}: {error:?}"));
    let found = match decompile(&machine, STEPS) {
        TheoremResult::String(found) => found,
        TheoremResult::Stopped(_) => {
            seen.stopped += 1;
            return;
        }
        answer @ TheoremResult::None(_) => panic!("{what}: {answer:?}"),
    };
    assert_is_string(&machine, &found);
    assert_eq!(machine.states()[found.order[0].0 as usize], file.states[0], "{what}: the plan begins elsewhere");
    seen.plans += 1;
    seen.states += file.states.len();
    seen.with_loops += usize::from(!found.loops.is_empty());
    if file.interrupts.iter().any(|interrupt| interrupt.text.contains("after ")) {
        seen.asking += 1;
        return;
    }
    let text = string(&machine, &found);
    let again = compile_plan(&text, "Decompiled").unwrap_or_else(|message| panic!("{what}\n{text}\n{message}"));
    let again = fsm_file(&again.nondegenerate).expect("a small machine");
    let numbers = found.order.iter().map(|state| machine.states()[state.0 as usize].clone()).zip(0..).collect();
    let own = again.states.iter().cloned().zip(0..).collect();
    // The braces of a plan are a scope, whose interrupt is null if no interrupt of the machine encloses everything.
    let (laws, mut moves) = meaning(&again, &own);
    let (expected_laws, expected) = meaning(file, &numbers);
    if moves.len() != expected.len() {
        let end = file.laws.len();
        (0..end).for_each(|state| drop(moves.remove(moves.binary_search(&("null".into(), state, end)).unwrap())));
    }
    assert_eq!((laws, moves), (expected_laws, expected), "{what}\n{text}");
}

#[test]
fn random_plans_go_round() {
    let (mut seen, mut seed, plans) = (Seen::default(), 0, repeated(PLANS) as usize);
    while seen.plans - seen.asking < plans {
        seed += 1;
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 20) as usize, false).to_string();
        let Ok(compiled) = compile(&text) else { continue };
        let Ok(file) = fsm_file(&compiled.nondegenerate) else { continue };
        if file.states.len() <= STATES {
            go_round(&file, &mut chance, &format!("seed {seed}\n{text}"), &mut seen);
        }
    }
    println!("{seen:?}");
    assert!(seen.stopped <= plans / 100, "{seen:?}");
    assert!(seen.with_loops > plans / 20 && seen.asking > plans / 20, "{seen:?}");
}

#[test]
fn plans_of_loops_without_end_go_round() {
    let (mut seen, plans) = (Seen::default(), repeated(PLANS) as usize);
    for seed in 0..plans as u64 {
        let mut chance = Chance::new(seed);
        let text = plan_of_loops(&mut chance, 2 + (seed % 16) as usize);
        let compiled = compile(&text).unwrap_or_else(|message| panic!("seed {seed}\n{message}"));
        let file = fsm_file(&compiled.nondegenerate).expect("a small machine");
        go_round(&file, &mut chance, &format!("seed {seed}\n{text}"), &mut seen);
    }
    println!("{seen:?}");
    assert!(seen.stopped <= plans / 100, "{seen:?}");
    assert!(seen.with_loops > plans / 2, "{seen:?}");
}

/// Fragments of laws and conditions: valid fragments, and fragments that could change how the surrounding text is
/// parsed, such as parentheses and comments.
const PIECES: [&str; 20] = [
    "idle",
    "drift",
    "a",
    "wait 3",
    " OR ",
    " AND ",
    "NOT ",
    "(",
    ")",
    ") idle) (Atom (a",
    ") (Atom (null) idle",
    ")^3 (",
    " // ",
    " /* ",
    " */ ",
    "\"",
    ") } //",
    "{ Q ",
    "}",
    "\n",
];

/// Returns the transitions by interrupts, as pairs of states in ascending order.
fn moves(file: &FsmFile) -> Vec<(usize, usize)> {
    let place: BTreeMap<_, _> = file.states.iter().zip(0..).collect();
    // Completion is left out, because it depends on the law.
    let interrupts = file.interrupts.iter().filter(|interrupt| interrupt.name != "completed");
    let all = interrupts.flat_map(|interrupt| &interrupt.moves.0);
    let mut moves: Vec<_> = all.map(|(from, to)| (place[from], place[to])).collect();
    moves.sort_unstable();
    moves
}

#[test]
fn texts_that_reach_further_are_refused_or_change_nothing() {
    let compiled =
        compile("{ Main (a) (Atom (wait 1) idle) { Q (wait 9) (Atom (wait 2) drift) (Atom (wait 4) idle) } }");
    let file = fsm_file(&compiled.unwrap().nondegenerate).unwrap();
    let (mut taken, mut refused) = (0_u64, 0_u64);
    for seed in 0..repeated(TEXTS) {
        let mut chance = Chance::new(seed);
        let text: String = (0..=chance.below(4)).map(|_| PIECES[chance.below(PIECES.len())]).collect();
        let mut hostile = file.clone();
        let place = chance.below(hostile.laws.len() + hostile.interrupts.len());
        match hostile.laws.get_mut(place) {
            Some(law) => law.clone_from(&text),
            None => hostile.interrupts[place - file.laws.len()].text.clone_from(&text),
        }
        let Ok(machine) = read(&hostile.to_json()) else {
            refused += 1;
            continue;
        };
        let TheoremResult::String(found) = decompile(&machine, STEPS) else { panic!("{text:?}") };
        let printed = string(&machine, &found);
        for plan in [printed.clone(), augment(&machine)] {
            let (id, arena) = (SourceId(0), arena_for(&plan));
            let (_, wrong) = parse(id, &plan, &arena);
            assert_eq!(wrong, [], "{text:?}\n{plan}");
        }
        // If the text names a quark of the robot, the plan must have the same machine.
        let Ok(again) = compile_plan(&printed, "Decompiled") else { continue };
        taken += 1;
        let again = fsm_file(&again.nondegenerate).unwrap();
        assert_eq!((moves(&again), again.laws.len()), (moves(&file), file.laws.len()), "{text:?}\n{printed}");
    }
    assert!(taken > repeated(TEXTS) / 100 && refused > repeated(TEXTS) / 20, "{taken} {refused}");
}
