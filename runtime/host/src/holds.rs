//! Counts how often each safety rule holds the robot, so that a report shows only the first times.

use mdle_runtime::Nanos;

/// Number of times that a report shows that a rule begins to hold the robot, until the rule pauses for [`PAUSE`].
const REPORTED: u32 = 3;
/// Time since a rule last began to hold the robot after which a report shows the rule again.
const PAUSE: Nanos = Nanos(10_000_000_000);

/// Counters of the safety rules that have held the robot.
#[derive(Debug, Default)]
pub(crate) struct Holds {
    rules: Vec<HoldsOfRule>,
    /// Index of the rule that last held the robot.
    last: usize,
}

/// Counter of a rule, which restarts after the rule has paused for [`PAUSE`].
#[derive(Debug)]
struct HoldsOfRule {
    rule: String,
    count: u32,
    /// Time at which the rule last began to hold the robot.
    last: Nanos,
}

impl Holds {
    /// Records that a rule begins to hold the robot at time `t`. Returns the end of the line for the report; `None` if
    /// the report has no line about it.
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

    /// Returns `true` if the report has a line when the plan goes on after the robot was last held.
    pub(crate) fn is_followed(&self) -> bool {
        self.rules.get(self.last).is_none_or(|holds| holds.count < REPORTED)
    }
}
