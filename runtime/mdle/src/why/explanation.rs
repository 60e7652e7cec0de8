//! The explanation of a turn. It lists the scopes that ended, the atoms that were skipped, the atom that ran, and the
//! conditions for which each scope waited.

use std::collections::BTreeMap;

use mdle_host::{CauseText, Operand, Passes, Texts, place};
use mdle_record::Applied;
use mdle_runtime::{Cause, Nanos, SONARS, Sensed, Transition, Twist};

use super::operands::OperandFacts;
use super::scopes::{ScopeState, scopes};
use crate::examined::{ExaminedPlan, ExaminedTurn, PlanMoment};

/// An atom, in the words of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct AtomWords {
    /// Text of the atom's law.
    pub(crate) law: String,
    /// Line of the atom, names of its enclosing scopes, and passes of loops.
    pub(crate) place: String,
}

/// A transition, which ended an atom.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ended {
    /// The atom that was left.
    pub(crate) atom: AtomWords,
    /// `true` if the atom was entered in the same turn; its law was then never applied.
    pub(crate) is_skipped: bool,
    /// Cause of the transition, with its values and its line in the plan.
    pub(crate) cause: String,
    /// `true` if an interrupt ended the scope although the law of the atom had also completed.
    pub(crate) was_done: bool,
    /// Scopes that enclose the atom, from the plan to the atom's own scope.
    pub(crate) scopes: Vec<ScopeState>,
    /// The atom that was entered; `None` if the plan is over.
    pub(crate) to: Option<AtomWords>,
}

/// The atom whose law was applied.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AppliedAtom {
    /// The atom.
    pub(crate) atom: AtomWords,
    /// Time since the atom was entered. The time during which other plans were active is not included.
    pub(crate) since: Nanos,
    /// Time since the atom was entered during which other plans were active.
    pub(crate) paused: Nanos,
    /// Cause of the transition to the atom; empty for the first atom of the plan.
    pub(crate) began: String,
    /// `true` if the atom's law can complete.
    pub(crate) completes: bool,
    /// Scopes that enclose the atom, from the plan to the atom's own scope.
    pub(crate) scopes: Vec<ScopeState>,
}

/// The atom that was running when another plan replaced its plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Replaced {
    /// The atom.
    pub(crate) atom: AtomWords,
    /// Time for which the atom had run.
    pub(crate) since: Nanos,
    /// Reason why the other plan replaced the plan of this atom.
    pub(crate) cause: String,
}

/// The explanation of a turn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Explanation {
    /// Number of the turn, counted from 0.
    pub(crate) turn: u64,
    /// Time of the turn.
    pub(crate) t: Nanos,
    /// The atom of the plan that was replaced in this turn; `None` if no plan was replaced.
    pub(crate) replaced: Option<Replaced>,
    /// The transitions of the turn.
    pub(crate) ended: Vec<Ended>,
    /// The atom whose law was applied; `None` if the plan is over.
    pub(crate) runs: Option<AppliedAtom>,
    /// Reason why the null input was sent instead of the input of a law; `None` if a law was applied, or if the plan is
    /// over.
    pub(crate) cut: Option<&'static str>,
    /// Time since the exchange that brought the output.
    pub(crate) output_age: Nanos,
    /// The input that was sent.
    pub(crate) sent: Twist,
    /// The input that the plan computed; `None` if it was not examined.
    pub(crate) computed: Option<Twist>,
}

/// A transition, with its cause, its values and its line in the plan.
pub(crate) struct ExplainedTransition {
    pub(crate) transition: Transition,
    pub(crate) cause: String,
}

/// Explains turns. For this purpose, it keeps track of the passes of loops in all turns.
#[derive(Debug, Default)]
pub(crate) struct Explainer {
    /// Courses of the plans that have been active, by the plans' numbers. A plan that was suspended continues where it
    /// stopped.
    courses: BTreeMap<u64, PlanCourse>,
    /// Number of the active plan; `None` before the first turn.
    number: Option<u64>,
    /// Number of the plan that was replaced in the last turn; `None` if no plan was replaced.
    replaced: Option<u64>,
}

/// The course of a plan so far.
#[derive(Debug, Default)]
struct PlanCourse {
    /// The current passes of the plan's loops.
    passes: Passes,
    /// Cause of the transition to the current atom; at the beginning of a plan, the reason why it replaced another
    /// plan.
    began: String,
    /// The atom that ran last; `None` before the first atom.
    latest: Option<Latest>,
    /// Time during which other plans were active since the last atom was entered.
    paused: Nanos,
}

