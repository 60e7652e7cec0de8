//! Tests the start and end of a session, and launches that fail.

use mdle_debugger::ServeError;
use serde_json::{Value, json};

use crate::client::{DebugSession, PLAN, SCRIPT, served};

/// Returns the error message of a launch that fails.
fn refused(test: &str, plan: &str, script: &str, more: &Value) -> String {
    let session = DebugSession::of(test, plan, script, more);
    session.end().refusal(2).to_owned()
}

#[test]
fn a_launch_is_answered_before_the_client_sets_breakpoints() {
    let mut session = DebugSession::launched("order");
    session.requests(&["configurationDone", "threads", "terminate"]);
    let messages = session.end();
    let shown =
        messages.0.iter().map(|message| message["command"].as_str().or(message["event"].as_str()).unwrap().to_owned());
    assert_eq!(
        shown.collect::<Vec<_>>(),
        [
            "initialize",
            "launch",
            "initialized",
            "configurationDone",
            "stopped",
            "threads",
            "terminate",
            "terminated",
            "disconnect"
        ]
    );
    assert_eq!(messages.body(4)["threads"], json!([{ "id": 1, "name": "Tour" }]));
}

#[test]
fn a_plan_that_cannot_run_is_refused_with_its_messages() {
    let message = refused("faulty", "{ P (bumpr) (Atom (null) stop) }", SCRIPT, &json!({}));
    assert!(message.starts_with("error[E0201]: there is no interrupt called `bumpr`"), "{message}");
    assert!(message.ends_with("1 error"), "{message}");
    let message = refused("no_plan", PLAN, SCRIPT, &json!({ "plan": "Tuor" }));
    assert!(message.contains("has no plan `Tuor`; did you mean `Tour`?"), "{message}");
    let message = refused("no_robot", PLAN, SCRIPT, &json!({ "target": "scuot" }));
    assert!(message.contains("there is no target `scuot`"), "{message}");
    let message = refused("no_script", PLAN, SCRIPT, &json!({ "script": "nowhere.jsonl" }));
    assert!(message.contains("there is no file `nowhere.jsonl`"), "{message}");
    let message = refused("empty_script", PLAN, "\n", &json!({}));
    assert!(message.contains("the script has no turns"), "{message}");
    let message = refused("wrong_script", PLAN, "{\"t\":0,\"fired\":[\"bumpr\"]}", &json!({}));
    assert!(
        message.ends_with("script.jsonl:1: `bumpr` is no interrupt of the plan; did you mean `bumper`?"),
        "{message}"
    );
}

#[test]
fn requests_before_the_launch_and_unknown_ones_are_refused() {
    let mut session = DebugSession::launched("unknown");
    let unknown = session.request("readMemory", json!({}));
    let without = session.request("setBreakpoints", json!({ "breakpoints": [] }));
    let messages = session.end();
    assert_eq!(messages.refusal(unknown), "`readMemory` is no request that a plan can answer");
    assert!(messages.refusal(without).starts_with("the arguments cannot be read"), "{}", messages.refusal(without));
    let mut bytes = Vec::new();
    for message in [
        json!({ "seq": 1, "type": "request", "command": "threads" }),
        json!({ "seq": 2, "type": "request", "command": "attach" }),
        json!({ "seq": 3, "type": "request", "command": "launch" }),
        json!({ "seq": 4, "type": "request", "command": "disconnect" }),
    ] {
        let text = message.to_string();
        bytes.extend(format!("Content-Length: {}\r\n\r\n{text}", text.len()).bytes());
    }
    let (messages, ended) = served(bytes);
    assert!(ended.is_ok());
    assert_eq!(messages.refusal(1), "`threads` came before `launch`");
    assert_eq!(messages.refusal(2), "a plan is launched, with `program` and `script`");
    assert!(messages.refusal(3).starts_with("`launch` needs the paths `program` and `script`"));
}

#[test]
fn bytes_that_are_no_message_and_a_lost_client_are_errors() {
    assert!(matches!(served(Vec::new()).1, Err(ServeError::Vanished)));
    for bytes in [
        &b"hello\r\n\r\n"[..],
        b"Content-Length: x\r\n\r\n{}",
        b"Content-Length: 99999999999\r\n\r\n{}",
        b"\r\n\r\n",
        b"Content-Length: 3\r\n\r\n{{{",
        b"Content-Length: 2\r\n\r\n{}",
        b"Content-Length: 18\r\n\r\n{\"type\":\"request\"}",
    ] {
        let (_, ended) = served(bytes.to_vec());
        assert!(matches!(ended, Err(ServeError::Protocol(_))), "{}: {ended:?}", String::from_utf8_lossy(bytes));
    }
    assert!(matches!(served(b"Content-Length: 30\r\n\r\n{}".to_vec()).1, Err(ServeError::Vanished)));
}
