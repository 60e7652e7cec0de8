//! The supervisor's intervention in a turn, for reports.

use crate::{Intervention, LimitedQuantity, Verdict};

/// The supervisor's intervention in a turn, and the plan that the supervisor has started.
#[derive(Debug, Default)]
pub(crate) struct Supervised {
    /// Strength of the intervention; `None` if there was no intervention.
    pub(crate) verdict: Option<Verdict>,
    /// Rule that caused the intervention.
    pub(crate) rule: String,
    /// Quantity that the rule limited.
    limited: Option<LimitedQuantity>,
    /// Reason why another plan has replaced the plan in this turn; `None` if the plan was not replaced.
    pub(crate) begins: Option<String>,
    /// Requests to the supervisor, for example from an operator, that it carried out between the previous turn and
    /// this turn.
    pub(crate) requests: Vec<String>,
    /// Rule that replaced the plan last; empty if no rule has replaced it, or if a user has replaced the plan since.
    pub(crate) diverted_by: String,
}

impl Supervised {
    /// Stores the supervisor's intervention in a turn, and the reason why another plan began in this turn. The reason
    /// is empty if the supervisor started the plan.
    pub(crate) fn note(&mut self, intervention: Option<Intervention<'_>>, begins: Option<&str>) {
        self.begins = match begins {
            Some("") => Some(format!("safety: {}", self.diverted_by)),
            Some(reason) => {
                self.diverted_by.clear();
                Some(reason.to_owned())
            }
            None => None,
        };
        self.verdict = intervention.map(|intervention| intervention.verdict);
        self.limited = intervention.and_then(|intervention| intervention.limited);
        self.rule.clear();
        self.rule.push_str(intervention.map_or("", |intervention| intervention.rule));
        if let Some(Verdict::Diverted(_)) = self.verdict {
            self.diverted_by.clone_from(&self.rule);
        }
    }

    /// Returns the supervisor's intervention in the turn; `None` if the supervisor did not intervene.
    pub(crate) fn intervention(&self) -> Option<Intervention<'_>> {
        self.verdict.map(|verdict| Intervention { verdict, rule: &self.rule, limited: self.limited })
    }
}
