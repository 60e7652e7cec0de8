//! Publishes the state of the plan in messages that ROS 2 tools can show.

use mdle_host::{Ended, PlanPosition};
use serde_json::json;

use crate::cdr::Payload;
use crate::messages::{DiagnosticArray, DiagnosticStatus, Header, KeyValue, Text, Time};

/// The state of a plan as text and as a diagnostic array.
#[derive(Debug, Clone, PartialEq)]
pub struct StateMessages {
    /// Message `std_msgs/msg/String` with the state as JSON.
    pub text: Payload,
    /// Message `diagnostic_msgs/msg/DiagnosticArray` with the state.
    pub diagnostics: Payload,
}

/// State of a plan, in the form in which it is published.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct PlanState {
    /// Status of the plan: `running`, `over` or `stopped`.
    status: &'static str,
    /// Time of the run, in seconds.
    t: String,
    /// Name of the plan.
    plan: String,
    /// Law of the current atom.
    law: String,
    /// Position of the current atom in the plan.
    place: String,
    /// Reason why the atom runs, or why the plan has ended.
    cause: String,
    /// Names of the named scopes that enclose the atom, beginning with the plan.
    scopes: Vec<String>,
}

impl PlanState {
    /// Returns the state after a turn.
    #[must_use]
    pub fn at(position: &PlanPosition<'_>) -> Self {
        let names = position.scopes.iter().map(|scope| scope.name).filter(|name| !name.is_empty());
        let scopes: Vec<_> = names.map(str::to_owned).collect();
        Self {
            status: "running",
            t: format!("{:.1}", position.t.seconds()),
            plan: scopes.first().cloned().unwrap_or_default(),
            law: position.law.to_owned(),
            place: position.place.clone(),
            cause: position.since.to_owned(),
            scopes,
        }
    }

    /// Returns the state after the end of the plan.
    #[must_use]
    pub fn after(ended: &Ended<'_>) -> Self {
        Self {
            status: if ended.is_over { "over" } else { "stopped" },
            t: format!("{:.1}", ended.t.seconds()),
            plan: ended.plan.to_owned(),
            cause: ended.by.to_owned(),
            ..Self::default()
        }
    }

    /// Returns the messages, with the time stamp `stamp` in nanoseconds.
    ///
    /// # Errors
    /// Fails if a text cannot be encoded.
    pub fn messages(&self, stamp: i64) -> Result<StateMessages, String> {
        let text = json!({
            "status": self.status, "t": self.t.parse::<f64>().unwrap_or_default(), "plan": self.plan, "atom": self.law,
            "place": self.place, "cause": self.cause, "scopes": self.scopes,
        });
        let scopes = self.scopes.join(" > ");
        let rows = [("status", self.status), ("t", &self.t), ("plan", &self.plan), ("atom", &self.law)];
        let rows = rows.into_iter().chain([("place", &*self.place), ("cause", &*self.cause), ("scopes", &*scopes)]);
        let row = |(key, value): (&str, &str)| KeyValue { key: key.to_owned(), value: value.to_owned() };
        let status = DiagnosticStatus {
            // 0 is OK, and 1 a warning.
            level: u8::from(self.status == "stopped"),
            name: "mdle: plan".to_owned(),
            message: if self.law.is_empty() { self.status.to_owned() } else { self.law.clone() },
            hardware_id: "mdle".to_owned(),
            values: rows.map(row).collect(),
        };
        let header = Header { stamp: Time::of(stamp), frame_id: String::new() };
        Ok(StateMessages {
            text: Payload::of(&Text { data: text.to_string() })?,
            diagnostics: Payload::of(&DiagnosticArray { header, status: vec![status] })?,
        })
    }
}

#[cfg(test)]
mod tests {
    use mdle_host::EnclosingScope;
    use mdle_runtime::Nanos;

    use super::*;

    #[test]
    fn the_state_is_text_and_diagnostics() {
        let around = |name| EnclosingScope { name, condition: "bumper", since: Nanos(1) };
        let position = PlanPosition {
            t: Nanos(2_340_000_000),
            state: 3,
            law: "go 20 0",
            place: "square.mdle:3, pass 2 of 4".to_owned(),
            since: "wait 5s",
            scopes: vec![around("Square"), around("")],
        };
        let messages = PlanState::at(&position).messages(1_500_000_000).unwrap();
        let text: Text = messages.text.read().unwrap();
        let json: serde_json::Value = serde_json::from_str(&text.data).unwrap();
        let expected = json!({
            "status": "running", "t": 2.3, "plan": "Square", "atom": "go 20 0", "place": "square.mdle:3, pass 2 of 4",
            "cause": "wait 5s", "scopes": ["Square"],
        });
        assert_eq!(json, expected);
        let array: DiagnosticArray = messages.diagnostics.read().unwrap();
        assert_eq!((array.header.stamp.nanosec, array.status[0].level), (500_000_000, 0));
        assert_eq!(array.status[0].values.len(), 7);
    }

    #[test]
    fn an_end_that_is_no_end_of_the_plan_is_a_warning() {
        let ended = Ended { plan: "Square", is_over: false, by: "--timeout", t: Nanos(0) };
        let array: DiagnosticArray = PlanState::after(&ended).messages(0).unwrap().diagnostics.read().unwrap();
        assert_eq!((array.status[0].level, array.status[0].message.as_str()), (1, "stopped"));
    }
}
