//! Checks the conditions R1 to R4 of Theorem 1 as printed in the paper, using the columns of transition matrices. Each
//! condition is checked both literally and as intended.
//!
//! An interrupt's columns are those in which its matrix differs from the identity. A transition to the same state is
//! ignored, because its column is that of the identity.

use super::loop_free::{crossings, cut};
use super::order::{forwards, places};
use super::{InterruptId, Machine, State, TheoremResult};

/// Result of checking a printed condition for a machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rule {
    /// Name of the condition, `R1` to `R4`.
    pub name: &'static str,
    /// Reason why the literal condition is not satisfied; `None` if it is satisfied.
    pub letter: Option<String>,
    /// Reason why the intended condition is not satisfied; `None` if it is satisfied.
    pub meant: Option<String>,
}

/// Columns of the matrices, numbered from 0 in an order of the states.
struct Columns<'m> {
    machine: &'m Machine,
    order: Vec<State>,
    places: Vec<usize>,
}

/// Checks the printed conditions for the only order of the states in which they can hold: the order in which all
/// interrupts lead forwards. For a machine with a cycle, they cannot hold. In this case, the order is that of the
/// machine's string in `exactly` or, if there is no string, an order in which most interrupts lead forwards.
#[must_use]
pub fn as_printed(machine: &Machine, exactly: &TheoremResult) -> [Rule; 4] {
    let mut order = forwards(machine);
    let mut places = places(&order);
    let place = |state: &State| places[state.0 as usize];
    let leads_back = order.iter().any(|from| machine.exits(*from).iter().any(|exit| place(&exit.to) < place(from)));
    if let (true, TheoremResult::String(found)) = (leads_back, exactly) {
        order.clone_from(&found.order);
        places = super::order::places(&order);
    }
    let columns = Columns { machine, order, places };
    let (first, second) = (columns.atoms(), columns.forwards());
    [
        Rule { name: "R1", letter: first.clone(), meant: first },
        Rule { name: "R2", letter: second.clone(), meant: second },
        Rule { name: "R3", letter: columns.nested_to_the_letter(), meant: columns.nested() },
        // R2 already forbids the transitions that R4 is about.
        Rule { name: "R4", letter: columns.loops_to_the_letter(), meant: None },
    ]
}

/// Consecutive columns of an interrupt's matrix that have their 1 in the same row.
#[derive(Debug, Clone, Copy)]
struct Same {
    first: usize,
    /// Index of the column after the last of these columns.
    behind: usize,
}

/// Minimum destination row of a set of transitions, with its interrupt, and the minimum destination row of the
/// transitions of all other interrupts.
#[derive(Debug, Clone, Copy, Default)]
struct Lowest {
    one: Option<(usize, InterruptId)>,
    other: Option<usize>,
}

impl Lowest {
    /// Returns the minimum rows after an additional transition.
    fn with(self, interrupt: InterruptId, row: usize) -> Self {
        let Some((lowest, of)) = self.one else { return Self { one: Some((row, interrupt)), other: None } };
        if of == interrupt {
            return Self { one: Some((lowest.min(row), of)), ..self };
        }
        if row < lowest {
            return Self { one: Some((row, interrupt)), other: Some(lowest) };
        }
        Self { other: Some(self.other.map_or(row, |other| other.min(row))), ..self }
    }

    /// Returns the minimum destination row of all interrupts other than `interrupt`.
    fn of_another(self, interrupt: InterruptId) -> usize {
        match self.one {
            Some((lowest, of)) if of != interrupt => lowest,
            Some(_) => self.other.unwrap_or(usize::MAX),
            None => usize::MAX,
        }
    }
}

