//! Small machines, identified by numbers. For each interrupt, a machine has a row with the destination of each atom, if
//! any.

use mdle_tests::chance::Chance;
use mdle_theory::theorem::{Machine, NamedInterrupt, State};

/// A row: the destination to which an interrupt leads from each atom; `None` if it does not affect the atom.
pub(crate) type Row = Vec<Option<usize>>;

/// The table of all rows for a given number of atoms. Rows are numbered from 0.
pub(crate) struct Table;

impl Table {
    /// Returns the number of rows.
    pub(crate) fn count(atoms: usize) -> usize {
        (atoms + 2).pow(u32::try_from(atoms).unwrap())
    }

    /// Returns every row, in the order of their numbers.
    pub(crate) fn rows(atoms: usize) -> Vec<Row> {
        (0..Self::count(atoms)).map(|number| Self::row(number, atoms)).collect()
    }

    /// Returns the row with this number.
    pub(crate) fn row(mut number: usize, atoms: usize) -> Row {
        let mut row = Vec::new();
        for _ in 0..atoms {
            row.push((number % (atoms + 2)).checked_sub(1));
            number /= atoms + 2;
        }
        row
    }

    /// Returns the number of a row.
    pub(crate) fn number(row: &[Option<usize>]) -> usize {
        row.iter().rev().fold(0, |number, to| number * (row.len() + 2) + to.map_or(0, |to| to + 1))
    }
}

/// Returns the machine with these rows. Its states are `s1`, `s2`, …, and its interrupts are `x1`, `x2`, ….
pub(crate) fn machine(atoms: usize, rows: &[Row]) -> Machine {
    let states = (1..=atoms + 1).map(|number| format!("s{number}")).collect();
    let state = |place: usize| State(u32::try_from(place).unwrap());
    let interrupts = (1..).zip(rows).map(|(number, row)| {
        let moves = row.iter().enumerate().filter_map(|(from, to)| Some((state(from), state((*to)?))));
        (NamedInterrupt { name: format!("x{number}"), text: None }, moves.collect())
    });
    Machine::new(states, interrupts.collect())
}

/// Returns the rows of a random machine with nested scopes and loops and with its atoms in random order. Most of these
/// machines have a string; the others differ little from a machine with a string.
pub(crate) fn likely(chance: &mut Chance, atoms: usize, interrupts: usize) -> Vec<Row> {
    let (mut loops, mut runs) = (Vec::new(), Vec::new());
    enclose(chance, 0, atoms, &mut loops, &mut runs);
    let mut rows = vec![vec![None; atoms]; interrupts];
    for (first, last) in runs {
        let around: Vec<_> = loops.iter().filter(|(begin, end)| *end == last && *begin <= first).collect();
        let to = around.iter().map(|(begin, _)| *begin).max().unwrap_or(last + 1);
        // Rows in which these atoms have no destination yet; one interrupt may occur in several places.
        let free: Vec<_> = (0..interrupts).filter(|row| rows[*row][first..=last].iter().all(Option::is_none)).collect();
        if !free.is_empty() {
            let row = free[chance.below(free.len())];
            rows[row][first..=last].fill(Some(to));
        }
    }
    let mut places: Vec<_> = (0..atoms).collect();
    for place in (1..atoms).rev() {
        places.swap(place, chance.below(place + 1));
    }
    places.push(atoms);
    let mut disordered = vec![vec![None; atoms]; interrupts];
    for (row, disordered) in rows.iter().zip(&mut disordered) {
        for (atom, to) in row.iter().enumerate() {
            disordered[places[atom]] = to.map(|to| places[to]);
        }
    }
    if chance.percent(40) {
        let (row, atom) = (chance.below(interrupts), chance.below(atoms));
        disordered[row][atom] = chance.below(atoms + 2).checked_sub(1);
    }
    disordered
}

/// Encloses atoms in random scopes and loops; each atom has at least its own scope.
fn enclose(
    chance: &mut Chance,
    first: usize,
    behind: usize,
    loops: &mut Vec<(usize, usize)>,
    runs: &mut Vec<(usize, usize)>,
) {
    let last = behind - 1;
    if chance.percent(35) {
        loops.push((first, last));
    }
    if first == last {
        runs.push((first, last));
        return;
    }
    if chance.percent(40) {
        runs.push((first, last));
    }
    let middle = first + 1 + chance.below(last - first);
    enclose(chance, first, middle, loops, runs);
    enclose(chance, middle, behind, loops, runs);
}
