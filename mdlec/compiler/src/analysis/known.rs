//! Facts that are known where a condition is read: no interrupt of an enclosing scope has fired, because these
//! interrupts are read first (docs/src/reference/semantics.md, 5.2).
//!
//! "Impossible" holds for every run; "possible" may also mean that the question was too large to decide.

use std::collections::{BTreeMap, BTreeSet};

use super::choices::{self, Choices, ScopedCondition, When};
use super::facts::PossibleFacts;
use super::possible::possible;
use super::tables::VARIABLES;
use super::variables::Variable;
use crate::fsm::Machine;
use crate::plan::families::{Family, Readings, family};
use crate::plan::{Condition, QuarkId};

/// Maximum number of conditions that are considered for each variable of a question. These are conditions of enclosing
/// scopes.
const CLAUSES: usize = 8;

/// A question about conditions: is it possible that at least one of the conditions has fired (if `fired` is `true`), or
/// that no condition has fired (if `fired` is `false`)?
#[derive(Debug, Clone)]
pub(super) struct ConditionQuestion<'l> {
    pub(super) any: Vec<ScopedCondition<'l>>,
    pub(super) fired: bool,
}

/// Facts that are known at a position in a plan.
#[derive(Debug)]
pub(super) struct KnownFacts<'l> {
    pub(super) machine: &'l Machine,
    /// Earliest time at which the scope of each bracket is entered, in nanoseconds since the plan began.
    pub(super) entered: Vec<u64>,
    /// Variables that can have only one value, because with the other value an enclosing scope would have ended. Each
    /// has its value and the bracket of that scope.
    units: BTreeMap<Variable, (bool, u32)>,
    /// Times at which the timers of enclosing scopes end if each scope is entered at its time in `entered`. Each has
    /// the bracket of its scope; the order is descending.
    deadlines: Vec<(u64, u32)>,
    /// Lengths of the driven path, in nanometres, at which enclosing scopes end. Each has the bracket of its scope; the
    /// order is descending.
    distances: Vec<(u64, u32)>,
    /// Other conditions of enclosing scopes that have not fired, listed for each variable that they contain.
    clauses: BTreeMap<Variable, Vec<ScopedCondition<'l>>>,
    families: BTreeMap<Family<'l>, BTreeSet<QuarkId>>,
    /// Facts that `after` can find in a record.
    recorded: PossibleFacts,
    readings: Readings,
}

/// Facts that become known inside a scope, because the scope has not ended.
#[derive(Debug, Default)]
pub(super) struct Assumptions {
    units: Vec<Variable>,
    clauses: Vec<Variable>,
    deadline: bool,
    distance: bool,
}

impl<'l> KnownFacts<'l> {
    pub(super) fn new(machine: &'l Machine, recorded: &PossibleFacts) -> Self {
        Self {
            machine,
            recorded: recorded.clone(),
            entered: vec![0; machine.elements().len()],
            units: BTreeMap::new(),
            deadlines: Vec::new(),
            distances: Vec::new(),
            clauses: BTreeMap::new(),
            families: BTreeMap::new(),
            readings: Readings::Any,
        }
    }

    /// Returns the facts that are known without enclosing scopes, assuming that no signal is NaN.
    pub(super) fn of_numbers(machine: &'l Machine) -> Self {
        Self { readings: Readings::Numbers, ..Self::new(machine, &PossibleFacts::Any) }
    }

    /// Returns the earliest time at which a timer of an enclosing scope ends, and the bracket of this scope; `None` if
    /// there is no such timer.
    pub(super) fn deadline(&self) -> Option<(u64, u32)> {
        self.deadlines.last().copied()
    }

    /// Returns the bracket of the enclosing scope that restricts a variable to one value; `None` if there is no such
    /// scope.
    pub(super) fn unit(&self, variable: Variable) -> Option<u32> {
        self.units.get(&variable).map(|(_, bracket)| *bracket)
    }

    /// Returns the shortest length of path, in nanometres, at which the scope of `bracket` or an enclosing scope ends,
    /// and the bracket of the scope that ends; `None` if there is no such length.
    pub(super) fn distance(&self, bracket: u32) -> Option<(u64, u32)> {
        self.distances.iter().rev().find(|(_, outer)| *outer <= bracket).copied()
    }

    /// Returns the bracket of an enclosing scope whose condition restricts the values of these variables; `None` if
    /// there is no such scope.
    pub(super) fn around(&self, variables: &BTreeSet<Variable>) -> Option<u32> {
        let unit = variables.iter().find_map(|variable| self.unit(*variable));
        let relative = || self.relatives(variables).iter().find_map(|variable| self.unit(*variable));
        let clause = || variables.iter().find_map(|variable| Some(self.clauses.get(variable)?.first()?.bracket));
        let distance = || {
            variables.iter().find_map(|variable| match variable {
                Variable::Way(bracket, _) => self.distance(*bracket).map(|(_, outer)| outer),
                Variable::Quark(_) | Variable::Own(..) | Variable::Timer(..) | Variable::Past(..) => None,
                Variable::PastWay(..) | Variable::Memory(..) | Variable::Fact(..) | Variable::PastFact(..) => None,
            })
        };
        unit.or_else(clause).or_else(relative).or_else(distance)
    }

