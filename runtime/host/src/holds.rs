//! The holds of a robot by safety rules, of which a report has the first ones.

use mdle_runtime::Nanos;

/// Number of holds of a rule that are reported, until the rule pauses for [`PAUSE`].
const REPORTED: u32 = 3;
/// Time between two holds of a rule after which the second one is reported again.
const PAUSE: Nanos = Nanos(10_000_000_000);

/// The holds of a robot by each rule.
#[derive(Debug, Default)]
pub(crate) struct Holds {
    rules: Vec<HoldsOfRule>,
    /// Place of the rule that held the robot last.
    last: usize,
}

/// The holds by a rule since it last paused.
#[derive(Debug)]
struct HoldsOfRule {
    rule: String,
    count: u32,
    /// Time at which the last hold began.
    last: Nanos,
}

impl Holds {
    /// Notes that a rule begins to hold the robot at time `t`. Returns the end of the line for the report; `None` if
    /// this hold is not reported.
    pub(crate) fn begins(&mut self, rule: &str, t: Nanos) -> Option<&'static str> {
        let known = self.rules.iter().position(|holds| holds.rule == rule);
        self.last = known.unwrap_or(self.rules.len());
        if known.is_none() {
            self.rules.push(HoldsOfRule { rule: rule.to_owned(), count: 0, last: t });
        }
        let holds = self.rules.get_mut(self.last)?;
        let has_paused = t.since(holds.last) >= PAUSE;
        holds.count = if has_paused { 1 } else { holds.count.saturating_add(1) };
        holds.last = t;
        match holds.count {
            ..REPORTED => Some(""),
            REPORTED => Some(", again and again: reported anew once it has paused for 10 s"),
            _ => None,
        }
    }

    /// Returns `true` if the report says of the last hold that the plan goes on after it.
    pub(crate) fn is_followed(&self) -> bool {
        self.rules.get(self.last).is_none_or(|holds| holds.count < REPORTED)
    }
}
