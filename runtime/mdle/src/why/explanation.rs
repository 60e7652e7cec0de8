//! The explanation of a turn: what ended, what was skipped, what ran, and what every scope waited for.

use mdle_compiler::fsm::Machine;
use mdle_host::{CauseText, Operand, Passes, Texts, place};
use mdle_runtime::{Cause, Nanos, SONARS, Sensed, Transition, Turn, Twist};

use super::operands::{Examination, Facts, examination};
use crate::rerun::RerunTurn;
use crate::rerun::{Moment, ScopeMoment};

/// An atom in a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct AtomWords {
    /// The quark text of its law.
    pub(crate) law: String,
    /// Its line, the names of its enclosing scopes and the passes of loops.
    pub(crate) place: String,
}

/// Part of a scope in what happened at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// Its interrupt has fired, and ended it.
    Ended,
    /// Its law is done, which ended it: an atom.
    Completed,
    /// Its interrupt has fired as well, and an enclosing scope ended first.
    Shadowed,
    /// Its interrupt has not fired.
    Waits,
    /// It has no interrupt that can fire.
    NoInterrupt,
    /// Its interrupt was removed, because an enclosing scope has the same one.
    Removed,
}

/// A scope at a moment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scope {
    /// Name of the scope; `None` for an atom and for a scope without a name.
    pub(crate) name: Option<String>,
    /// `true` if it is the scope of the atom alone.
    pub(crate) is_atom: bool,
    /// File and line.
    pub(crate) line: String,
    /// The condition as it is written; empty if there is none.
    pub(crate) condition: String,
    /// Time since the scope was entered.
    pub(crate) since: Nanos,
    /// Its part in what happened.
    pub(crate) part: Part,
    /// Its condition.
    pub(crate) examination: Examination,
    /// The law of the atom that would follow; `None` if the plan would be over.
    pub(crate) leads_to: Option<String>,
}

/// A transition.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ended {
    /// The atom that was left.
    pub(crate) atom: AtomWords,
    /// `true` if it was entered in the same turn, so that its law was never applied.
    pub(crate) is_skipped: bool,
    /// The cause, with its values and its place.
    pub(crate) cause: String,
    /// `true` if the law of the atom was done as well, though an interrupt ended its scope.
    pub(crate) was_done: bool,
    /// The scopes around the atom, the plan first.
    pub(crate) scopes: Vec<Scope>,
    /// The atom that was entered; `None` if the plan is over.
    pub(crate) to: Option<AtomWords>,
}

/// The atom whose law was applied.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Runs {
    /// The atom.
    pub(crate) atom: AtomWords,
    /// Time since it was entered.
    pub(crate) since: Nanos,
    /// Cause of the transition to it; empty for the first atom of the plan.
    pub(crate) began: String,
    /// `true` if its law completes.
    pub(crate) completes: bool,
    /// The scopes around it, the plan first.
    pub(crate) scopes: Vec<Scope>,
}

/// The explanation of a turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Explanation {
    /// Number of the turn, from 0.
    pub(crate) turn: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// The transitions of the turn.
    pub(crate) ended: Vec<Ended>,
    /// The atom whose law was applied; `None` if the plan is over.
    pub(crate) runs: Option<Runs>,
    /// `true` if the turn had too many transitions, so that no law was applied.
    pub(crate) is_cut: bool,
    /// Time since the exchange that brought the output.
    pub(crate) output_age: Nanos,
    /// The input that was sent.
    pub(crate) sent: Twist,
    /// The input that the plan computed, where that was looked at.
    pub(crate) computed: Option<Twist>,
}

/// A transition with its cause, its values and its place.
pub(crate) struct Step {
    pub(crate) transition: Transition,
    pub(crate) cause: String,
}

/// Explains turns that were looked at, and follows the loops of all others.
pub(crate) struct Explainer<'m> {
    machine: &'m Machine,
    passes: Passes,
    /// Cause of the last transition.
    began: String,
}

impl<'m> Explainer<'m> {
    pub(crate) fn new(machine: &'m Machine) -> Self {
        Self { machine, passes: Passes::default(), began: String::new() }
    }

    /// Takes a turn that is not explained.
    pub(crate) fn pass(&mut self, turn: &RerunTurn, plan: &dyn Texts) {
        for (transition, operands) in turn.transitions.iter() {
            self.passes.step(plan.fsm(), transition);
            self.began = CauseText { plan, transition, operands }.to_string();
        }
    }

    /// Returns the words of an atom in the current passes of its loops.
    pub(crate) fn atom(&self, plan: &dyn Texts, atom: u32) -> AtomWords {
        AtomWords { law: plan.law(atom).to_owned(), place: place(plan, &self.passes, atom) }
    }

    /// Returns the transitions of a turn and their causes.
    pub(crate) fn each(&self, turn: &RerunTurn, plan: &dyn Texts) -> Vec<Step> {
        let step = |(transition, operands): (&Transition, &[Operand])| Step {
            transition: *transition,
            cause: CauseText { plan, transition, operands }.to_string(),
        };
        turn.transitions.iter().map(step).collect()
    }

    /// Follows the loops through a transition.
    pub(crate) fn step(&mut self, transition: &Transition, plan: &dyn Texts) {
        self.passes.step(plan.fsm(), transition);
    }

