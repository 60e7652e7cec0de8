//! Tests variables, and explanations why a condition does not hold.

use serde_json::{Value, json};

use crate::client::DebugSession;

/// Sends `next` `steps` times, and returns the answers to `expressions`.
fn evaluated(test: &str, steps: usize, expressions: &[&str]) -> Vec<String> {
    let mut session = DebugSession::launched(test);
    session.requests(&["configurationDone"]);
    session.requests(&vec!["next"; steps]);
    let ask = |expression: &&str| {
        session.request("evaluate", json!({ "expression": expression, "frameId": 1, "context": "hover" }))
    };
    let seqs: Vec<i64> = expressions.iter().map(ask).collect();
    let messages = session.end();
    let result = |seq: i64| match messages.response(seq)["success"] == true {
        true => messages.body(seq)["result"].as_str().unwrap().to_owned(),
        false => format!("error: {}", messages.refusal(seq)),
    };
    seqs.into_iter().map(result).collect()
}

#[test]
fn a_condition_says_which_of_its_operands_hold() {
    let found = evaluated(
        "why_not",
        2,
        &[
            "bumper AND wait 2s OR atIsection 1000",
            "(bumper  AND wait 2s)",
            "bumper",
            "wait",
            "wait 100s",
            "Shake",
            "go",
        ],
    );
    assert_eq!(
        found,
        [
            "does not hold; `bumper` holds; `wait 2` does not hold: 1 s of 2 s have passed; `atIsection 1000` does not hold",
            "does not hold; `bumper` holds; `wait 2` does not hold: 1 s of 2 s have passed",
            "holds",
            "does not hold: 1 s of 2 s have passed",
            "does not hold: 1 s of 100 s have passed",
            "error: `Shake` is no condition of the atom or of a scope around it, and no operand of one",
            "error: `go` is no condition of the atom or of a scope around it, and no operand of one",
        ]
    );
}

/// A signal is a number and can neither hold nor fail; the answer lists the comparisons of the signal instead.
#[test]
fn a_number_shows_its_comparisons() {
    let plan = "{ P (r0 < 60cm OR NOT r0 < 3m AND bumper OR t > 9s)\n  (Atom (way > 2m) (go 20 0))\n}\n";
    let script = "{\"t\": 0}\n{\"t\": 1, \"fired\": [\"r0 < 3\"], \"way\": 1.5}\n{\"t\": 2, \"way\": 1.5}\n";
    let mut session = DebugSession::of("numbers", plan, script, &json!({ "stopOnEntry": true }));
    session.requests(&["configurationDone", "next", "next"]);
    let expressions = ["r0", "t", "way", "r0 < 3", "way > 2m", "60cm", "60", "r1"];
    let ask = |expression: &&str| session.request("evaluate", json!({ "expression": expression, "frameId": 1 }));
    let seqs: Vec<i64> = expressions.iter().map(ask).collect();
    let messages = session.end();
    let shown = seqs.into_iter().map(|seq| match messages.response(seq)["success"] == true {
        true => messages.body(seq)["result"].as_str().unwrap().to_owned(),
        false => "error".to_owned(),
    });
    assert_eq!(
        shown.collect::<Vec<_>>(),
        [
            "`r0 < 0.6` does not hold; `r0 < 3` holds",
            "`t > 9` does not hold: 1 s have passed",
            "`way > 2` does not hold: 1.5 m were driven",
            "holds",
            "does not hold: 1.5 m were driven",
            "error",
            "error",
            "error",
        ]
    );
}

#[test]
fn memories_and_records_are_seen() {
    let found = evaluated("memory", 4, &["RISING bumper", "wait 1s"]);
    assert_eq!(
        found,
        ["does not hold: its operand was never false before; `bumper` holds", "does not hold: 0 s of 1 s have passed"]
    );
    let found = evaluated("record", 9, &["after s1 atIsection 1000", "after s1 atIsection 1000 OR wait 5s"]);
    assert_eq!(
        found,
        [
            "does not hold",
            "does not hold; `after s1 atIsection 1000` does not hold; `wait 5` does not hold: 1 s of 5 s have passed"
        ]
    );
}

#[test]
fn a_frame_has_its_condition_what_it_keeps_and_the_turn() {
    let mut session = DebugSession::launched("variables");
    session.requests(&["configurationDone"]);
    session.requests(&["next"; 5]);
    let stack = session.request("stackTrace", json!({ "threadId": 1 }));
    let scopes: Vec<i64> = (1..=3).map(|frame| session.request("scopes", json!({ "frameId": frame }))).collect();
    let lists: Vec<i64> =
        (1..=12).map(|list| session.request("variables", json!({ "variablesReference": list }))).collect();
    let beyond = session.request("scopes", json!({ "frameId": 4 }));
    let stale = session.request("variables", json!({ "variablesReference": 99 }));
    let messages = session.end();
    let shown: Vec<String> = scopes
        .iter()
        .zip(messages.stack(stack))
        .map(|(seq, frame)| {
            let groups = messages.body(*seq)["scopes"].as_array().unwrap().iter().map(|scope: &Value| {
                let list = scope["variablesReference"].as_u64().unwrap() as usize;
                format!("  {}: {}", scope["name"].as_str().unwrap(), messages.variables(lists[list - 1]).join("; "))
            });
            format!("{frame}\n{}", groups.collect::<Vec<_>>().join("\n"))
        })
        .collect();
    insta::assert_snapshot!(shown.join("\n"));
    assert_eq!(messages.refusal(beyond), "there is no such frame: the run has gone on");
    assert_eq!(messages.refusal(stale), "there are no such variables: the run has gone on");
}
