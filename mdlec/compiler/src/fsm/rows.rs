//! A machine as table rows that contain ids of quarks. `rust` prints the rows; `load` replaces the ids with quarks.

use std::collections::{BTreeSet, VecDeque};

use mdle_runtime::{Condition as Row, Fact, Guard, LawRow, MarkRow, Nanometers, Nanos, Radians};

use super::{Atom, Element, Machine};
use crate::alphabet::{Alphabet, ParameterKind};
use crate::plan::{Condition, Quark, QuarkId, Value};

/// The conditions, laws and labels of a plan, as table rows.
#[derive(Debug)]
pub struct Rows {
    /// Condition that ends each bracket, in the order of the brackets.
    pub guards: Vec<Guard<QuarkId>>,
    /// Operands of conditions, breadth first: the operands of one condition are consecutive, and come after the
    /// condition.
    pub operands: Vec<Row<QuarkId>>,
    /// Law of each atom, in the order of the atoms.
    pub laws: Vec<LawRow<QuarkId>>,
    /// The labels of the elements that end with each bracket, in the order of the brackets.
    pub marks: Vec<MarkRow>,
    /// The facts of all labels, which `after` reads.
    pub facts: Vec<Fact>,
}

/// Returns the table rows of a machine.
#[must_use]
pub fn rows(machine: &Machine) -> Rows {
    let mut operands = Operands { machine, waiting: VecDeque::new(), count: 0 };
    let guards = machine.elements().map(|element| Guard {
        condition: operands.row(element.condition()),
        level: element.level().unwrap_or(0),
        around: around(element).number(),
        follows: element.follows(),
    });
    let guards = guards.collect();
    let laws = machine.atoms().map(|atom| LawRow { control: atom.law_id(), frame: Radians(atom.turned()) });
    let (marks, facts) = marks(machine);
    Rows { guards, operands: operands.rows(), laws: laws.collect(), marks, facts }
}

/// Returns the names of the path files that the laws of a machine replay; each name is listed once.
#[must_use]
pub fn replayed_files<'m>(machine: &'m Machine, alphabet: &Alphabet) -> BTreeSet<&'m str> {
    let replays = |quark: &Quark| {
        let declaration = alphabet.declarations_of(&quark.name).nth(quark.overload);
        declaration.is_some_and(|declaration| declaration.needs.iter().any(|need| need.name == "paths"))
    };
    let laws = machine.atoms().map(Atom::law).filter(|quark| replays(quark));
    laws.flat_map(|quark| quark.args.iter().filter_map(file)).collect()
}

/// Returns the name of the file that an argument names; `None` for an argument that is not a file.
fn file(argument: &Value) -> Option<&str> {
    match argument {
        Value::Name(ParameterKind::File, name) => Some(name),
        Value::Name(..)
        | Value::Quantity { .. }
        | Value::Infinity(_)
        | Value::Bits(_)
        | Value::Integer(_)
        | Value::Sonar(_) => None,
    }
}

/// Returns the nearest enclosing element whose condition can fire; the element itself if there is no such element.
fn around(element: Element<'_>) -> Element<'_> {
    let can_fire = |enclosing: &Element<'_>| *enclosing.condition() != Condition::Null;
    element.outwards().skip(1).find(can_fire).unwrap_or(element)
}

/// Returns the labels of the elements that end with each bracket, and the facts of these labels.
fn marks(machine: &Machine) -> (Vec<MarkRow>, Vec<Fact>) {
    let (mut marks, mut facts) = (Vec::new(), Vec::new());
    for element in machine.elements() {
        for mark in element.marks() {
            let Some(record) = machine.record(mark.record) else { continue };
            let row = MarkRow {
                bracket: element.number(),
                level: record.level,
                first: record.first,
                count: record.facts,
                first_fact: number(facts.len()),
                facts: number(mark.facts.len()),
            };
            marks.push(row);
            facts.extend(
                mark.facts
                    .iter()
                    .map(|fact| Fact { memory: record.first.saturating_add(fact.number), operand: fact.operand }),
            );
        }
    }
    (marks, facts)
}

/// Operands of conditions that already have a number, but no row yet.
struct Operands<'m> {
    machine: &'m Machine,
    waiting: VecDeque<&'m Condition>,
    /// Number of operands that have been numbered so far.
    count: u32,
}

impl<'m> Operands<'m> {
    /// Returns the row of a condition, and numbers its operands.
    fn row(&mut self, condition: &'m Condition) -> Row<QuarkId> {
        if let Some((quark, nanos)) = condition.lasting() {
            return Row::Lasting(quark, Nanos(nanos));
        }
        match condition {
            Condition::Null => Row::Null,
            Condition::Quark(id) => Row::Quark(*id),
            Condition::Wait { nanos, .. } => Row::Wait(Nanos(*nanos)),
            Condition::Elapsed { from, until, .. } => Row::Elapsed(Nanos(*from), Nanos(until.unwrap_or(u64::MAX))),
            Condition::Driven { from, until, .. } => {
                Row::Driven(Nanometers(*from), Nanometers(until.unwrap_or(u64::MAX)))
            }
            Condition::Or(operands) => {
                let (first, count) = self.numbered(operands);
                Row::Or(first, count)
            }
            Condition::And(operands) => {
                let (first, count) = self.numbered(operands);
                Row::And(first, count)
            }
            Condition::Not(operand) => Row::Not(self.numbered([&**operand]).0),
            Condition::Rising { memory, operand } => Row::Rising(*memory, self.numbered([&**operand]).0),
            Condition::After(after) => match self.machine.record(after.record) {
                Some(record) => Row::After(record.level, record.first.saturating_add(after.fact)),
                None => Row::Null,
            },
        }
    }

    /// Numbers operands consecutively; returns the first number, and the number of operands.
    fn numbered(&mut self, operands: impl IntoIterator<Item = &'m Condition>) -> (u32, u32) {
        let (first, waiting) = (self.count, self.waiting.len());
        self.waiting.extend(operands);
        let count = number(self.waiting.len() - waiting);
        self.count = first.saturating_add(count);
        (first, count)
    }

    /// Returns the rows of all numbered conditions, in the order of their numbers.
    fn rows(mut self) -> Vec<Row<QuarkId>> {
        let mut rows = Vec::new();
        while let Some(operand) = self.waiting.pop_front() {
            rows.push(self.row(operand));
        }
        rows
    }
}

fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}
