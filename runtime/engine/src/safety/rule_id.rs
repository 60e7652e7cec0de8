//! Names and texts of the individual rules in a safety file.

use super::{Rules, Then};

/// A safety rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RuleId {
    /// The built-in rule that all numbers of an input must be finite.
    Finite,
    /// The rule `output` of `[stale]`.
    Stale,
    /// The rule `module` of `[stale]`.
    StaleModule,
    /// The rule `[overrun]`.
    Overrun,
    /// The rule `[contact]`.
    Contact,
    /// The guard with this index in the safety file.
    Guard(usize),
    /// The rule `speed` of `[limits]`.
    Speed,
    /// The rule `turn_rate` of `[limits]`.
    TurnRate,
    /// The rule `acceleration` of `[limits]`.
    Acceleration,
    /// The fence with this index in the safety file.
    Fence(usize),
}

impl Rules {
    /// Returns the name of a rule as shown in reports.
    #[must_use]
    pub fn name(&self, id: RuleId) -> &str {
        match id {
            RuleId::Finite => "not a number",
            RuleId::Stale => "stale",
            RuleId::StaleModule => "stale module",
            RuleId::Overrun => "overrun",
            RuleId::Contact => "contact",
            RuleId::Guard(number) => self.guards.get(number).map_or("", |guard| &guard.name),
            RuleId::Speed => "speed",
            RuleId::TurnRate => "turn_rate",
            RuleId::Acceleration => "acceleration",
            RuleId::Fence(number) => self.fences.get(number).map_or("", |fence| &fence.name),
        }
    }

    /// Returns the consequence of a rule, in the words of a safety file; `None` for a rule that only limits inputs.
    #[must_use]
    pub fn then(&self, id: RuleId) -> Option<&str> {
        let then = match id {
            RuleId::Stale => self.stale.map(|(_, then)| then),
            RuleId::StaleModule => self.stale_module.map(|(_, then)| then),
            RuleId::Overrun => self.overrun.map(|(_, then)| then),
            RuleId::Contact => self.contact,
            RuleId::Guard(number) => self.guards.get(number).map(|guard| guard.then),
            RuleId::Finite | RuleId::Speed | RuleId::TurnRate | RuleId::Acceleration | RuleId::Fence(_) => None,
        }?;
        Some(match then {
            Then::HoldForward => "hold forward",
            Then::Hold => "hold",
            Then::End => "end",
            Then::Divert(plan) => self.plans.get(plan).map_or("", |plan| &plan.file),
        })
    }

    /// Returns the condition of a guard, in the plan language; `None` for any other rule.
    #[must_use]
    pub fn when(&self, id: RuleId) -> Option<&str> {
        let RuleId::Guard(number) = id else { return None };
        self.guards.get(number).map(|guard| guard.when.text.as_str())
    }

    /// Returns the rules that can change an input.
    pub(super) fn ids(&self) -> impl Iterator<Item = RuleId> + use<> {
        let Self { fences, contact, stale, stale_module, overrun, guards, .. } = self;
        let own = [
            (true, RuleId::Finite),
            (stale.is_some(), RuleId::Stale),
            (stale_module.is_some(), RuleId::StaleModule),
            (overrun.is_some(), RuleId::Overrun),
            (contact.is_some(), RuleId::Contact),
            (true, RuleId::Speed),
            (true, RuleId::TurnRate),
            (true, RuleId::Acceleration),
        ];
        let own = own.into_iter().filter_map(|(is_there, id)| is_there.then_some(id));
        own.chain((0..guards.len()).map(RuleId::Guard)).chain((0..fences.len()).map(RuleId::Fence))
    }
}
