//! Determines the operands that can end a scope, and the scopes that are always skipped, from facts that are known when
//! the scope is entered.

use std::collections::{BTreeMap, BTreeSet};

use super::choices::When;
use super::known::ConditionQuestion;
use super::variables::Variable;
use super::walk::{AnalysisWalk, BracketFacts, OperandOutcome, Reach, Skip};
use crate::plan::Condition;

impl<'l> AnalysisWalk<'l> {
    /// Determines the operands that can end a scope; returns the earliest time at which the scope can end, `None` if
    /// the scope is never reached or never ends by itself.
    pub(super) fn judge(&mut self, number: u32, found: &mut BracketFacts) -> Option<u64> {
        let clock = self.clock?;
        let condition = self.element(number).condition();
        // If a search may reach the limit of a turn, the conditions of the element at which it stops are read again in
        // the next turn.
        let when = if self.one_turn { When::Entered } else { When::Later };
        let none = ConditionQuestion { any: vec![self.read(condition, number, when)], fired: false };
        let just = ConditionQuestion { any: self.facts.clone(), fired: true };
        let fixed = BTreeMap::new();
        let behind = just.any.first().map(|read| read.bracket);
        if !self.world.stays(number, condition, when) {
            found.skipped = Some(Skip::AtOnce);
        } else if let Some(behind) = behind.filter(|_| !self.world.is_possible(&[none, just.clone()], &fixed)) {
            found.skipped = Some(Skip::Behind(behind));
        }
        if found.skipped.is_some() {
            found.reach = Reach::Skipped;
            let operands = condition.operands().iter();
            let asked = operands.map(|operand| {
                let fired = ConditionQuestion { any: vec![self.read(operand, number, when)], fired: true };
                let asked = if just.any.is_empty() { vec![fired] } else { vec![fired, just.clone()] };
                if self.world.is_possible(&asked, &fixed) { OperandOutcome::Possible } else { OperandOutcome::Never }
            });
            found.operands = asked.collect();
            return Some(clock);
        }
        found.completes = self.element(number).completes();
        let mut earliest = found.completes.then_some(clock);
        for (operand, outcome) in condition.operands().iter().zip(&mut found.operands) {
            match self.earliest(operand, number) {
                Some(nanos) => {
                    *outcome = OperandOutcome::Possible;
                    let at = clock.saturating_add(nanos);
                    earliest = Some(earliest.map_or(at, |earliest| earliest.min(at)));
                }
                None => *outcome = self.blame(operand, number),
            }
        }
        earliest
    }

    /// Returns the earliest time in nanoseconds after which an operand can end its scope; `None` if it cannot end the
    /// scope.
    fn earliest(&self, operand: &'l Condition, number: u32) -> Option<u64> {
        /// Maximum number of timers in an operand that are examined: the operand is checked for each number of timers
        /// that have already ended. An operand with more timers is treated as possible at any time if it is possible at
        /// all.
        const TIMERS: usize = 8;
        let asked = [ConditionQuestion { any: vec![self.read(operand, number, When::Later)], fired: true }];
        let mut variables = BTreeSet::new();
        let fits = self.world.variables(asked[0].any[0], &mut variables);
        let timers: Vec<(Variable, u64)> = variables
            .into_iter()
            .filter_map(|variable| match variable {
                Variable::Timer(_, nanos) if nanos > 0 => Some((variable, nanos)),
                Variable::Timer(..) | Variable::Past(..) | Variable::Memory(..) => None,
                Variable::Way(..) | Variable::PastWay(..) => None,
                Variable::Quark(_) | Variable::Own(..) | Variable::Fact(..) | Variable::PastFact(..) => None,
            })
            .collect();
        if !fits || timers.len() > TIMERS {
            return self.world.is_possible(&asked, &BTreeMap::new()).then_some(0);
        }
        // The timers of a scope are sorted by their lengths.
        let over = (0..=timers.len()).find(|over| {
            let fixed = timers.iter().enumerate().map(|(place, (timer, _))| (*timer, place < *over)).collect();
            self.world.is_possible(&asked, &fixed)
        });
        over.map(|over| over.checked_sub(1).map_or(0, |last| timers[last].1))
    }

    /// Returns the reason why an operand cannot end its scope; `number` is the number of the scope's bracket.
    fn blame(&self, operand: &'l Condition, number: u32) -> OperandOutcome {
        let read = self.read(operand, number, When::Later);
        if let Condition::Wait { quark, .. } = operand
            && let Some(outer) = self.waits.get(quark).and_then(|brackets| brackets.first())
        {
            return OperandOutcome::Repeated(*outer);
        }
        if let Condition::Driven { from, until: None, .. } = operand
            && let Some((_, outer)) = self.world.distance(number).filter(|(shortest, _)| shortest == from)
        {
            return OperandOutcome::Repeated(outer);
        }
        if !self.alone.is_possible(&[ConditionQuestion { any: vec![read], fired: true }], &BTreeMap::new()) {
            return OperandOutcome::Never;
        }
        let mut variables = BTreeSet::new();
        self.world.variables(read, &mut variables);
        let single = (variables.len() == 1).then(|| variables.first().copied()).flatten();
        if let Some(outer) = single.and_then(|variable| self.world.unit(variable)) {
            return OperandOutcome::Repeated(outer);
        }
        let late = self.world.deadline().map(|(_, bracket)| bracket);
        match (self.world.around(&variables), late) {
            (None, Some(late)) => OperandOutcome::Late(late),
            (Some(outer), _) => OperandOutcome::Beaten(outer),
            (None, None) => OperandOutcome::Never,
        }
    }
}
