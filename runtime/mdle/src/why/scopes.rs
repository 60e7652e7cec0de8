//! The scopes that enclose an atom at a moment, with their conditions.

use mdle_runtime::{Cause, Nanos};

use super::operands::{Examination, OperandFacts, examination};
use crate::examined::{ExaminedPlan, PlanMoment, ScopeMoment};

/// Role of a scope at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ScopeRole {
    /// The scope's interrupt has fired and ended it.
    Ended,
    /// The scope belongs to an atom whose law has completed, which ended the scope.
    Completed,
    /// The scope's interrupt has fired too, but an enclosing scope ended first.
    Shadowed,
    /// The scope's interrupt has not fired.
    Waits,
    /// The element has no interrupt that can fire.
    NoInterrupt,
    /// The element's interrupt was removed, because an enclosing scope has the same interrupt.
    Removed,
}

/// State of a scope at a moment of a turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ScopeState {
    /// Name of the scope; `None` for an atom and for a scope without a name.
    pub(crate) name: Option<String>,
    /// `true` if the scope is an atom's own scope.
    pub(crate) is_atom: bool,
    /// File and line of the scope.
    pub(crate) line: String,
    /// Condition of the scope as written; empty if there is no condition.
    pub(crate) condition: String,
    /// Time since the scope was entered.
    pub(crate) since: Nanos,
    /// Role of the scope at this moment.
    pub(crate) part: ScopeRole,
    /// Examination of the scope's condition.
    pub(crate) examination: Examination,
    /// Law of the atom that would follow if the scope ended; `None` if the plan would then be over.
    pub(crate) leads_to: Option<String>,
}

/// Returns the scopes that enclose the atom at a moment, with their conditions explained.
pub(crate) fn scopes(plan: &ExaminedPlan, moment: &PlanMoment, facts: &OperandFacts) -> Vec<ScopeState> {
    moment.scopes.iter().map(|around| scope(plan, moment, around, facts)).collect()
}

fn scope(plan: &ExaminedPlan, moment: &PlanMoment, scope: &ScopeMoment, facts: &OperandFacts) -> ScopeState {
    let ExaminedPlan { machine, texts } = plan;
    let element = machine.element(scope.bracket);
    let words = texts.source();
    let bracket = words.bracket(scope.bracket);
    let mut examination = examination(machine, element, scope, facts, words);
    let is_removed = element.interrupt().is_some_and(|interrupt| interrupt.removed);
    let is_cause = moment.cause.is_some_and(|cause| cause.level() == scope.level);
    let part = match moment.cause {
        Some(Cause::Completed(_)) if is_cause => ScopeRole::Completed,
        Some(Cause::Fired(_)) if is_cause => ScopeRole::Ended,
        _ if is_removed => ScopeRole::Removed,
        _ if examination.operands.is_empty() => ScopeRole::NoInterrupt,
        Some(_) if examination.fired => ScopeRole::Shadowed,
        Some(_) | None => ScopeRole::Waits,
    };
    if part != ScopeRole::Ended {
        examination.operands.iter_mut().for_each(|operand| operand.decided = false);
    }
    let removed = element.interrupt().filter(|_| is_removed).map(|interrupt| interrupt.text.clone());
    let condition = bracket.map_or_else(String::new, |words| words.condition.to_owned());
    ScopeState {
        name: Some(texts.name(scope.bracket)).filter(|name| !name.is_empty()).map(str::to_owned),
        is_atom: element.atom().is_some(),
        line: bracket.map_or_else(String::new, |words| format!("{}:{}", words_file(&**texts, words.at), words.at.line)),
        condition: removed.unwrap_or(condition),
        since: scope.since,
        part,
        examination,
        leads_to: scope.leads_to.map(|atom| texts.law(atom).to_owned()),
    }
}

fn words_file(plan: &dyn mdle_host::Texts, at: mdle_runtime::SourceLine) -> &str {
    plan.source().file(at)
}