    /// Returns the facts that operands read at a moment of a turn.
    pub(crate) fn facts(turn: &RerunTurn, moment: &Moment) -> Facts {
        Facts { ages: ages(&turn.recorded.y), stalled: moment.stalled, is_new: moment.is_new() }
    }

    /// Returns the causes of the transitions of a turn, and the atoms to which they led.
    pub(crate) fn steps(&mut self, turn: &RerunTurn, plan: &dyn Texts) -> Vec<(String, Option<AtomWords>)> {
        let steps = turn.transitions.iter().map(|(transition, operands)| {
            self.passes.step(plan.fsm(), transition);
            let to = transition.atom.map(|atom| self.atom(plan, atom));
            (CauseText { plan, transition, operands }.to_string(), to)
        });
        steps.collect()
    }

    /// Explains a turn that was looked at.
    pub(crate) fn explained(&mut self, turn: &RerunTurn, plan: &dyn Texts, with_laws: bool) -> Explanation {
        let mut ended = Vec::new();
        let mut moments = turn.moments.iter();
        for ((transition, operands), moment) in turn.transitions.iter().zip(moments.by_ref()) {
            let atom = self.atom(plan, moment.atom);
            let scopes = self.scopes(moment, &Self::facts(turn, moment), plan);
            let cause = CauseText { plan, transition, operands }.to_string();
            self.passes.step(plan.fsm(), transition);
            let to = transition.atom.map(|atom| self.atom(plan, atom));
            self.began.clone_from(&cause);
            let (is_skipped, was_done) = (moment.is_new(), was_done(moment, transition));
            ended.push(Ended { atom, is_skipped, cause, was_done, scopes, to });
        }
        let runs = moments.next().map(|moment| Runs {
            atom: self.atom(plan, moment.atom),
            since: moment.scopes.last().map_or(Nanos::ZERO, |own| own.since),
            began: self.began.clone(),
            completes: self.machine.atom(moment.atom).law().completes,
            scopes: self.scopes(moment, &Self::facts(turn, moment), plan),
        });
        let is_cut = matches!(turn.computed, Turn::Cut);
        let computed = (with_laws || is_cut || runs.is_none()).then(|| turn.computed.input());
        let runs = runs.filter(|_| !is_cut);
        let recorded = &turn.recorded;
        let output_age = recorded.t.since(recorded.y.at);
        let (turn, t, sent) = (recorded.number, recorded.t, recorded.sent);
        Explanation { turn, t, ended, runs, is_cut, output_age, sent, computed }
    }

    /// Explains the scopes around the atom of a moment.
    pub(crate) fn scopes(&self, moment: &Moment, facts: &Facts, plan: &dyn Texts) -> Vec<Scope> {
        moment.scopes.iter().map(|scope| self.scope(moment, scope, facts, plan)).collect()
    }

    fn scope(&self, moment: &Moment, scope: &ScopeMoment, facts: &Facts, plan: &dyn Texts) -> Scope {
        let element = self.machine.element(scope.bracket);
        let words = plan.source();
        let bracket = words.bracket(scope.bracket);
        let mut examination = examination(self.machine, element, scope, facts, words);
        let is_removed = element.interrupt().is_some_and(|interrupt| interrupt.removed);
        let is_cause = moment.cause.is_some_and(|cause| cause.level() == scope.level);
        let part = match moment.cause {
            Some(Cause::Completed(_)) if is_cause => Part::Completed,
            Some(Cause::Fired(_)) if is_cause => Part::Ended,
            _ if is_removed => Part::Removed,
            _ if examination.operands.is_empty() => Part::NoInterrupt,
            Some(_) if examination.fired => Part::Shadowed,
            Some(_) | None => Part::Waits,
        };
        if part != Part::Ended {
            examination.operands.iter_mut().for_each(|operand| operand.decided = false);
        }
        let removed = element.interrupt().filter(|_| is_removed).map(|interrupt| interrupt.text.clone());
        let condition = bracket.map_or_else(String::new, |words| words.condition.to_owned());
        Scope {
            name: Some(plan.name(scope.bracket)).filter(|name| !name.is_empty()).map(str::to_owned),
            is_atom: element.atom().is_some(),
            line: bracket.map_or_else(String::new, |words| format!("{}:{}", words_file(plan, words.at), words.at.line)),
            condition: removed.unwrap_or(condition),
            since: scope.since,
            part,
            examination,
            leads_to: scope.leads_to.map(|atom| plan.law(atom).to_owned()),
        }
    }
}

fn words_file(plan: &dyn Texts, at: mdle_runtime::SourceLine) -> &str {
    plan.source().file(at)
}

/// Returns `true` if the law of the atom was done when an interrupt ended its scope, or an enclosing one.
fn was_done(moment: &Moment, transition: &Transition) -> bool {
    moment.is_completed && matches!(transition.cause, Cause::Fired(_))
}

/// Returns the time since each sonar has pinged.
fn ages(y: &Sensed) -> [Option<Nanos>; SONARS] {
    y.pings.map(|pings| pings.newest_first().next().map(|ping| y.at.since(ping.at)))
}
