//! The guardian: the supervisor of a run with safety rules.

use std::time::Duration;

use mdle_host::{Intervention, Pilot, Supervisor};
use mdle_record::RecordedChange;
use mdle_runtime::capability::{Bumpers, DiffDrive, Odometry, SonarRing};
use mdle_runtime::{Alphabet, Nanos, Plan, Twist};

use super::{Conditions, Envelope, Limits, Measure, Rules, WatchedConditions};

/// Supervisor of one run, which consists of an envelope and the conditions of the guards.
#[derive(Debug)]
pub struct Guardian<A: Alphabet> {
    envelope: Envelope,
    conditions: WatchedConditions<A>,
    /// `true` once the robot's start pose has been compared with the fences.
    has_begun: bool,
    /// Warnings that have not been reported yet.
    warnings: Vec<String>,
    /// `true` if the rules were reset after the last [`Guardian::changes_since`].
    is_reset: bool,
}

impl<A: Alphabet> Guardian<A> {
    /// Creates the guardian of a run with this period; `conditions` are the conditions of the guards in `rules`.
    #[must_use]
    pub fn new(rules: Rules, conditions: &Conditions<A>, period: Duration) -> Self {
        let (envelope, conditions) = (Envelope::new(rules, period), conditions.watch());
        Self { envelope, conditions, has_begun: false, warnings: Vec::new(), is_reset: false }
    }

    /// Returns the envelope.
    #[must_use]
    pub fn envelope(&self) -> &Envelope {
        &self.envelope
    }

    /// Returns the envelope, so that its rules can be changed.
    pub fn envelope_mut(&mut self) -> &mut Envelope {
        &mut self.envelope
    }
}

impl<A: Alphabet> Guardian<A> {
    /// Calls `say` with each warning since the last call.
    pub(crate) fn warn(&mut self, say: &mut dyn FnMut(&str)) {
        self.warnings.drain(..).for_each(|warning| say(&format!("warning: {warning}")));
    }

    /// Resets the rules, as [`Envelope::reset`] does.
    pub(crate) fn reset(&mut self) -> Vec<String> {
        self.is_reset = true;
        self.envelope.reset()
    }

    /// Returns the changes since the last call: a reset of the rules, and each limit that then differs from `recorded`.
    /// Updates `recorded`.
    pub(crate) fn changes_since(&mut self, recorded: &mut Limits) -> Vec<RecordedChange> {
        let mut limits = self.envelope.rules().limits;
        let mut changes = Vec::new();
        if std::mem::take(&mut self.is_reset) {
            *recorded = self.envelope.first_limits();
            changes.push(RecordedChange::SafetyReset);
        }
        for measure in Measure::ALL {
            let (before, value) = (measure.of(recorded), *measure.of(&mut limits));
            if before.to_bits() != value.to_bits() {
                *before = value;
                changes.push(RecordedChange::Limit { key: measure.key().to_owned(), value });
            }
        }
        changes
    }
}

impl<A> Guardian<A>
where
    A: Alphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
{
    /// Returns the input to send to the robot instead of `asked`.
    pub fn filtered(&mut self, asked: Twist, y: &A::Output, t: Nanos) -> Twist {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.warnings = self.envelope.rules().held_at_start(&y.pose());
        }
        let fired = self.conditions.fired(y, t);
        self.envelope.filter(asked, y, t, fired)
    }
}

impl<A, B> Supervisor<B> for Guardian<A>
where
    A: Alphabet<Input = Twist>,
    A::Output: Odometry + Bumpers + SonarRing + DiffDrive,
    B: Pilot<Plan: Plan<Output = A::Output, Input = Twist>>,
{
    fn filter(&mut self, asked: Twist, y: &A::Output, t: Nanos) -> Twist {
        self.filtered(asked, y, t)
    }

    fn intervention(&self) -> Option<Intervention<'_>> {
        self.envelope.intervention()
    }

    fn messages(&mut self, say: &mut dyn FnMut(&str)) {
        self.warn(say);
    }

    fn repeat(&mut self, change: &RecordedChange) {
        if *change == RecordedChange::SafetyReset {
            let _ = self.envelope.reset();
        }
        if let RecordedChange::Limit { key, value } = change
            && let Some(measure) = Measure::ALL.into_iter().find(|measure| measure.key() == key)
        {
            *measure.of(&mut self.envelope.rules_mut().limits) = *value;
        }
    }
}
