//! Tests breakpoints on lines, operands, names and times.

use serde_json::{Value, json};

use crate::client::DebugSession;

/// Sets breakpoints with `set`, and sends `commands`; returns, after each command, the time of the turn and the
/// innermost frame.
fn stops(test: &str, set: impl FnOnce(&mut DebugSession), commands: &[&str]) -> Vec<String> {
    let mut session = DebugSession::of(test, crate::client::PLAN, crate::client::SCRIPT, &json!({}));
    set(&mut session);
    let mut seqs = Vec::new();
    for command in commands {
        session.request(command, json!({ "threadId": 1 }));
        let stack = session.request("stackTrace", Value::Null);
        // The last list of the innermost frame contains the variables of the turn.
        let scopes = session.request("scopes", json!({ "frameId": 1 }));
        seqs.push((
            stack,
            scopes,
            (1..40)
                .map(|reference| session.request("variables", json!({ "variablesReference": reference })))
                .collect::<Vec<_>>(),
        ));
    }
    let messages = session.end();
    let stop = |(stack, scopes, variables): (i64, i64, Vec<i64>)| {
        let turn = messages.body(scopes)["scopes"].as_array().unwrap().last().unwrap()["variablesReference"].clone();
        let turn = messages.variables(variables[turn.as_u64().unwrap() as usize - 1]);
        format!("{}: {}", turn[1], messages.stack(stack)[0])
    };
    seqs.into_iter().map(stop).collect()
}

#[test]
fn a_line_stops_where_its_element_is_entered() {
    let found = stops(
        "line",
        |session| {
            session.breakpoints(&[(3, 0)]);
        },
        &["configurationDone", "continue"],
    );
    assert_eq!(found, ["t = 3 s: go 5 0, pass 1 of 2 @4", "t = 8 s: stop @6"]);
}

#[test]
fn an_operand_stops_before_it_ends_its_scope() {
    let column = crate::client::PLAN.lines().nth(1).unwrap().find("bumper").unwrap() as u32 + 1;
    let found = stops(
        "operand",
        |session| {
            session.breakpoints(&[(2, column)]);
        },
        &["configurationDone", "continue"],
    );
    assert_eq!(found, ["t = 3 s: go 20 0 @2", "t = 8 s: stop @6"]);
}

#[test]
fn a_breakpoint_at_the_entry_stops_there_and_is_found_backwards() {
    let set = |session: &mut DebugSession| {
        session.breakpoints(&[(1, 0), (6, 0)]);
    };
    let found =
        stops("entry", set, &["configurationDone", "continue", "continue", "reverseContinue", "reverseContinue"]);
    assert_eq!(
        found,
        ["t = 0 s: go 20 0 @2", "t = 7 s: stop @6", "t = 8 s: stop @6", "t = 7 s: stop @6", "t = 0 s: go 20 0 @2",]
    );
}

#[test]
fn names_and_times_stop_a_run() {
    let set = |session: &mut DebugSession| {
        let names = ["turn", "2.6s", "Shake"].map(|name| json!({ "name": name }));
        session.request("setFunctionBreakpoints", json!({ "breakpoints": names }));
    };
    let found = stops("names", set, &["configurationDone", "continue", "continue", "continue"]);
    assert_eq!(
        found,
        [
            "t = 3 s: go 20 0 @2",
            "t = 3 s: go 5 0, pass 1 of 2 @4",
            "t = 4 s: turn 90, pass 1 of 2 @4",
            "t = 8 s: stop @6",
        ]
    );
}

#[test]
fn a_breakpoint_moves_to_the_next_place_or_says_why_not() {
    let mut session = DebugSession::launched("moved");
    let lines = session.breakpoints(&[(4, 0), (5, 0), (7, 0), (2, 30), (4, 1)]);
    let other = session.request(
        "setBreakpoints",
        json!({ "source": { "path": session.folder.join("script.jsonl") }, "breakpoints": [{ "line": 1 }] }),
    );
    let names = session.request(
        "setFunctionBreakpoints",
        json!({ "breakpoints": [{ "name": "Shaek" }, { "name": "5m" }, { "name": "500ms" }] }),
    );
    let locations = session.request("breakpointLocations", json!({ "source": { "path": session.path() }, "line": 2 }));
    let messages = session.end();
    let line = |breakpoint: &Value| {
        (breakpoint["verified"].as_bool().unwrap(), breakpoint["line"].as_u64(), breakpoint["column"].as_u64())
    };
    let set: Vec<_> = messages.body(lines)["breakpoints"].as_array().unwrap().iter().map(line).collect();
    assert_eq!(
        set,
        [
            (true, Some(4), Some(6)),
            (true, Some(6), Some(3)),
            (false, None, None),
            (true, Some(2), Some(25)),
            (true, Some(4), Some(6))
        ]
    );
    assert_eq!(messages.body(other)["breakpoints"][0]["message"], "this file has no part of the plan that runs");
    let names = messages.body(names)["breakpoints"].as_array().unwrap();
    assert_eq!(
        names[0]["message"],
        "`Shaek` is no plan, no behavior and no law of this plan; a time is written as `2.5s`"
    );
    assert_eq!(names[1]["message"], "`5m` is no time: write it as `2.5s` or `500ms`");
    assert_eq!(names[2]["verified"], true);
    let columns: Vec<_> = messages.body(locations)["breakpoints"]
        .as_array()
        .unwrap()
        .iter()
        .map(|at| at["column"].as_u64().unwrap())
        .collect();
    assert_eq!(columns, [3, 14, 25, 36]);
}
