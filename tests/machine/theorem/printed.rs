//! Compares the check of the paper's printed conditions with their wording, on whole matrices and with every numbering
//! of the states. Also tests where the printed conditions differ from the exact ones.

use mdle_tests::chance::{Chance, repeated};
use mdle_theory::theorem::{Machine, NamedInterrupt, STEPS, State, TheoremResult, as_printed, decompile};

use super::machines::{Row, Table, likely, machine};

/// Number of random machines of each kind.
const MACHINES: u64 = 7_000;

/// A matrix, as the row of the 1 in each column.
type Matrix = Vec<usize>;

/// Returns `true` if R1 and R2 hold as printed, and R3 holds where two runs overlap (`k1 < p2`). R4 is not checked,
/// because R2 forbids the transitions to which it refers.
fn hold(matrices: &[Matrix]) -> bool {
    let states = matrices[0].len();
    let moves = |matrix: &Matrix| -> Vec<_> { (0..states).filter(|column| matrix[*column] != *column).collect() };
    let first = (0..states - 1).all(|k| {
        let own = matrices.iter().filter(|matrix| moves(matrix) == [k] && matrix[k] == k + 1);
        own.count() == 1
    });
    let second = matrices.iter().all(|matrix| {
        moves(matrix).iter().all(|k| matrix[*k] >= *k && (*k..=matrix[*k]).all(|column| matrix[column] == matrix[*k]))
    });
    let third = matrices.iter().enumerate().all(|(i1, one)| {
        let others = || matrices.iter().enumerate().filter(move |(i2, _)| *i2 != i1);
        moves(one).iter().all(|k1| {
            others().all(|(_, other)| {
                moves(other).iter().all(|k2| {
                    let (p1, p2) = (one[*k1], other[*k2]);
                    let overlap = k2 <= k1 && *k1 < p2 && p2 < p1;
                    !overlap || (*k2..=p1).all(|column| one[column] == p1)
                })
            })
        })
    });
    first && second && third
}

/// Returns `true` if the printed conditions hold in some numbering in which the termination state is the last state.
fn hold_somewhere(atoms: usize, rows: &[Row]) -> bool {
    let mut numberings = vec![vec![]];
    for place in 0..atoms {
        let longer = numberings.iter().flat_map(|one: &Vec<usize>| {
            (0..=place).map(move |at| {
                let mut longer = one.clone();
                longer.insert(at, place);
                longer
            })
        });
        numberings = longer.collect();
    }
    numberings.iter().any(|places| {
        let place = |state: usize| if state == atoms { atoms } else { places[state] };
        let matrices = rows.iter().map(|row| {
            let mut matrix: Matrix = (0..=atoms).collect();
            (0..atoms).for_each(|atom| matrix[place(atom)] = place(row[atom].unwrap_or(atom)));
            matrix
        });
        hold(&matrices.collect::<Vec<_>>())
    })
}

#[test]
fn they_are_judged_in_the_one_numbering_in_which_they_can_hold() {
    let mut differ = Vec::new();
    for (atoms, interrupts) in [(1, 1), (1, 2), (2, 1), (2, 2), (3, 2)] {
        let count = Table::count(atoms);
        for first in 0..count {
            for second in if interrupts == 1 { 0..1 } else { first..count } {
                let numbers = [first, second];
                let rows: Vec<_> = numbers[..interrupts].iter().map(|number| Table::row(*number, atoms)).collect();
                let machine = machine(atoms, &rows);
                let exactly = decompile(&machine, STEPS);
                let rules = as_printed(&machine, &exactly);
                let meant = rules.iter().all(|rule| rule.meant.is_none());
                assert_eq!(meant, hold_somewhere(atoms, &rows), "{rows:?}: {rules:?}");
                // In its literal wording, R4 forbids every forward transition.
                assert!(rules.iter().any(|rule| rule.letter.is_some()), "{rows:?}: {rules:?}");
                match exactly {
                    TheoremResult::String(found) if !meant => differ.push((atoms, rows, !found.loops.is_empty())),
                    // In their intended meaning, the conditions never accept a machine without a string.
                    TheoremResult::None(_) => assert!(!meant, "{rows:?}: {rules:?}"),
                    TheoremResult::String(_) | TheoremResult::Stopped(_) => {}
                }
            }
        }
    }
    // The smallest machines that have a string although they violate the printed conditions: a machine with a loop,
    let with_loop = differ.iter().find(|(.., has_loop)| *has_loop).expect("one with a loop");
    assert_eq!(with_loop, &(1, vec![vec![Some(0)]], true));
    // a machine without a loop, which has two interrupts for one atom,
    let without = differ.iter().find(|(.., has_loop)| !has_loop).expect("one without");
    assert_eq!(without, &(1, vec![vec![Some(1)], vec![Some(1)]], false));
    // and a machine with one interrupt in two places.
    let places = differ.iter().find(|(_, rows, has_loop)| rows.len() == 1 && !has_loop).expect("one in two places");
    assert_eq!(places, &(2, vec![vec![Some(2), Some(0)]], false));
}

/// A transition: its interrupt, the state that it leaves, and the state that it enters.
type Move = (usize, usize, usize);

