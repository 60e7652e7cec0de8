//! Counts how often each safety rule has held the robot back, so that a report shows only the first few times.

use mdle_runtime::Nanos;

/// Number of times that a report shows that a rule holds the robot, before the rule has paused for [`PAUSE`].
const REPORTED: u32 = 3;
/// Time after which a report shows a rule again. It is counted from the last time at which the rule began to hold the
/// robot.
const PAUSE: Nanos = Nanos(10_000_000_000);

/// Counters of the safety rules that have held the robot.
#[derive(Debug, Default)]
pub(crate) struct Holds {
    rules: Vec<HoldsOfRule>,
    /// Index of the rule that held the robot last.
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
    /// Records that a rule begins to hold the robot at time `t`. Returns the text that the report appends to its line
    /// about this hold; `None` if the report shows no line.
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

    /// Returns `true` if the report will announce the end of the latest hold, at which the plan continues.
    pub(crate) fn is_followed(&self) -> bool {
        self.rules.get(self.last).is_none_or(|holds| holds.count < REPORTED)
    }
}