/// An atom that ran in a turn.
#[derive(Debug, Clone, Copy)]
struct Latest {
    atom: u32,
    /// Time for which the atom had been running.
    since: Nanos,
    /// Time of the turn.
    t: Nanos,
}

impl Explainer {
    /// Begins a turn. Returns `true` if the plan of this turn has replaced another plan.
    pub(crate) fn begin(&mut self, turn: &ExaminedTurn) -> bool {
        let before = self.number.replace(turn.recorded.plan);
        let is_other = before.is_some_and(|before| before != turn.recorded.plan);
        self.replaced = before.filter(|_| is_other);
        if is_other {
            self.course().began.clone_from(&turn.reason);
        }
        self.note(turn, is_other);
        is_other
    }

    /// Returns the number of the plan that was replaced in the last turn; `None` if no plan was replaced.
    pub(crate) fn replaced(&self) -> Option<u64> {
        self.replaced
    }

    /// Records the atom in which a turn ended, and the time for which the plan of the turn was inactive before.
    fn note(&mut self, turn: &ExaminedTurn, is_other: bool) {
        let t = turn.recorded.t;
        let Some(moment) = turn.moments.last().filter(|last| last.cause.is_none()) else { return };
        let Some(since) = moment.scopes.last().map(|own| own.since) else { return };
        let course = self.course();
        match course.latest {
            Some(latest) if latest.atom == moment.atom && since >= latest.since => {
                if is_other {
                    course.paused.0 += t.since(latest.t).0.saturating_sub(since.since(latest.since).0);
                }
            }
            Some(_) | None => course.paused = Nanos::ZERO,
        }
        course.latest = Some(Latest { atom: moment.atom, since, t });
    }

    /// Returns the atom that ran last in the plan that was replaced in this turn; `None` if no atom had run.
    fn replaced_atom(&mut self, turn: &ExaminedTurn, plan: &ExaminedPlan) -> Option<Replaced> {
        let cause = self.began();
        let now = self.number;
        self.number = self.replaced;
        let latest = self.course().latest;
        let atom = latest.map(|latest| self.atom(&*plan.texts, latest.atom));
        self.number = now;
        let latest = latest?;
        Some(Replaced { atom: atom?, since: Nanos(latest.since.0 + turn.recorded.t.since(latest.t).0), cause })
    }

    /// Continues the course of the plan with this number.
    pub(crate) fn resume(&mut self, number: u64) {
        self.number = Some(number);
    }

    /// Returns the course of the active plan.
    fn course(&mut self) -> &mut PlanCourse {
        self.courses.entry(self.number.unwrap_or_default()).or_default()
    }

    /// Returns the cause of the transition to the current atom; empty for the first atom of the first plan.
    pub(crate) fn began(&mut self) -> String {
        self.course().began.clone()
    }

    /// Keeps track of the transitions of a turn that has begun with [`Explainer::begin`] and is not explained.
    pub(crate) fn pass(&mut self, turn: &ExaminedTurn, plan: &dyn Texts) {
        for (transition, operands) in turn.transitions.iter() {
            let began = CauseText { plan, transition, operands }.to_string();
            let course = self.course();
            course.passes.step(plan.fsm(), transition);
            course.began = began;
        }
    }

    /// Returns an atom in the words of a report, with the current passes of its loops.
    pub(crate) fn atom(&mut self, plan: &dyn Texts, atom: u32) -> AtomWords {
        AtomWords { law: plan.law(atom).to_owned(), place: place(plan, &self.course().passes, atom) }
    }

    /// Returns the transitions of a turn and their causes.
    pub(crate) fn each(turn: &ExaminedTurn, plan: &dyn Texts) -> Vec<ExplainedTransition> {
        let step = |(transition, operands): (&Transition, &[Operand])| ExplainedTransition {
            transition: *transition,
            cause: CauseText { plan, transition, operands }.to_string(),
        };
        turn.transitions.iter().map(step).collect()
    }

    /// Updates the passes of loops for a transition.
    pub(crate) fn step(&mut self, transition: &Transition, plan: &dyn Texts) {
        self.course().passes.step(plan.fsm(), transition);
    }