    /// Adds the facts that follow from the assumption that the interrupt of this bracket has not fired. Returns the
    /// added facts, which `close` has to remove.
    pub(super) fn open(&mut self, bracket: u32, condition: &'l Condition) -> Assumptions {
        let mut added = Assumptions::default();
        for condition in flat(condition) {
            let read = ScopedCondition { condition, bracket, when: When::Later };
            if let Condition::Driven { from, until: None, .. } = condition {
                self.add_distance(*from, bracket, &mut added);
                continue;
            }
            match self.unit_of(read) {
                Some((Variable::Timer(_, nanos), false)) => {
                    let at = self.entered[bracket as usize].saturating_add(nanos);
                    if self.deadline().is_none_or(|(first, _)| at < first) {
                        self.deadlines.push((at, bracket));
                        added.deadline = true;
                    }
                }
                Some((variable, value)) => {
                    if let std::collections::btree_map::Entry::Vacant(place) = self.units.entry(variable) {
                        place.insert((value, bracket));
                        added.units.push(variable);
                        self.relate(variable, true);
                    }
                }
                None => self.add_clause(read, &mut added),
            }
        }
        // If a scope has several timers, only the shortest is its deadline.
        if added.deadline {
            while let [.., before, last] = self.deadlines.as_slice()
                && before.1 == last.1
            {
                let last = *last;
                self.deadlines.truncate(self.deadlines.len() - 2);
                self.deadlines.push(last);
            }
        }
        added
    }

    /// Removes the facts that `open` added for a scope.
    pub(super) fn close(&mut self, added: Assumptions) {
        for variable in added.units {
            self.units.remove(&variable);
            self.relate(variable, false);
        }
        for variable in added.clauses {
            self.clauses.entry(variable).or_default().pop();
        }
        if added.deadline {
            self.deadlines.pop();
        }
        if added.distance {
            self.distances.pop();
        }
    }

    /// Records that the scope of this bracket ends after a path of `nanometers`.
    fn add_distance(&mut self, nanometers: u64, bracket: u32, added: &mut Assumptions) {
        match self.distances.last_mut() {
            Some((shortest, _)) if *shortest <= nanometers => {}
            Some((shortest, owner)) if *owner == bracket => *shortest = nanometers,
            Some(_) | None => {
                self.distances.push((nanometers, bracket));
                added.distance = true;
            }
        }
    }

    fn relate(&mut self, variable: Variable, is_known: bool) {
        let Variable::Quark(id) = variable else { return };
        let Some(family) = family(self.machine.quark(id)) else { return };
        let members = self.families.entry(family).or_default();
        if is_known {
            members.insert(id);
        } else {
            members.remove(&id);
        }
    }

    /// Returns the quarks with known values that belong to the same families as the quarks in `variables`.
    fn relatives(&self, variables: &BTreeSet<Variable>) -> Vec<Variable> {
        let mut found = Vec::new();
        for variable in variables {
            let Variable::Quark(id) = variable else { continue };
            let members = family(self.machine.quark(*id)).and_then(|family| self.families.get(&family));
            found.extend(members.into_iter().flatten().take(CLAUSES).map(|id| Variable::Quark(*id)));
        }
        found
    }

    fn add_clause(&mut self, read: ScopedCondition<'l>, added: &mut Assumptions) {
        let mut variables = BTreeSet::new();
        if !self.variables(read, &mut variables) {
            return;
        }
        for variable in variables {
            // Timers and paths do not index conditions, because nearly every scope has one; the other variables find
            // the conditions.
            if !matches!(variable, Variable::Timer(..) | Variable::Way(..)) {
                self.clauses.entry(variable).or_default().push(read);
                added.clauses.push(variable);
            }
        }
    }

