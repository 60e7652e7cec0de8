//! A pilot with its supervisor: together they determine the input that a robot is sent in each turn, in a run and in a
//! replay.

use std::any::Any;
use std::fmt;

use mdle_record::RecordedChange;
use mdle_runtime::{Nanos, Plan, Turn, Twist};

use crate::pilot::{Pilot, PilotFault, PilotTurn};
use crate::transitions::Transitions;
use crate::{Intervention, PilotInput, PilotOutput, Supervisor, Verdict};

/// A pilot, with its supervisor if it has one.
pub struct Helm<'p, B: Pilot> {
    pilot: B,
    supervised: Option<Supervised<'p, B>>,
    /// Time of the last turn.
    t: Nanos,
    /// Input that the plan requested last; `None` if it is not a [`Twist`].
    asked: Option<Twist>,
    /// Input that is sent next.
    input: PilotInput<B>,
}

/// The supervisor of a run, with the plans that it may start in place of the running plan.
pub struct Supervised<'p, B: Pilot> {
    /// Supervisor of the run.
    pub supervisor: Box<dyn Supervisor<B> + 'p>,
    /// Function that creates the plan with this number; returns `None` if there is no such plan.
    pub diversions: Box<dyn Fn(usize) -> Option<B::Plan> + 'p>,
}

impl<B: Pilot> fmt::Debug for Helm<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Helm").field("t", &self.t).finish_non_exhaustive()
    }
}

impl<B: Pilot> fmt::Debug for Supervised<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Supervised").finish_non_exhaustive()
    }
}

impl<'p, B> Helm<'p, B>
where
    B: Pilot<Plan: Plan<Input: 'static>>,
{
    /// Creates a pilot with its supervisor, before the first turn.
    #[must_use]
    pub fn new(pilot: B, supervised: Option<Supervised<'p, B>>) -> Self {
        Self { pilot, supervised, t: Nanos::ZERO, asked: None, input: PilotInput::<B>::default() }
    }

    /// Makes turn `number` with output `y` at time `t`; [`Helm::input`] then returns the resulting input.
    ///
    /// # Errors
    /// Fails if [`Pilot::turn`] fails.
    pub fn turn(
        &mut self,
        y: &mut PilotOutput<B>,
        t: Nanos,
        number: u64,
        transitions: &mut Transitions,
    ) -> Result<Turn<()>, PilotFault> {
        self.t = t;
        let diversion = self.diversion();
        self.pilot.complete(y, t);
        if let Some(plan) = diversion {
            self.pilot.divert(plan, PilotTurn { y, t, number });
        }
        let turn = self.pilot.turn(PilotTurn { y, t, number }, transitions)?;
        let kind = match turn {
            Turn::Law(_) => Turn::Law(()),
            Turn::Cut => Turn::Cut,
            Turn::Over => Turn::Over,
        };
        self.send(turn.input(), Some(y));
        Ok(kind)
    }

    /// Determines the input that is sent next: `asked`, unless the supervisor changes it. The supervisor is asked only
    /// if there is an output.
    pub(crate) fn send(&mut self, asked: PilotInput<B>, y: Option<&PilotOutput<B>>) {
        self.asked = (&asked as &dyn Any).downcast_ref().copied();
        self.input = match (&mut self.supervised, y) {
            (Some(supervised), Some(y)) => supervised.supervisor.filter(asked, y, self.t),
            (Some(_) | None, _) => asked,
        };
    }

    /// Returns the plan that the supervisor has started in the last turn; `None` if it has started none.
    fn diversion(&self) -> Option<B::Plan> {
        match self.intervention()?.verdict {
            Verdict::Diverted(plan) => (self.supervised.as_ref()?.diversions)(plan),
            Verdict::Limited | Verdict::HeldForward | Verdict::Held | Verdict::Ended => None,
        }
    }

    /// Returns the input that is sent next.
    #[must_use]
    pub fn input(&self) -> &PilotInput<B> {
        &self.input
    }

    /// Returns the input that the plan requested last; `None` if it is not a [`Twist`].
    #[must_use]
    pub fn asked(&self) -> Option<Twist> {
        self.asked
    }

    /// Returns the supervisor's intervention in the last turn.
    #[must_use]
    pub fn intervention(&self) -> Option<Intervention<'_>> {
        self.supervised.as_ref().and_then(|supervised| supervised.supervisor.intervention())
    }

    /// Returns the pilot.
    pub fn pilot(&self) -> &B {
        &self.pilot
    }

    /// Returns the pilot, so that it can be changed between two turns.
    pub fn pilot_mut(&mut self) -> &mut B {
        &mut self.pilot
    }

    /// Returns the supervisor, the pilot and the input that is sent next; `None` without a supervisor.
    pub(crate) fn parts(&mut self) -> Option<(&mut (dyn Supervisor<B> + 'p), &mut B, &PilotInput<B>)> {
        let Self { pilot, supervised, input, .. } = self;
        supervised.as_mut().map(|supervised| (&mut *supervised.supervisor, pilot, &*input))
    }

    /// Returns the supervisor, so that it can be changed between two turns; `None` if there is no supervisor.
    pub fn supervisor_mut(&mut self) -> Option<&mut (dyn Supervisor<B> + 'p)> {
        self.supervised.as_mut().map(|supervised| &mut *supervised.supervisor)
    }

    /// Starts recording the changes that [`Helm::take_changes`] returns.
    pub(crate) fn record(&mut self) {
        self.pilot.record();
        if let Some(supervisor) = self.supervisor_mut() {
            supervisor.record();
        }
    }

    /// Removes and returns the changes, other than the robot's output, that influenced the last turn.
    pub(crate) fn take_changes(&mut self) -> Vec<RecordedChange> {
        let mut changes = self.pilot.take_changes();
        changes.extend(self.supervisor_mut().map(Supervisor::take_changes).unwrap_or_default());
        changes
    }
}