/// Checks conditions R2 and R3 in their printed wording, exhaustively, for states in the order of the file. For each
/// condition, returns the first violation found, or `None` if the condition holds.
fn sentences(atoms: usize, rows: &[Row]) -> [Option<String>; 2] {
    let row = |interrupt: usize, column: usize| rows[interrupt].get(column).copied().flatten().unwrap_or(column);
    let all = (0..atoms).flat_map(|from| (0..rows.len()).map(move |interrupt| (interrupt, from)));
    let moves: Vec<Move> = all.map(|(interrupt, from)| (interrupt, from, row(interrupt, from))).collect();
    let moves: Vec<_> = moves.into_iter().filter(|(_, from, to)| from != to).collect();
    let second = moves.iter().find_map(|(x, from, to)| {
        let other = (*from..=*to).find(|column| row(*x, *column) != *to)?;
        let leads = format!("`x{}` leads from `s{}` to `s{}`", x + 1, from + 1, to + 1);
        Some(match row(*x, other) {
            stays if stays == other => format!("{leads}, but does not lead on from `s{}`", other + 1),
            row => format!("{leads}, but from `s{}` to `s{}`", other + 1, row + 1),
        })
    });
    let third = moves.iter().enumerate().find_map(|(number, (x, from, to))| {
        let encloses = |column: usize| column < *from && (column..=*to).all(|column| row(*x, column) == *to);
        let (other, column, at) =
            moves[..number].iter().find(|(other, column, at)| other != x && at < to && !encloses(*column))?;
        Some(format!(
            "`x{}` leads from `s{}` to `s{}`, and so `x{}` would have to lead to `s{}` from there on as well",
            other + 1,
            column + 1,
            at + 1,
            x + 1,
            to + 1
        ))
    });
    [second, third]
}

#[test]
fn the_letter_is_judged_as_if_everything_were_looked_at() {
    let (mut broken, mut held) = ([0_u64; 2], [0_u64; 2]);
    for seed in 0..repeated(MACHINES) {
        let mut chance = Chance::new(seed);
        let (atoms, interrupts) = (1 + chance.below(6), 1 + chance.below(5));
        // All transitions lead forward, and one leads from each state to the next, so the file's order is the only
        // possible one.
        let row = |chance: &mut Chance| -> Row {
            let (first, length) = (chance.below(atoms), chance.below(atoms) + 1);
            let to = (first + length).min(atoms);
            let mut row: Row = (0..atoms).map(|place| (first..to).contains(&place).then_some(to)).collect();
            if chance.below(3) == 0 {
                let place = chance.below(atoms);
                let to = place + 1 + chance.below(atoms - place);
                row[place] = (chance.below(2) == 0).then_some(to);
            }
            row
        };
        let mut rows: Vec<Row> = (0..interrupts).map(|_| row(&mut chance)).collect();
        rows.extend((0..atoms).map(|own| (0..atoms).map(|place| (place == own).then_some(place + 1)).collect()));
        let machine = machine(atoms, &rows);
        let rules = as_printed(&machine, &decompile(&machine, STEPS));
        for (rule, (number, expected)) in rules[1..3].iter().zip(sentences(atoms, &rows).into_iter().enumerate()) {
            broken[number] += u64::from(expected.is_some());
            held[number] += u64::from(expected.is_none());
            assert_eq!(rule.letter, expected, "{}: {rows:?}", rule.name);
        }
    }
    assert!(broken.iter().chain(&held).all(|count| *count > repeated(MACHINES) / 20), "{broken:?} {held:?}");
}

/// Returns `true` if every order of the states has a transition that leads back.
fn leads_back(rows: &[Row]) -> bool {
    let mut left: Vec<usize> = (0..rows[0].len()).collect();
    let leads_inside = |from: usize, left: &[usize]| {
        rows.iter().any(|row| row[from].is_some_and(|to| to != from && left.contains(&to)))
    };
    while let Some(last) = left.iter().position(|from| !leads_inside(*from, &left)) {
        left.remove(last);
    }
    !left.is_empty()
}

#[test]
fn what_leads_back_is_judged_as_if_everything_were_looked_at() {
    let mut seen = [0_u64; 2];
    for seed in 0..repeated(MACHINES) {
        let mut chance = Chance::new(seed);
        let (atoms, interrupts) = (2 + chance.below(4), 2 + chance.below(4));
        let rows = likely(&mut chance, atoms, interrupts);
        let machine = machine(atoms, &rows);
        let TheoremResult::String(found) = decompile(&machine, STEPS) else { continue };
        // Only in these machines is the file's order that of the string, so that positions can be compared.
        if !leads_back(&rows) || !found.order.iter().map(|state| state.0).is_sorted() {
            continue;
        }
        let rules = as_printed(&machine, &TheoremResult::String(found));
        let [_, third] = sentences(atoms, &rows);
        seen[usize::from(third.is_some())] += 1;
        assert_eq!(rules[2].letter, third, "{rows:?}");
    }
    assert!(seen.iter().all(|count| *count > repeated(MACHINES) / 300), "{seen:?}");
}

#[test]
fn large_machines_are_judged_in_time_with_their_moves() {
    const ATOMS: u32 = 30_000;
    let named = |name: String| NamedInterrupt { name, text: None };
    let moves = |first: u32, last: u32| (first..last).map(|from| (State(from), State(last))).collect();
    // A scope encloses everything, others enclose a hundred atoms each, and others one atom each: a check of every pair
    // of transitions would take hours.
    let mut interrupts = vec![(named("all".into()), moves(0, ATOMS))];
    interrupts.extend((0..ATOMS / 100).map(|part| (named(format!("w{part}")), moves(100 * part, 100 * part + 100))));
    interrupts.extend((0..ATOMS).map(|atom| (named(format!("x{atom}")), moves(atom, atom + 1))));
    let machine = Machine::new((0..=ATOMS).map(|state| format!("s{state}")).collect(), interrupts);
    let rules = as_printed(&machine, &decompile(&machine, STEPS));
    assert!(rules.iter().all(|rule| rule.meant.is_none()), "{rules:?}");
}
