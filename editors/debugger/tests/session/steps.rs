//! Tests steps forward and back.

use serde_json::{Value, json};

use crate::client::DebugSession;

/// Returns the stack at the entry and after each command, and the reason for each stop.
fn stacks(test: &str, commands: &[&str]) -> (Vec<Vec<String>>, Vec<String>) {
    let mut session = DebugSession::launched(test);
    session.requests(&["configurationDone"]);
    let mut traces = vec![session.request("stackTrace", json!({ "threadId": 1 }))];
    for command in commands {
        let (command, arguments) = match command.strip_prefix("fine ") {
            Some(command) => (command, json!({ "threadId": 1, "granularity": "instruction" })),
            None => (*command, json!({ "threadId": 1 })),
        };
        session.request(command, arguments);
        traces.push(session.request("stackTrace", json!({ "threadId": 1 })));
    }
    let messages = session.end();
    let stops = messages.stops().into_iter().map(str::to_owned).collect();
    (traces.into_iter().map(|seq| messages.stack(seq)).collect(), stops)
}

#[test]
fn a_step_in_goes_to_the_next_transition() {
    let (stacks, stops) = stacks("step_in", &["stepIn", "stepIn", "stepIn", "stepIn", "stepIn"]);
    assert_eq!(
        stacks,
        [
            vec!["go 20 0 @2", "Tour @1"],
            vec!["go 5 0, pass 1 of 2 @4", "Shake @3", "Tour @1"],
            vec!["turn 90, pass 1 of 2 @4", "Shake @3", "Tour @1"],
            vec!["go 5 0, pass 2 of 2 @4", "Shake @3", "Tour @1"],
            vec!["stop @6", "Tour @1"],
            vec!["stop @6", "Tour @1"],
        ]
    );
    assert_eq!(stops, ["entry", "step", "step", "step", "step", "end"]);
}

#[test]
fn next_ends_a_turn_and_step_back_undoes_it() {
    let forth = ["next"; 9];
    let (there, _) = stacks("next", &forth);
    let mut both = forth.to_vec();
    both.extend(["stepBack"; 9]);
    let (all, stops) = stacks("step_back", &both);
    let mut back = all[9..].to_vec();
    back.reverse();
    assert_eq!(all[..10], there);
    assert_eq!(back, there);
    assert_eq!(stops.last().unwrap(), "entry");
}

#[test]
fn a_fine_step_back_goes_to_the_transition_before() {
    let (stacks, _) = stacks("fine", &["stepIn", "stepIn", "fine stepBack", "fine next"]);
    assert_eq!(stacks[3], stacks[1]);
    assert_eq!(stacks[4], stacks[2]);
}

#[test]
fn a_step_out_ends_the_scope_around_the_atom() {
    let (stacks, _) = stacks("step_out", &["stepIn", "stepOut", "stepOut"]);
    assert_eq!(stacks[2], ["stop @6", "Tour @1"]);
    // The enclosing scope is the plan itself, which does not end in the script.
    assert_eq!(stacks[3], ["stop @6", "Tour @1"]);
}

#[test]
fn a_run_stops_at_its_end_and_then_terminates() {
    let (stacks, stops) = stacks("end", &["continue", "stepBack", "continue", "continue"]);
    assert_eq!(stops, ["entry", "end", "step", "end", "terminated"]);
    assert_eq!(stacks[1], ["stop @6", "Tour @1"]);
}

#[test]
fn a_plan_that_has_ended_can_be_gone_back() {
    let plan = "{ P (bumper) (Atom (null) (go 20 0)) }";
    let script = "{\"t\":0}\n{\"t\":1,\"fired\":[\"bumper\"]}\n{\"t\":2}\n";
    let mut session = DebugSession::of("over", plan, script, &json!({}));
    session.requests(&["configurationDone"]);
    let over = session.request("stackTrace", Value::Null);
    session.requests(&["stepBack"]);
    let back = session.request("stackTrace", Value::Null);
    let messages = session.end();
    assert_eq!(messages.stack(over), ["P has ended @1"]);
    assert_eq!(messages.stack(back), ["go 20 0 @1", "P @1"]);
    let ends = messages.0.iter().find(|message| message["body"]["reason"] == "end").unwrap();
    assert_eq!(ends["body"]["description"], "The plan has ended");
}
