//! Implements Theorem 1 directly from its statement (docs/src/reference/semantics.md, 8.5), by trying every numbering,
//! every cut into runs, and every family of loops.
//!
//! It shares no code with the compiler. Everything that depends on the number of atoms only is computed once.

use mdle_theory::theorem::{Found, Machine};

use super::machines::Table;

/// First and last position of a run or a loop.
type Interval = (usize, usize);

/// A set of intervals: bit `i` represents the interval with index `i` in the list of all intervals.
type Set = u32;

/// Precomputed consequences of the statement for machines with a certain number of atoms.
pub(crate) struct Definition {
    atoms: usize,
    intervals: Vec<Interval>,
    /// For each interval, the intervals that are neither nested with it nor disjoint.
    crossing: Vec<Set>,
    /// For each family of loops and each row of destinations, the sets of runs into which the row can be cut.
    cuts: Vec<Vec<Vec<Set>>>,
    /// For each row of destinations, the families of loops with which it can be cut, one bit per family.
    families: Vec<Vec<u64>>,
    /// For each numbering, the position of each atom, and the renumbered form of each row.
    numberings: Vec<(Vec<usize>, Vec<usize>)>,
}

fn nest_or_are_disjoint(one: Interval, other: Interval) -> bool {
    let holds = |outer: Interval, inner: Interval| outer.0 <= inner.0 && inner.1 <= outer.1;
    holds(one, other) || holds(other, one) || one.1 < other.0 || other.1 < one.0
}

/// Returns the possible destinations of a run's interrupt: the start of the innermost loop that encloses the run and
/// ends with it or, without such a loop, the position after the run. If a loop is equal to the run, either of them may
/// be the inner one, so both destinations are returned.
fn destinations(run: Interval, loops: &[Interval]) -> Vec<usize> {
    let ends_with = |inner: bool| {
        let around = loops.iter().filter(|around| around.1 == run.1 && around.0 <= run.0);
        let outside = around.filter(|around| inner || **around != run);
        outside.map(|around| around.0).max().unwrap_or(run.1 + 1)
    };
    vec![ends_with(true), ends_with(false)]
}

impl Definition {
    pub(crate) fn new(atoms: usize) -> Self {
        let intervals: Vec<_> = (0..atoms).flat_map(|first| (first..atoms).map(move |last| (first, last))).collect();
        let set_of = |test: &dyn Fn(Interval) -> bool| -> Set {
            intervals.iter().enumerate().filter(|(_, one)| test(**one)).map(|(place, _)| 1 << place).sum()
        };
        let crossing: Vec<_> =
            intervals.iter().map(|one| set_of(&|other| !nest_or_are_disjoint(*one, other))).collect();
        let rows = Table::rows(atoms);
        let all = (0..1 << intervals.len()).filter(|family| is_laminar(*family, &crossing));
        let loops = all.map(|family: Set| {
            let chosen = intervals.iter().enumerate().filter(|(place, _)| family >> place & 1 == 1);
            (family, chosen.map(|(_, one)| *one).collect::<Vec<_>>())
        });
        let cuts: Vec<Vec<_>> = loops
            .map(|(family, loops)| {
                // Possible destinations of each interval as a run; none if it crosses a loop.
                let leads: Vec<_> = intervals
                    .iter()
                    .zip(&crossing)
                    .map(|(run, crossing)| if crossing & family == 0 { destinations(*run, &loops) } else { vec![] })
                    .collect();
                rows.iter().map(|row| cuts(row, &intervals, &leads)).collect()
            })
            .collect();
        let families = (0..rows.len())
            .map(|row| {
                let mut fits = vec![0_u64; cuts.len().div_ceil(64)];
                for (family, _) in cuts.iter().enumerate().filter(|(_, cuts)| !cuts[row].is_empty()) {
                    fits[family / 64] |= 1 << (family % 64);
                }
                fits
            })
            .collect();
        let numberings = permutations(atoms).into_iter().map(|places| {
            let rows = rows.iter().map(|row| Table::number(&renumbered(row, &places))).collect();
            (places, rows)
        });
        Self { numberings: numberings.collect(), atoms, intervals, crossing, cuts, families }
    }

    /// Returns `true` if a machine has a string that begins with `start`. The machine is given as the number of a row
    /// of destinations for each interrupt.
    pub(crate) fn has_string(&self, rows: &[usize], start: Option<usize>) -> bool {
        let mut numberings = self.numberings.iter().filter(|(places, _)| start.is_none_or(|start| places[start] == 0));
        numberings.any(|(_, renumbered)| {
            let rows: Vec<_> = rows.iter().map(|row| renumbered[*row]).collect();
            let words = (0..self.cuts.len().div_ceil(64))
                .map(|word| rows.iter().fold(u64::MAX, |all, row| all & self.families[*row][word]));
            words.enumerate().any(|(word, fits)| {
                let mut families = (0..64).filter(|bit| fits >> bit & 1 == 1).map(|bit| word * 64 + bit);
                families.any(|family| self.fits(&self.cuts[family], &rows, 0))
            })
        })
    }

