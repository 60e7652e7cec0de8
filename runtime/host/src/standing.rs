//! The position in a running plan for observers and supervisors.

use mdle_runtime::Nanos;
use mdle_runtime::fsm::Kind;

use crate::cause::place;
use crate::passes::Passes;
use crate::position::Position;
use crate::{EnclosingScope, PlanPosition};

/// Data about the course of a run up to the last turn, in addition to the data that the plan records itself.
#[derive(Debug, Default)]
pub(crate) struct RunCourse {
    /// Passes of the loops.
    pub(crate) passes: Passes,
    /// Cause of the transition with which the current atom began; empty for the plan's first atom.
    pub(crate) since: String,
}

/// Returns the position in a plan that began at time `zero` and has not ended.
pub(crate) fn standing<'m>(
    position: &'m dyn Position,
    t: Nanos,
    zero: Nanos,
    course: &'m RunCourse,
) -> PlanPosition<'m> {
    let (plan, fsm) = (position.texts(), position.texts().fsm());
    let atom = position.atom().and_then(|atom| fsm.atoms.get(atom as usize));
    let own = atom.and_then(|atom| fsm.brackets.get(atom.scope as usize)).map(|bracket| bracket.kind);
    let levels = match own {
        Some(Kind::Scope { level }) => 0..=level,
        Some(Kind::Loop { .. }) | None => 0..=0,
    };
    let scopes = levels.map(|level| {
        let scope = position.scope(level);
        EnclosingScope {
            name: plan.name(scope),
            condition: plan.condition(scope),
            since: position.since(level, t.since(zero)),
        }
    });
    let law = position.atom().map_or("", |atom| plan.law(atom));
    let place = position.atom().map_or_else(String::new, |atom| place(plan, &course.passes, atom));
    PlanPosition { t, state: position.state(), law, place, since: &course.since, scopes: scopes.collect() }
}
