//! The part of a supervisor in a turn, for reports.

use crate::{Intervention, Verdict};

/// The intervention of a turn, and the plan that a diversion has begun.
#[derive(Debug, Default)]
pub(crate) struct Supervised {
    /// The intervention's strength, if there was one.
    pub(crate) verdict: Option<Verdict>,
    /// The rule that asked for it.
    pub(crate) rule: String,
    /// `true` if the turn was the first of another plan.
    pub(crate) begins: bool,
    /// The rule that replaced the plan last; empty before.
    pub(crate) diverted_by: String,
}

impl Supervised {
    /// Notes what the supervisor did in a turn, and whether another plan `begins` in it.
    pub(crate) fn note(&mut self, intervention: Option<Intervention<'_>>, begins: bool) {
        self.begins = begins;
        self.verdict = intervention.map(|intervention| intervention.verdict);
        self.rule.clear();
        self.rule.push_str(intervention.map_or("", |intervention| intervention.rule));
        if let Some(Verdict::Diverted(_)) = self.verdict {
            self.diverted_by.clone_from(&self.rule);
        }
    }

    /// Returns the intervention, if there was one.
    pub(crate) fn intervention(&self) -> Option<Intervention<'_>> {
        self.verdict.map(|verdict| Intervention { verdict, rule: &self.rule })
    }
}
