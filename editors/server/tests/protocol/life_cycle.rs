//! Tests the server from `initialize` to `exit`, and with clients that violate the protocol.

use lsp_types::Hover;
use mdle_language_server::ServeError;
use serde_json::{Value, json};

use crate::client::Client;

const HOVER: &str = "textDocument/hover";

#[test]
fn a_request_before_initialize_is_refused() {
    let mut client = Client::started();
    client.notify("textDocument/didOpen", json!({}));
    let early = client.request(HOVER, json!({}));
    assert_eq!(client.answer(early).unwrap_err().code, -32002);
    let _: lsp_types::InitializeResult = client.ask("initialize", json!({ "capabilities": {} }));
}

#[test]
fn after_shutdown_only_exit_is_taken() {
    let mut client = Client::new();
    let _: Value = client.ask("shutdown", Value::Null);
    let late = client.request(HOVER, json!({}));
    assert_eq!(client.answer(late).unwrap_err().code, -32600);
    client.notify("exit", Value::Null);
    assert!(client.end().is_ok());
}

#[test]
fn exit_without_shutdown_is_an_error() {
    let mut client = Client::new();
    client.notify("exit", Value::Null);
    assert!(matches!(client.end(), Err(ServeError::Vanished)));
}

#[test]
fn a_server_ends_with_its_client() {
    assert!(matches!(Client::new().end(), Err(ServeError::Vanished)));
    assert!(matches!(Client::started().end(), Err(ServeError::Vanished)));
}

#[test]
fn requests_that_make_no_sense_are_errors() {
    let mut client = Client::new();
    for (method, params, code) in [
        ("mdle/unknown", json!({}), -32601),
        (HOVER, json!({}), -32602),
        (HOVER, json!([1]), -32602),
        (HOVER, json!({ "textDocument": { "uri": "file:///no" }, "position": { "line": 0, "character": 0 } }), -32602),
        (HOVER, json!({ "textDocument": { "uri": "file:///no" }, "position": { "line": -1, "character": 0 } }), -32602),
    ] {
        let request = client.request(method, params);
        assert_eq!(client.answer(request).unwrap_err().code, code, "{method}");
    }
    // A notification has no answer, so these errors have no effect.
    client.notify("textDocument/didChange", json!({ "textDocument": 7 }));
    client.notify("textDocument/didClose", json!({}));
    client.open("file:///a.mdle", "{ P (Atom (bumper) stop) }");
    assert_eq!(client.diagnostics("file:///a.mdle", Some(1)), []);
}

#[test]
fn a_cancelled_request_that_waits_is_not_answered() {
    let mut client = Client::new();
    let text = format!("{{ P {} }}", "(Atom (bumper) (go 20 0))\n".repeat(3_000));
    client.open("file:///long.mdle", &text);
    let at = json!({ "textDocument": { "uri": "file:///long.mdle" }, "position": { "line": 0, "character": 20 } });
    let requests: Vec<_> = (0..40).map(|_| client.request(HOVER, at.clone())).collect();
    let last = *requests.last().unwrap();
    client.notify("$/cancelRequest", json!({ "id": last }));
    for request in requests.into_iter().filter(|request| *request != last) {
        // The refusal of the last request may arrive before any of these answers.
        loop {
            match client.receive() {
                lsp_server::Message::Response(answer) if answer.id == request.into() => {
                    let _: Option<Hover> = serde_json::from_value(answer.response_result.unwrap()).unwrap();
                    break;
                }
                lsp_server::Message::Response(answer) => {
                    assert_eq!((answer.id, answer.response_result.unwrap_err().code), (last.into(), -32800));
                }
                lsp_server::Message::Notification(_) => {}
                lsp_server::Message::Request(request) => panic!("{request:?}"),
            }
        }
    }
}
