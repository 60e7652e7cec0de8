//! Compares the implementation of Theorem 1 with its statement, on all small machines and on random larger ones.

use std::sync::LazyLock;
use std::time::Instant;

use mdle_tests::chance::{Chance, repeated};
use mdle_theory::theorem::{STEPS, State, TheoremResult, decompile};

use super::definition::{Definition, assert_is_string};
use super::machines::{Row, Table, likely, machine};

/// Definitions for one to four atoms.
static DEFINITIONS: LazyLock<Vec<Definition>> = LazyLock::new(|| (1..=4).map(Definition::new).collect());

/// Number of random machines of each size.
const SAMPLES: u64 = 34_000;

/// Numbers of compared machines, of machines with a string, and of machines whose string has a loop.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq)]
struct Count {
    machines: usize,
    strings: usize,
    with_loops: usize,
}

/// Compares the implementation of the theorem with its statement on one machine.
fn compare(atoms: usize, rows: &[Row], start: Option<usize>, count: &mut Count) {
    let machine = machine(atoms, rows);
    let machine = match start {
        Some(start) => machine.starting(State(u32::try_from(start).unwrap())),
        None => machine,
    };
    let numbers: Vec<_> = rows.iter().map(|row| Table::number(row)).collect();
    let expected = DEFINITIONS[atoms - 1].has_string(&numbers, start);
    let answer = decompile(&machine, STEPS);
    count.machines += 1;
    match &answer {
        TheoremResult::String(found) => {
            assert!(expected, "{rows:?}: {found:?}");
            assert_is_string(&machine, found);
            count.strings += 1;
            count.with_loops += usize::from(!found.loops.is_empty());
        }
        TheoremResult::None(broken) => {
            assert!(!expected, "{rows:?}: {broken:?}");
            assert!(!broken.is_empty(), "{rows:?}");
        }
        TheoremResult::Stopped(_) => panic!("{rows:?}: stopped"),
    }
}

/// Runs `work` on every core, with the number of the core and the number of cores, and returns the sum of the results.
fn on_all_cores(work: impl Fn(usize, usize) -> Count + Sync) -> Count {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let hands: Vec<_> = (0..cores)
            .map(|hand| {
                scope.spawn({
                    let work = &work;
                    move || work(hand, cores)
                })
            })
            .collect();
        hands.into_iter().map(|hand| hand.join().expect("no difference")).fold(Count::default(), |all, one| Count {
            machines: all.machines + one.machines,
            strings: all.strings + one.strings,
            with_loops: all.with_loops + one.with_loops,
        })
    })
}

/// Compares every machine with these numbers of atoms and interrupts. The rows of a machine are ascending, because the
/// order of the interrupts has no effect.
fn exhaust(atoms: usize, interrupts: usize, start: Option<usize>) -> Count {
    let rows = Table::rows(atoms);
    on_all_cores(|hand, cores| {
        let mut count = Count::default();
        for first in (hand..rows.len()).step_by(cores) {
            let mut chosen = vec![first; interrupts];
            loop {
                let machine: Vec<_> = chosen.iter().map(|row| rows[*row].clone()).collect();
                compare(atoms, &machine, start, &mut count);
                // Continues with the next combination that begins with the same row.
                let Some(place) = (1..interrupts).rev().find(|place| chosen[*place] + 1 < rows.len()) else { break };
                let next = chosen[place] + 1;
                chosen[place..].fill(next);
            }
        }
        count
    })
}

fn sample(atoms: usize, interrupts: usize) -> Count {
    on_all_cores(|hand, cores| {
        let mut count = Count::default();
        for seed in (hand as u64..repeated(SAMPLES)).step_by(cores) {
            let mut chance = Chance::new(seed);
            let rows = match seed % 4 {
                0 => (0..interrupts).map(|_| Table::row(chance.below(Table::count(atoms)), atoms)).collect(),
                _ => likely(&mut chance, atoms, interrupts),
            };
            compare(atoms, &rows, None, &mut count);
        }
        count
    })
}

#[test]
fn every_small_machine_is_judged_as_the_statement_does() {
    let begin = Instant::now();
    for (atoms, interrupts) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (3, 2)] {
        let count = exhaust(atoms, interrupts, None);
        println!("{} states, {interrupts} interrupts: {count:?} {:?}", atoms + 1, begin.elapsed());
        assert!(count.strings > 0);
    }
}

#[test]
fn every_small_machine_with_a_first_state_is_judged_as_the_statement_does() {
    for (atoms, interrupts) in [(2, 1), (2, 2), (3, 1), (3, 2)] {
        for start in 0..atoms {
            assert!(exhaust(atoms, interrupts, Some(start)).strings > 0);
        }
    }
}

#[test]
fn samples_of_larger_machines_are_judged_as_the_statement_does() {
    let begin = Instant::now();
    for (atoms, interrupts) in [(3, 4), (4, 3)] {
        let count = sample(atoms, interrupts);
        println!("{} states, {interrupts} interrupts: {count:?} {:?}", atoms + 1, begin.elapsed());
        // The random machines cover what they are meant to test.
        assert!(count.strings > count.machines / 10 && count.strings < count.machines * 9 / 10, "{count:?}");
        assert!(count.with_loops > count.machines / 20, "{count:?}");
    }
}