    /// Returns the facts of a turn that operands read at a moment.
    pub(crate) fn facts(turn: &ExaminedTurn, moment: &PlanMoment) -> OperandFacts {
        OperandFacts { ages: ages(&turn.recorded.y), stalled: moment.stalled, is_new: moment.is_new() }
    }

    /// Returns the causes of the transitions of a turn, and the atoms to which they led.
    pub(crate) fn steps(&mut self, turn: &ExaminedTurn, plan: &dyn Texts) -> Vec<(String, Option<AtomWords>)> {
        let steps = turn.transitions.iter().map(|(transition, operands)| {
            self.step(transition, plan);
            let to = transition.atom.map(|atom| self.atom(plan, atom));
            (CauseText { plan, transition, operands }.to_string(), to)
        });
        steps.collect()
    }

    /// Explains a turn that has begun; `plan` is `None` before the first plan begins.
    pub(crate) fn explained(
        &mut self,
        turn: &ExaminedTurn,
        plan: Option<&ExaminedPlan>,
        replaced: Option<&ExaminedPlan>,
        with_laws: bool,
    ) -> Explanation {
        let cut = cut(turn, plan);
        let replaced = replaced.and_then(|replaced| self.replaced_atom(turn, replaced));
        let (mut ended, mut runs) = (Vec::new(), None);
        // In a turn that was late, the replayed moments are not those of the recorded run.
        if let Some(plan) = plan.filter(|_| cut != Some(LATE)) {
            let texts = &*plan.texts;
            let mut moments = turn.moments.iter();
            for ((transition, operands), moment) in turn.transitions.iter().zip(moments.by_ref()) {
                ended.push(self.end(turn, plan, (transition, operands), moment));
            }
            if let Some(moment) = moments.next() {
                runs = Some(AppliedAtom {
                    atom: self.atom(texts, moment.atom),
                    since: moment.scopes.last().map_or(Nanos::ZERO, |own| own.since),
                    paused: self.course().paused,
                    began: self.began(),
                    completes: plan.machine.atom(moment.atom).law().completes,
                    scopes: scopes(plan, moment, &Self::facts(turn, moment)),
                });
            }
        }
        let computed = (with_laws || cut.is_some() || runs.is_none()).then_some(turn.asked);
        let runs = runs.filter(|_| cut.is_none());
        let recorded = &turn.recorded;
        let output_age = recorded.t.since(recorded.y.at);
        let (turn, t, sent) = (recorded.number, recorded.t, recorded.sent);
        Explanation { turn, t, replaced, ended, runs, cut, output_age, sent, computed }
    }

    /// Explains a transition.
    fn end(
        &mut self,
        turn: &ExaminedTurn,
        plan: &ExaminedPlan,
        (transition, operands): (&Transition, &[Operand]),
        moment: &PlanMoment,
    ) -> Ended {
        let texts = &*plan.texts;
        let atom = self.atom(texts, moment.atom);
        let scopes = scopes(plan, moment, &Self::facts(turn, moment));
        let cause = CauseText { plan: texts, transition, operands }.to_string();
        self.step(transition, texts);
        let to = transition.atom.map(|atom| self.atom(texts, atom));
        self.course().began.clone_from(&cause);
        Ended { atom, is_skipped: moment.is_new(), cause, was_done: was_done(moment, transition), scopes, to }
    }
}

/// Reason why no law was applied, if the turn was not ready in time.
const LATE: &str = "the plan was late";

/// Returns the reason why no law was applied in a turn; `None` if a law was applied, or the plan is over.
fn cut(turn: &ExaminedTurn, plan: Option<&ExaminedPlan>) -> Option<&'static str> {
    let is_settled = turn.moments.last().is_none_or(|last| last.cause.is_none());
    match turn.recorded.applied {
        Applied::Law | Applied::Over => None,
        Applied::Cut if plan.is_none() => Some("the plan waited for modules that it reads"),
        Applied::Cut if is_settled => Some(LATE),
        Applied::Cut => Some("the turn had too many transitions"),
    }
}

/// Returns `true` if the law of the atom had also completed when the interrupt of its scope, or of an enclosing scope,
/// ended the atom.
fn was_done(moment: &PlanMoment, transition: &Transition) -> bool {
    moment.is_completed && matches!(transition.cause, Cause::Fired(_))
}

/// Returns the time since the last ping of each sonar.
fn ages(y: &Sensed) -> [Option<Nanos>; SONARS] {
    y.pings.map(|pings| pings.newest_first().next().map(|ping| y.at.since(ping.at)))
}
