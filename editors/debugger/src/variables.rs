//! The variables of a frame: operands of its condition, memory since its entry, and data of the turn.

use serde_json::{Value, json};

use crate::launch::LaunchedPlan;
use crate::run::{DebugRun, TurnInput};
use crate::stack::StackFrame;
use crate::why::{Reason, reason};

/// Stores the lists of variables that the client can request while the run is stopped. The client refers to a list by
/// its index, counted from 1.
#[derive(Debug, Default)]
pub(crate) struct Lists(Vec<Vec<Value>>);

impl Lists {
    /// Removes all lists because the run continues.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns the list with this reference; `None` if there is no such list.
    pub(crate) fn get(&self, reference: usize) -> Option<&[Value]> {
        self.0.get(reference.checked_sub(1)?).map(Vec::as_slice)
    }

    fn add(&mut self, list: Vec<Value>) -> usize {
        self.0.push(list);
        self.0.len()
    }

    /// Returns the variable for a condition, with the operands as its children.
    pub(crate) fn reason(&mut self, reason: &Reason) -> Value {
        let operands: Vec<Value> = reason.operands.iter().map(|operand| self.reason(operand)).collect();
        let reference = if operands.is_empty() { 0 } else { self.add(operands) };
        json!({ "name": reason.text, "value": reason.value(), "variablesReference": reference })
    }

    /// Returns the groups of variables for a frame; if the plan has ended, returns only the group for the turn.
    pub(crate) fn scopes(&mut self, loaded: &LaunchedPlan, run: &DebugRun<'_>, frame: Option<&StackFrame>) -> Value {
        let mut lists = Vec::new();
        if let Some(frame) = frame {
            lists.push(("Condition", self.condition(loaded, run, frame)));
            lists.push(("Since entry", kept(loaded, run, frame)));
        }
        lists.push(("Turn", turn(run)));
        let scope = |(name, list): (&str, Vec<Value>)| {
            let reference = self.add(list);
            json!({ "name": name, "variablesReference": reference, "expensive": false })
        };
        lists.into_iter().map(scope).collect()
    }

    /// Returns the operands of the frame's interrupt.
    fn condition(&mut self, loaded: &LaunchedPlan, run: &DebugRun<'_>, frame: &StackFrame) -> Vec<Value> {
        let Some(open) = run.open().nth(frame.open) else { return Vec::new() };
        let Some(interrupt) = open.part().interrupt() else { return Vec::new() };
        let whole = reason(&loaded.compiled.plan, open, &interrupt.condition, run.reports());
        if interrupt.condition.joined().len() > 1 {
            whole.operands.iter().map(|operand| self.reason(operand)).collect()
        } else {
            vec![self.reason(&whole)]
        }
    }
}

fn variable(name: impl Into<String>, value: impl Into<String>) -> Value {
    json!({ "name": name.into(), "value": value.into(), "variablesReference": 0 })
}

fn seconds(nanos: u64) -> String {
    format!("{} s", nanos as f64 / 1e9)
}

fn meters(nanometers: u64) -> String {
    format!("{} m", nanometers as f64 / 1e9)
}

/// Returns the memory of a frame: its timer, the distance driven, the passes of its loops, the memory of each RISING,
/// and its record for `after`.
fn kept(loaded: &LaunchedPlan, run: &DebugRun<'_>, frame: &StackFrame) -> Vec<Value> {
    let reports = run.reports();
    let opened: Vec<_> = run.open().collect();
    let Some(open) = opened.get(frame.open) else { return Vec::new() };
    let mut list = vec![variable("time", seconds(open.since(reports).0)), variable("way", meters(open.way(reports).0))];
    for index in &frame.loops {
        list.extend(opened.get(*index).map(|looped| variable("pass", looped.pass().to_string())));
    }
    for (number, memory) in open.memories().iter().enumerate() {
        let value = if *memory { "its operand was false before" } else { "its operand was never false before" };
        list.push(variable(format!("RISING {}", number + 1), value));
    }
    if let Some(record) = open.part().scope().and_then(|scope| scope.record) {
        for (fact, text) in loaded.facts(record.id) {
            let holds = open.facts().get(fact as usize) == Some(&true);
            list.push(variable(text, if holds { "holds" } else { "does not hold" }));
        }
    }
    list
}

/// Returns the variables of the turn: its number, its time, and the reports of the script.
fn turn(run: &DebugRun<'_>) -> Vec<Value> {
    let (at, reports) = (run.at(), run.reports());
    let state = match at.input {
        None => "transitions are made",
        Some(TurnInput::Law) => "over: the law of the atom was applied",
        Some(TurnInput::Cut) => "over: cut at the limit of transitions, no law was applied",
        Some(TurnInput::Over) => "over: the plan has ended",
    };
    let words = |set: &std::collections::BTreeSet<String>| set.iter().cloned().collect::<Vec<_>>().join(", ");
    vec![
        variable("turn", at.turn.to_string()),
        variable("t", seconds(reports.t.0)),
        variable("way", meters(reports.way.0)),
        variable("heading", format!("{} deg", reports.heading.degrees())),
        variable("fired", words(&reports.fired)),
        variable("completed", words(&reports.completed)),
        variable("state", state),
    ]
}