    /// Returns `true` if the rows can be cut such that all runs are nested or disjoint, and each atom is a run.
    fn fits(&self, cuts: &[Vec<Set>], rows: &[usize], runs: Set) -> bool {
        let [row, rest @ ..] = rows else {
            return (0..self.atoms).all(|atom| {
                let place = self.intervals.iter().position(|one| *one == (atom, atom)).expect("an interval");
                runs >> place & 1 == 1
            });
        };
        cuts[*row].iter().any(|cut| {
            let all = runs | cut;
            is_laminar(all, &self.crossing) && self.fits(cuts, rest, all)
        })
    }
}

fn is_laminar(set: Set, crossing: &[Set]) -> bool {
    crossing.iter().enumerate().all(|(place, crossing)| set >> place & 1 == 0 || set & crossing == 0)
}

/// Returns the sets of runs into which a row of destinations can be cut.
fn cuts(row: &[Option<usize>], intervals: &[Interval], leads: &[Vec<usize>]) -> Vec<Set> {
    let mut found = vec![(0, 0)];
    let mut whole = Vec::new();
    while let Some((atom, set)) = found.pop() {
        match row.get(atom) {
            None => whole.push(set),
            Some(None) => found.push((atom + 1, set)),
            Some(Some(to)) => {
                let runs = intervals.iter().zip(leads).enumerate().filter(|(_, ((first, last), leads))| {
                    *first == atom && leads.contains(to) && row[*first..=*last].iter().all(|other| *other == Some(*to))
                });
                found.extend(runs.map(|(place, ((_, last), _))| (last + 1, set | 1 << place)));
            }
        }
    }
    whole
}

fn permutations(atoms: usize) -> Vec<Vec<usize>> {
    (0..atoms).fold(vec![vec![]], |all, place| {
        let longer = |one: Vec<usize>| {
            (0..=place).map(move |at| {
                let mut longer = one.clone();
                longer.insert(at, place);
                longer
            })
        };
        all.into_iter().flat_map(longer).collect()
    })
}

/// Returns a row with the atoms at other positions; the termination state keeps its position.
fn renumbered(row: &[Option<usize>], places: &[usize]) -> Vec<Option<usize>> {
    let mut renumbered = vec![None; row.len()];
    for (atom, to) in row.iter().enumerate() {
        renumbered[places[atom]] = to.map(|to| places.get(to).copied().unwrap_or(to));
    }
    renumbered
}

/// Asserts that a decompiled string satisfies the statement.
pub(crate) fn assert_is_string(machine: &Machine, found: &Found) {
    let size = machine.states().len();
    let mut sorted: Vec<_> = found.order.iter().map(|state| state.0 as usize).collect();
    assert_eq!(sorted.last(), Some(&(size - 1)), "the termination state is the last");
    if let Some(start) = machine.start() {
        assert_eq!(found.order[0], start);
    }
    sorted.sort_unstable();
    assert_eq!(sorted, (0..size).collect::<Vec<_>>(), "each state once");
    let loops: Vec<Interval> = found.loops.iter().map(|one| (one.first, one.last)).collect();
    let runs: Vec<Interval> = found.runs.iter().map(|run| (run.first, run.last)).collect();
    let all: Vec<_> = loops.iter().chain(&runs).collect();
    for (place, one) in all.iter().enumerate() {
        assert!(all[place..].iter().all(|other| nest_or_are_disjoint(**one, **other)), "{found:?}");
    }
    for run in &found.runs {
        assert!(destinations((run.first, run.last), &loops).contains(&run.to), "{run:?} in {found:?}");
    }
    for atom in 0..size - 1 {
        assert!(runs.contains(&(atom, atom)), "{atom} has no interrupt of its own in {found:?}");
    }
    let mut moves: Vec<_> = Vec::new();
    for run in &found.runs {
        moves
            .extend((run.first..=run.last).map(|place| (run.interrupt.0, found.order[place].0, found.order[run.to].0)));
    }
    let mut listed: Vec<_> = Vec::new();
    for state in &found.order {
        listed.extend(machine.exits(*state).iter().map(|exit| (exit.interrupt.0, state.0, exit.to.0)));
    }
    moves.sort_unstable();
    listed.sort_unstable();
    assert_eq!(moves, listed, "the runs are the moves: {found:?}");
}