impl Columns<'_> {
    /// Returns all transitions to a different position, each as the interrupt, the source position, and the destination
    /// position.
    fn moves(&self) -> impl Iterator<Item = (InterruptId, usize, usize)> {
        let from = self.order.iter().enumerate();
        let all = from.flat_map(|(place, state)| self.machine.exits(*state).iter().map(move |exit| (place, exit)));
        let all = all.map(|(place, exit)| (exit.interrupt, place, self.places[exit.to.0 as usize]));
        all.filter(|(_, from, to)| from != to)
    }

    /// Returns the row of the 1 in a column of an interrupt's matrix.
    fn row(&self, interrupt: InterruptId, column: usize) -> usize {
        let to = self.machine.destination(self.order[column], interrupt);
        to.map_or(column, |to| self.places[to.0 as usize])
    }

    fn state(&self, place: usize) -> String {
        format!("`{}`", self.machine.name(self.order[place]))
    }

    fn interrupt(&self, interrupt: InterruptId) -> String {
        format!("`{}`", self.machine.interrupt(interrupt).name)
    }

    /// Checks R1: for each column except the last, exactly one interrupt moves the column to the next one and moves no
    /// other column. Returns the reason if this does not hold.
    fn atoms(&self) -> Option<String> {
        let mut moved = vec![0_usize; self.machine.interrupts().len()];
        self.moves().for_each(|(interrupt, ..)| moved[interrupt.0 as usize] += 1);
        let mut own: Vec<Vec<InterruptId>> = vec![Vec::new(); self.order.len()];
        for (interrupt, from, to) in self.moves() {
            if to == from + 1 && moved[interrupt.0 as usize] == 1 {
                own[from].push(interrupt);
            }
        }
        let wrong = own.iter().take(self.order.len() - 1).position(|own| own.len() != 1)?;
        let (state, next) = (self.state(wrong), self.state(wrong + 1));
        Some(match own[wrong].as_slice() {
            [one, other, ..] => format!(
                "the interrupt that leads from {state} to {next} and does nothing else is to be unique, \
                 and {} and {} both do",
                self.interrupt(*one),
                self.interrupt(*other)
            ),
            [] | [_] => format!("no interrupt leads from {state} to {next} and does nothing else"),
        })
    }

    /// Checks R2: no interrupt leads back, and an interrupt that leads from one column to another also leads there from
    /// all columns between them. Returns the reason if this does not hold.
    fn forwards(&self) -> Option<String> {
        let runs = self.runs();
        self.moves().zip(&runs).find_map(|((interrupt, from, to), run)| {
            let name = self.interrupt(interrupt);
            if to < from {
                return Some(format!("{name} leads back, from {} to {}", self.state(from), self.state(to)));
            }
            let other = (run.behind <= to).then_some(run.behind)?;
            let (from, to, at) = (self.state(from), self.state(to), self.state(other));
            let row = self.row(interrupt, other);
            Some(match row == other {
                true => format!("{name} leads from {from} to {to}, but does not lead on from {at}"),
                false => format!("{name} leads from {from} to {to}, but from {at} to {}", self.state(row)),
            })
        })
    }

    /// Returns, for each transition in order, the consecutive columns around its source that have their 1 in the same
    /// row of the interrupt's matrix.
    fn runs(&self) -> Vec<Same> {
        let moves: Vec<_> = self.moves().collect();
        let mut runs: Vec<Same> = moves.iter().map(|(_, from, _)| Same { first: *from, behind: from + 1 }).collect();
        // Index of the latest transition of each interrupt.
        let mut near: Vec<Option<usize>> = vec![None; self.machine.interrupts().len()];
        for (number, (interrupt, from, to)) in moves.iter().enumerate() {
            let before = near[interrupt.0 as usize].replace(number);
            let before = before.filter(|before| moves[*before].1 + 1 == *from && moves[*before].2 == *to);
            runs[number].first = match before {
                Some(before) => runs[before].first,
                None => *from,
            };
        }
        near.fill(None);
        for (number, (interrupt, from, to)) in moves.iter().enumerate().rev() {
            let after = near[interrupt.0 as usize].replace(number);
            let is_same = |after: &usize| moves[*after].1 == from + 1 && moves[*after].2 == *to;
            if let Some(after) = after.filter(is_same) {
                runs[number].behind = runs[after].behind;
            } else if *to == from + 1 && self.row(*interrupt, *to) == *to {
                runs[number].behind = to + 1;
            }
        }
        runs
    }

    /// Checks R3 as intended: the columns that two interrupts enclose are disjoint or nested. Returns the reason if
    /// this does not hold.
    fn nested(&self) -> Option<String> {
        let (mut runs, _) = cut(self.machine, &self.order);
        runs.sort_by_key(|run| (run.first, std::cmp::Reverse(run.last), run.interrupt));
        let sentence = crossings(&self.order, &runs).first()?.sentence(self.machine);
        Some(sentence.trim_start_matches("R3: ").to_owned())
    }

    /// Returns the first column from which all columns up to a transition's destination have their 1 in the row of the
    /// destination; `None` if there is no such column.
    fn first_enclosed(&self, moves: &[(InterruptId, usize, usize)], runs: &[Same], number: usize) -> Option<usize> {
        let (interrupt, from, to) = moves[number];
        if from < to {
            return Some(runs[number].first).filter(|_| runs[number].behind > to);
        }
        if self.row(interrupt, to) != to {
            return Some(to + 1);
        }
        let before = to.checked_sub(1).and_then(|column| {
            moves.binary_search_by_key(&(column, interrupt), |(interrupt, from, _)| (*from, *interrupt)).ok()
        });
        Some(before.filter(|before| moves[*before].2 == to).map_or(to, |before| runs[before].first))
    }

    /// Checks R3 literally: if `k2 <= k1` and `p2 < p1` in the paper's notation, one of two interrupts must enclose the
    /// other. Returns the reason if this does not hold.
    fn nested_to_the_letter(&self) -> Option<String> {
        let (moves, runs) = (self.moves().collect::<Vec<_>>(), self.runs());
        let mut lowest = Vec::with_capacity(moves.len() + 1);
        lowest.push(Lowest::default());
        for (number, (interrupt, from, to)) in moves.iter().enumerate() {
            let (interrupt, from, to) = (*interrupt, *from, *to);
            let first = self.first_enclosed(&moves, &runs, number);
            let is_enclosed = |column: usize| column < from && first.is_some_and(|first| first <= column);
            // First the transitions that begin before the enclosed columns, then those that begin in the same column.
            let asked =
                first.map_or(number, |first| moves.partition_point(|(_, column, _)| *column < first).min(number));
            let beside = moves[..number].iter().rev().take_while(|(_, column, _)| *column == from);
            let is_broken = lowest[asked].of_another(interrupt) < to
                || beside.clone().any(|(other, _, row)| *other != interrupt && *row < to);
            if is_broken {
                let mut all = moves[..number].iter();
                let (other, column, row) =
                    all.find(|(other, column, row)| *other != interrupt && *row < to && !is_enclosed(*column))?;
                return Some(format!(
                    "{} leads from {} to {}, and so {} would have to lead to {} from there on as well",
                    self.interrupt(*other),
                    self.state(*column),
                    self.state(*row),
                    self.interrupt(interrupt),
                    self.state(to)
                ));
            }
            lowest.push(lowest[number].with(interrupt, to));
        }
        None
    }

    /// Checks R4 literally: if any interrupt leads forwards to a column, this column differs from its neighbours in all
    /// matrices. Returns the reason if this does not hold.
    fn loops_to_the_letter(&self) -> Option<String> {
        let mut equal = vec![None; self.order.len()];
        for (interrupt, from, _) in self.moves() {
            for column in
                [from.checked_sub(1), Some(from)].into_iter().flatten().filter(|one| one + 1 < self.order.len())
            {
                if self.row(interrupt, column) == self.row(interrupt, column + 1) {
                    equal[column].get_or_insert(interrupt);
                }
            }
        }
        self.moves().filter(|(_, from, to)| from < to).find_map(|(interrupt, from, to)| {
            let before = to.checked_sub(1).and_then(|column| equal[column]);
            let other = before.or(equal[to])?;
            let near = self.state(if before.is_some() { to - 1 } else { to + 1 });
            let (name, from, to) = (self.interrupt(interrupt), self.state(from), self.state(to));
            Some(format!(
                "{name} leads from {from} to {to}, and in {} the columns of {near} and {to} are equal",
                self.interrupt(other)
            ))
        })
    }
}

