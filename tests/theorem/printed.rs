//! The printed conditions against their words: every numbering, on whole matrices; and where they differ from the exact ones.

use mdlec::theorem::{Answer, STEPS, as_printed, decompile};

use crate::machines::{Row, Table, machine};

/// The row in which a column of a matrix has its 1.
type Matrix = Vec<usize>;

/// R1 and R2 as they are printed, R3 where the two overlap (`k1 < p2`); R4 speaks of what R2 forbids.
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

/// Whether they hold in any numbering, the termination state last.
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
                // To the letter, R4 forbids whatever leads forwards.
                assert!(rules.iter().any(|rule| rule.letter.is_some()), "{rows:?}: {rules:?}");
                match exactly {
                    Answer::String(found) if !meant => differ.push((atoms, rows, !found.loops.is_empty())),
                    // As they are meant they never accept what has no string.
                    Answer::None(_) => assert!(!meant, "{rows:?}: {rules:?}"),
                    Answer::String(_) | Answer::Stopped(_) => {}
                }
            }
        }
    }
    // The smallest machines that have a string though the printed conditions say that they have none: with a loop,
    let with_loop = differ.iter().find(|(.., has_loop)| *has_loop).expect("one with a loop");
    assert_eq!(with_loop, &(1, vec![vec![Some(0)]], true));
    // without one, which has two interrupts for one atom,
    let without = differ.iter().find(|(.., has_loop)| !has_loop).expect("one without");
    assert_eq!(without, &(1, vec![vec![Some(1)], vec![Some(1)]], false));
    // and with one interrupt in two places.
    let places = differ.iter().find(|(_, rows, has_loop)| rows.len() == 1 && !has_loop).expect("one in two places");
    assert_eq!(places, &(2, vec![vec![Some(2), Some(0)]], false));
}
