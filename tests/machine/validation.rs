//! Tests that validation accepts machines that match their plan and rejects machines that do not, with mutations of
//! random machines.

use std::collections::BTreeMap;

use mdle_compiler::diagnostic::Code;
use mdle_compiler::fsm::{MachineDraft, validate};
use mdle_runtime::fsm::Kind;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::pipeline::compile;
use mdle_tests::random_plan::RandomPlan;

/// Number of mutated machines.
const MUTATIONS: u64 = 340;

/// A function that makes a random part of a machine wrong, or leaves the machine unchanged.
type Mutation = fn(&mut MachineDraft, &mut Chance);

/// Mutations of a machine, each with its description.
const WRONG: &[(&str, Mutation)] = &[
    ("extent, its first atom", |machine, chance| {
        let bracket = pick(&mut machine.brackets, chance);
        bracket.first = other(bracket.first, chance);
    }),
    ("extent, its last atom, and so where it leads", |machine, chance| {
        let bracket = pick(&mut machine.brackets, chance);
        bracket.last = other(bracket.last, chance);
    }),
    ("what is around it, and so what starts afresh", |machine, chance| {
        let brackets = machine.brackets.len();
        pick(&mut machine.brackets, chance).parent = chance.below(brackets) as u32;
    }),
    ("its timer's level", |machine, chance| {
        if let Kind::Scope { level } = &mut pick(&mut machine.brackets, chance).kind {
            *level = other((*level).into(), chance) as u16;
        }
    }),
    ("passes of a loop", |machine, chance| {
        for bracket in &mut machine.brackets {
            if let Kind::Loop { times, .. } = &mut bracket.kind {
                *times = other(*times as u32, chance).into();
            }
        }
    }),
    ("counter of a loop", |machine, chance| {
        for bracket in &mut machine.brackets {
            if let Kind::Loop { slot, .. } = &mut bracket.kind {
                *slot = other((*slot).into(), chance) as u16;
            }
        }
    }),
    ("states of a pass", |machine, chance| {
        for bracket in &mut machine.brackets {
            if let Kind::Loop { stride, .. } = &mut bracket.kind {
                *stride = other(*stride as u32, chance).into();
            }
        }
    }),
    ("a loop that is a scope", |machine, chance| {
        pick(&mut machine.brackets, chance).kind = Kind::Scope { level: 1 };
    }),
    ("order of brackets", |machine, chance| swap(&mut machine.brackets, chance)),
    ("a bracket too few", |machine, chance| {
        machine.brackets.remove(chance.below(machine.brackets.len()));
    }),
    ("order of atoms", |machine, chance| swap(&mut machine.atoms, chance)),
    ("an atom's bracket", |machine, chance| {
        let atom = pick(&mut machine.atoms, chance);
        atom.scope = other(atom.scope, chance);
    }),
    ("an atom's state", |machine, chance| {
        let atom = pick(&mut machine.atoms, chance);
        atom.state = other(atom.state as u32, chance).into();
    }),
    ("an atom too few", |machine, chance| {
        machine.atoms.remove(chance.below(machine.atoms.len()));
    }),
    ("order of laws", |machine, chance| swap(&mut machine.laws, chance)),
    ("a frame", |machine, chance| pick(&mut machine.laws, chance).frame += 0.5),
    ("order of interrupts", |machine, chance| swap(&mut machine.scopes, chance)),
    ("a scope without an interrupt", |machine, chance| *pick(&mut machine.scopes, chance) = None),
    ("the termination state", |machine, chance| machine.termination = other(machine.termination as u32, chance).into()),
    ("labels", |machine, _| machine.marks = BTreeMap::new()),
    ("records", |machine, _| machine.records = BTreeMap::new()),
    ("places of records", |machine, _| machine.records.values_mut().for_each(|place| place.first += 1)),
    ("timers", |machine, _| machine.sizes.levels = machine.sizes.levels.saturating_sub(1)),
    ("counters", |machine, _| machine.sizes.slots = machine.sizes.slots.saturating_sub(1)),
    ("memories", |machine, _| machine.sizes.memories = machine.sizes.memories.saturating_sub(1)),
];

fn pick<'a, T>(all: &'a mut [T], chance: &mut Chance) -> &'a mut T {
    let place = chance.below(all.len());
    &mut all[place]
}

/// Returns another number, in most cases a neighbor of `number`.
fn other(number: u32, chance: &mut Chance) -> u32 {
    match chance.below(3) {
        0 => number.wrapping_sub(1),
        1 => number.wrapping_add(1),
        _ => number.wrapping_add(2 + chance.below(5) as u32),
    }
}

fn swap<T>(all: &mut [T], chance: &mut Chance) {
    let [one, another] = [(); 2].map(|()| chance.below(all.len()));
    all.swap(one, another);
}

#[test]
fn every_mutated_machine_is_rejected() {
    let (mut seed, mut tried) = (0, BTreeMap::<_, usize>::new());
    let mutations = repeated(MUTATIONS) as usize;
    while tried.values().sum::<usize>() < mutations {
        seed += 1;
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 2 + (seed % 20) as usize, false).to_string();
        let Ok(compiled) = compile(&text) else { continue };
        let valid = compiled.machine.draft();
        assert_eq!(validate(&compiled.nondegenerate, &valid), Ok(()), "seed {seed}\n{text}");
        let (what, wrong) = WRONG[seed as usize % WRONG.len()];
        let mut machine = valid.clone();
        wrong(&mut machine, &mut chance);
        if machine == valid {
            continue;
        }
        *tried.entry(what).or_default() += 1;
        let message = validate(&compiled.nondegenerate, &machine);
        assert!(
            message.as_ref().is_err_and(|message| message.code == Code::E0901),
            "seed {seed}, {what}: {message:?}\n{text}"
        );
    }
    println!("{tried:#?}");
    // Every mutation was tried.
    assert_eq!(tried.len(), WRONG.len(), "{tried:?}");
}