    /// Returns the only variable of a condition, and the value with which the condition has not fired. Returns `None`
    /// unless the condition is a single quark, `wait` or `after`, or the negation of one of these.
    fn unit_of(&self, read: ScopedCondition<'l>) -> Option<(Variable, bool)> {
        let leaf = |condition: &'l Condition| {
            let mut variables = BTreeSet::new();
            let is_leaf = matches!(condition, Condition::Quark(_) | Condition::Wait { .. } | Condition::After(_));
            let read = ScopedCondition { condition, ..read };
            (is_leaf && self.variables(read, &mut variables)).then(|| variables.pop_first()).flatten()
        };
        if let Condition::Not(operand) = read.condition {
            return leaf(operand).map(|variable| (variable, true));
        }
        leaf(read.condition).map(|variable| (variable, false))
    }

    /// Collects all variables of a condition in `found`, whether their values are known or not. Returns `false` if
    /// there are too many variables.
    pub(super) fn variables(&self, read: ScopedCondition<'l>, found: &mut BTreeSet<Variable>) -> bool {
        choices::variables(read, self.machine, found)
    }

    /// Returns the value of a variable at this position; `None` if both values may be possible.
    fn known(&self, variable: Variable) -> Option<bool> {
        if let Variable::Way(bracket, nanometers) = variable {
            // The path since the entry of an outer scope is at least as long.
            let is_beyond = || self.distance(bracket).is_some_and(|(shortest, _)| nanometers >= shortest);
            return if nanometers == 0 { Some(true) } else { is_beyond().then_some(false) };
        }
        if let Variable::Fact(record, fact) | Variable::PastFact(record, fact) = variable
            && !self.recorded.has(record, fact)
        {
            return Some(false);
        }
        let Variable::Timer(bracket, nanos) = variable else {
            return self.units.get(&variable).map(|(value, _)| *value);
        };
        let at = self.entered[bracket as usize].saturating_add(nanos);
        match self.deadline() {
            _ if nanos == 0 => Some(true),
            // The timer of `wait inf` never ends.
            _ if nanos == u64::MAX => Some(false),
            Some((deadline, _)) if at >= deadline => Some(false),
            Some(_) | None => None,
        }
    }

    /// Returns `true` if the answers to all questions in `wanted` can be yes in the same turn. `fixed` contains
    /// variables whose values are assumed.
    pub(super) fn is_possible(&self, wanted: &[ConditionQuestion<'l>], fixed: &BTreeMap<Variable, bool>) -> bool {
        let mut variables = BTreeSet::new();
        let reads = wanted.iter().flat_map(|wanted| &wanted.any);
        if !reads.into_iter().all(|read| self.variables(*read, &mut variables)) {
            return true;
        }
        if fixed.iter().any(|(variable, value)| self.known(*variable).is_some_and(|known| known != *value)) {
            return false;
        }
        let value = |variable: &Variable| fixed.get(variable).copied().or_else(|| self.known(*variable));
        let mut all = variables.clone();
        all.extend(self.relatives(&variables));
        // Conditions of enclosing scopes may be left out, because this only makes more choices possible. The conditions
        // in `wanted` may not be left out.
        let clauses = self.clauses(&mut all, &value);
        let (choices, clauses) = match (Choices::new(&all, value), Choices::new(&variables, value)) {
            (Some(choices), _) => (choices, clauses),
            (None, Some(choices)) => (choices, Vec::new()),
            (None, None) => return true,
        };
        let entered = |bracket: u32| self.entered[bracket as usize];
        let mut table = possible(&choices, self.machine.quarks(), self.readings, &entered);
        for read in clauses {
            table = table.and(&choices.fired(read, self.machine).not());
        }
        for ConditionQuestion { any, fired } in wanted {
            let none = choices.constant(false);
            let some = any.iter().fold(none, |some, read| some.or(&choices.fired(*read, self.machine)));
            table = table.and(&if *fired { some } else { some.not() });
        }
        table.is_possible()
    }

    /// Returns `true` if it is possible that the interrupt of this bracket has not fired.
    pub(super) fn stays(&self, bracket: u32, condition: &'l Condition, when: When) -> bool {
        let not = |condition| {
            let any = vec![ScopedCondition { condition, bracket, when }];
            self.is_possible(&[ConditionQuestion { any, fired: false }], &BTreeMap::new())
        };
        // If the OR is too long to be examined, each of its operands may still be short enough.
        let operands = condition.operands();
        operands.iter().all(not) && (operands.len() == 1 || not(condition))
    }

    /// Returns conditions of enclosing scopes that have not fired and that share variables with `all`. Adds their
    /// variables to `all`, and stops when there would be too many free variables.
    fn clauses(
        &self,
        all: &mut BTreeSet<Variable>,
        value: &impl Fn(&Variable) -> Option<bool>,
    ) -> Vec<ScopedCondition<'l>> {
        let free = |all: &BTreeSet<Variable>| all.iter().filter(|variable| value(variable).is_none()).count();
        let related: Vec<ScopedCondition<'l>> = all
            .iter()
            .filter_map(|variable| self.clauses.get(variable))
            .flat_map(|clauses| clauses.iter().take(CLAUSES).copied())
            .collect();
        let mut taken: Vec<ScopedCondition<'l>> = Vec::new();
        for read in related {
            let mut with = all.clone();
            let is_new = taken.iter().all(|other| !std::ptr::eq(other.condition, read.condition));
            if is_new && self.variables(read, &mut with) && free(&with) <= VARIABLES {
                *all = with;
                taken.push(read);
            }
        }
        taken
    }
}

/// Returns the operands of an OR, including the operands of nested ORs.
fn flat(condition: &Condition) -> Vec<&Condition> {
    let (mut waiting, mut operands) = (vec![condition], Vec::new());
    while let Some(condition) = waiting.pop() {
        if let Condition::Or(inside) = condition {
            waiting.extend(inside.iter().rev());
        } else {
            operands.push(condition);
        }
    }
    operands
}