/// Maximum width of a line of matrices, in characters.
const WIDTH: usize = 110;

/// Returns the machine in monomial form (paper, Eq. 2), with matrices printed as in Eq. 6 and states in the order of
/// the file.
#[must_use]
pub fn monomial(machine: &Machine) -> String {
    let size = machine.states().len();
    let order: Vec<_> = machine.atoms().chain([machine.end()]).collect();
    let columns = Columns { machine, places: places(&order), order };
    let middle = (size - 1) / 2;
    let mut lines = vec![String::new(); size];
    let (mut text, mut start) = (String::new(), "Π(t) = ");
    for (interrupt, named) in (0..).map(InterruptId).zip(machine.interrupts()) {
        let blocks = (0..size).map(|row| {
            let bits = (0..size).map(|column| if columns.row(interrupt, column) == row { "1" } else { "0" });
            bits.collect::<Vec<_>>().join(" ")
        });
        let behind = format!(" {}", named.name);
        let room = start.chars().count() + 2 * size + 1 + behind.chars().count();
        if !lines[0].is_empty() && lines[0].chars().count() + room > WIDTH {
            lines.iter_mut().for_each(|line| text += &format!("{}\n", std::mem::take(line).trim_end()));
            text += "\n";
        }
        for (row, (line, block)) in lines.iter_mut().zip(blocks).enumerate() {
            let beside = |text: &str| if row == middle { text.to_owned() } else { " ".repeat(text.chars().count()) };
            *line += &format!("{}[{block}]{}", beside(start), beside(&behind));
        }
        start = " + ";
    }
    lines.iter().for_each(|line| text += &format!("{}\n", line.trim_end()));
    text
}
