//! Counts the rounds of `rendezvous`. The number of rounds with another robot is the number of times that the plan has
//! entered a scope with a `rendezvous` with that robot (docs/src/reference/semantics.md, 2.6).

use mdle_host::{Passes, Texts, Transitions, outwards};
use mdle_runtime::Plan;

/// Rounds of a robot with each other robot.
#[derive(Debug, Default)]
pub(super) struct Rounds {
    counts: Vec<(&'static str, u64)>,
    passes: Passes,
    /// Number of the plan whose scopes were counted last, counted from 1; 0 before the first plan.
    plan: u64,
}

impl Rounds {
    /// Returns the name of each robot with its number of rounds.
    pub(super) fn counts(&self) -> impl Iterator<Item = (&'static str, u64)> {
        self.counts.iter().copied()
    }

    /// Returns the number of rounds with the robot `robot`.
    pub(super) fn with(&self, robot: &str) -> u64 {
        self.counts.iter().find(|(name, _)| *name == robot).map_or(0, |(_, count)| *count)
    }

    /// Counts the rounds that result from the scopes that the plan with this number has entered in a turn.
    pub(super) fn turn<P: Plan>(&mut self, number: u64, plan: &P, transitions: &Transitions) {
        if plan.meetings().is_empty() {
            return;
        }
        let fsm = Texts::fsm(plan);
        if number != self.plan {
            self.passes = Passes::default();
            let first = fsm.atoms.first().map_or(0, |atom| atom.scope);
            // A plan that continues after it was suspended enters no scopes.
            if number > self.plan {
                outwards(fsm, first).for_each(|(scope, _)| count(&mut self.counts, plan, scope));
            }
            self.plan = number;
        }
        for (transition, _) in transitions.iter() {
            let counts = &mut self.counts;
            self.passes.step_into(fsm, transition, |scope| count(counts, plan, scope));
        }
    }
}

/// Counts a round with each robot that a `rendezvous` of the entered scope `scope` names.
fn count<P: Plan>(counts: &mut Vec<(&'static str, u64)>, plan: &P, scope: u32) {
    for meeting in plan.meetings().iter().filter(|meeting| meeting.scope == scope) {
        match counts.iter_mut().find(|(robot, _)| *robot == meeting.robot) {
            Some((_, count)) => *count = count.saturating_add(1),
            None => counts.push((meeting.robot, 1)),
        }
    }
}
