//! Enumerates the choices of some variables. A choice assigns a value to each variable. For a condition, determines the
//! choices in which it has fired.

use std::collections::{BTreeMap, BTreeSet};

use super::tables::{TruthTable, VARIABLES};
use super::variables::Variable;
use crate::fsm::Machine;
use crate::plan::{After, Condition};

/// Turn in which a condition is evaluated, relative to the condition's scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum When {
    /// The turn in which the condition's scope is entered.
    Entered,
    /// Any turn of the condition's scope.
    Later,
    /// The turn in which the condition's scope has just ended.
    Past,
}

/// A condition that is evaluated in the scope of a bracket.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScopedCondition<'l> {
    pub(super) condition: &'l Condition,
    pub(super) bracket: u32,
    pub(super) when: When,
}

/// All choices of values for some variables. Each variable has a table with its value in every choice.
#[derive(Debug)]
pub(super) struct Choices {
    free: usize,
    columns: BTreeMap<Variable, TruthTable>,
}

impl Choices {
    /// Enumerates the choices of the variables in `all`. `value` returns the value of a variable that can have only one
    /// value, and `None` for a variable that can have both values. Returns `None` if too many variables can have both
    /// values.
    pub(super) fn new(all: &BTreeSet<Variable>, value: impl Fn(&Variable) -> Option<bool>) -> Option<Self> {
        let free = all.iter().filter(|variable| value(variable).is_none()).count();
        if free > VARIABLES {
            return None;
        }
        let mut index = 0..free;
        let columns = all.iter().map(|variable| {
            let column = match value(variable) {
                Some(value) => TruthTable::constant(free, value),
                None => TruthTable::variable(free, index.next().unwrap_or(0)),
            };
            (*variable, column)
        });
        Some(Self { free, columns: columns.collect() })
    }

    /// Returns the table that contains `value` for every choice.
    pub(super) fn constant(&self, value: bool) -> TruthTable {
        TruthTable::constant(self.free, value)
    }

    /// Returns each variable, with the table of the choices in which it is true.
    pub(super) fn columns(&self) -> impl Iterator<Item = (&Variable, &TruthTable)> {
        self.columns.iter()
    }

    /// Returns the table of the choices in which a condition has fired. A variable that was not enumerated is treated
    /// as false.
    pub(super) fn fired(&self, read: ScopedCondition<'_>, machine: &Machine) -> TruthTable {
        let ScopedCondition { condition, bracket, when } = read;
        let column = |variable| self.columns.get(&variable).cloned().unwrap_or_else(|| self.constant(false));
        let timer = |nanos: u64| match when {
            When::Entered => self.constant(nanos == 0),
            When::Later => column(Variable::Timer(bracket, nanos)),
            When::Past => column(Variable::Past(bracket, nanos)),
        };
        let way = |nanometers: u64| match when {
            When::Entered => self.constant(nanometers == 0),
            When::Later => column(Variable::Way(bracket, nanometers)),
            When::Past => column(Variable::PastWay(bracket, nanometers)),
        };
        let inside = |operand| self.fired(ScopedCondition { condition: operand, ..read }, machine);
        match condition {
            Condition::Null => self.constant(false),
            Condition::Quark(id) if machine.quark(*id).remembers => column(Variable::Own(bracket, *id)),
            Condition::Quark(id) => column(Variable::Quark(*id)),
            Condition::Wait { nanos, .. } => timer(*nanos),
            Condition::Elapsed { from, until, .. } => match until {
                Some(until) => timer(*from).and(&timer(*until).not()),
                None => timer(*from),
            },
            Condition::Driven { from, until, .. } => match until {
                Some(until) => way(*from).and(&way(*until).not()),
                None => way(*from),
            },
            Condition::Or(operands) => {
                operands.iter().fold(self.constant(false), |all, operand| all.or(&inside(operand)))
            }
            Condition::And(operands) => {
                operands.iter().fold(self.constant(true), |all, operand| all.and(&inside(operand)))
            }
            Condition::Not(operand) => inside(operand).not(),
            // RISING never fires in the turn in which its scope is entered.
            Condition::Rising { .. } if when == When::Entered => self.constant(false),
            Condition::Rising { memory, operand } => column(Variable::Memory(bracket, *memory)).and(&inside(operand)),
            Condition::After(after) => column(fact(after, when)),
        }
    }
}

/// Collects the variables of a condition in `found`; returns `false` if there are too many.
pub(super) fn variables(read: ScopedCondition<'_>, machine: &Machine, found: &mut BTreeSet<Variable>) -> bool {
    /// Maximum number of variables. It is greater than the number that can be enumerated, because some variables may
    /// have only one possible value.
    const MOST: usize = 4 * VARIABLES;
    let ScopedCondition { condition, bracket, when } = read;
    let timer = |nanos| match when {
        When::Entered | When::Later => Variable::Timer(bracket, nanos),
        When::Past => Variable::Past(bracket, nanos),
    };
    let way = |nanometers| match when {
        When::Entered | When::Later => Variable::Way(bracket, nanometers),
        When::Past => Variable::PastWay(bracket, nanometers),
    };
    let mut inside = |operand| variables(ScopedCondition { condition: operand, ..read }, machine, found);
    match condition {
        Condition::Null => return true,
        Condition::Or(operands) | Condition::And(operands) => return operands.iter().all(inside),
        Condition::Not(operand) => return inside(operand),
        Condition::Rising { memory, operand } => {
            if !inside(operand) {
                return false;
            }
            found.insert(Variable::Memory(bracket, *memory));
        }
        Condition::Quark(id) => {
            let remembers = machine.quark(*id).remembers;
            found.insert(if remembers { Variable::Own(bracket, *id) } else { Variable::Quark(*id) });
        }
        Condition::Wait { nanos, .. } => drop(found.insert(timer(*nanos))),
        Condition::Elapsed { from, until, .. } => {
            found.insert(timer(*from));
            found.extend(until.map(timer));
        }
        Condition::Driven { from, until, .. } => {
            found.insert(way(*from));
            found.extend(until.map(way));
        }
        Condition::After(after) => drop(found.insert(fact(after, when))),
    }
    found.len() <= MOST
}

/// Returns the variable for the fact that `after` tests: its current value, or its value before an element ended.
fn fact(after: &After, when: When) -> Variable {
    match when {
        When::Entered | When::Later => Variable::Fact(after.record, after.fact),
        When::Past => Variable::PastFact(after.record, after.fact),
    }
}
