//! Tests the diagnostics that are published while a user types, in all files that a plan uses.
#![allow(clippy::disallowed_methods, reason = "a test makes files")]

use std::fs;

use serde_json::{Value, json};

use crate::client::{Client, codes, folder};

#[test]
fn a_diagnostic_has_its_help_its_places_and_its_page() {
    let mut client = Client::with_options(json!({ "book": "https://example.org/book/" }));
    client.open("untitled:1", "{ P (Atom (bumper) stop) }\n{ P (Atom (bumpr) stop) }");
    let found = client.diagnostics("untitled:1", Some(1));
    assert_eq!(codes(&found), ["E0203", "E0201"]);
    let related = found[0].related_information.as_ref().unwrap();
    assert_eq!((related[0].message.as_str(), related[0].location.range.start.line), ("the first one", 0));
    let page = found[1].code_description.as_ref().unwrap().href.as_str();
    assert_eq!(page, "https://example.org/book/messages.html#e0201");
    assert!(found[1].message.contains("\nhelp: did you mean `bumper`?"), "{}", found[1].message);
}

#[test]
fn unsaved_texts_of_used_files_are_checked() {
    let folder = folder("used");
    let [main, leg] = ["main.mdle", "leg.mdle"].map(|name| format!("file://{}", folder.join(name).display()));
    let mut client = Client::new();
    client.open(&main, "use \"leg.mdle\"\n{ Main (bumper) Leg }\n");
    assert_eq!(codes(&client.diagnostics(&main, Some(1))), ["E0205"]);
    client.open(&leg, "{ Leg (Atom (bumper) stop) }\n");
    assert_eq!(codes(&client.diagnostics(&main, Some(1))), [""; 0]);
    client.change(&leg, 2, json!([{ "text": "{ Leg (Atom (bumpr) stop) }\n" }]));
    assert_eq!(codes(&client.diagnostics(&leg, Some(2))), ["E0201"]);
    // The checks of both documents find the error, and it is published once.
    assert!(client.notified.is_empty());
}

#[test]
fn a_file_deleted_under_use_is_reported() {
    let folder = folder("deleted");
    let [main, leg] = ["main.mdle", "leg.mdle"].map(|name| folder.join(name));
    fs::write(&leg, "use \"main.mdle\"\n{ Leg (Atom (wait 1) stop) }\n").unwrap();
    let [uri, used] = [&main, &leg].map(|path| format!("file://{}", path.display()));
    let mut client = Client::new();
    client.open(&uri, "use \"leg.mdle\"\n{ Main (bumper) Leg }\n");
    assert_eq!(codes(&client.diagnostics(&used, None)), ["E0206"]);
    assert_eq!(codes(&client.diagnostics(&uri, Some(1))), [""; 0]);
    fs::remove_file(&leg).unwrap();
    client.notify("workspace/didChangeWatchedFiles", json!({ "changes": [] }));
    assert_eq!(codes(&client.diagnostics(&uri, Some(1))), ["E0205"]);
}

#[test]
fn the_robot_is_that_of_the_settings() {
    let folder = folder("robot");
    let uri = format!("file://{}", folder.join("plan.mdle").display());
    let mut client = Client::with_options(json!({ "target": "atrv" }));
    let text = "{ P (Atom (wait 5) (go 150 0)) }";
    client.open(&uri, text);
    assert_eq!(codes(&client.diagnostics(&uri, Some(1))), ["E0402"]);
    client.notify("workspace/didChangeConfiguration", json!({ "settings": { "mdle": { "target": "" } } }));
    assert_eq!(codes(&client.diagnostics(&uri, Some(1))), [""; 0]);
    // The file next to the plan takes precedence over the client's settings.
    fs::write(folder.join("mdle.toml"), "target = \"atrv\"\n").unwrap();
    client.notify("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(codes(&client.diagnostics(&uri, Some(1))), ["E0402"]);
    fs::write(folder.join("mdle.toml"), "target = \"atrw\"\n").unwrap();
    client.notify("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    let found = client.diagnostics(&uri, Some(1));
    assert!(found[0].message.contains("did you mean `atrv`?"), "{found:?}");
}

#[test]
fn a_closed_document_has_no_diagnostics() {
    let mut client = Client::new();
    client.open("untitled:1", "{ P (Atom (bumpr) stop) }");
    assert_eq!(codes(&client.diagnostics("untitled:1", Some(1))), ["E0201"]);
    client.notify("textDocument/didClose", json!({ "textDocument": { "uri": "untitled:1" } }));
    assert_eq!(codes(&client.diagnostics("untitled:1", None)), [""; 0]);
    let late = client.request(
        "textDocument/hover",
        json!({ "textDocument": { "uri": "untitled:1" }, "position": { "line": 0, "character": 0 } }),
    );
    assert_eq!(client.answer(late).unwrap_err().code, -32602);
}

#[test]
fn an_alphabet_is_checked_as_an_alphabet() {
    let mut client = Client::new();
    client.open("file:///tmp/alphabet.mdle", "target rover\ncontroll");
    let found = client.diagnostics("file:///tmp/alphabet.mdle", Some(1));
    assert_eq!(codes(&found), ["E0601"]);
    let _: Value = client.ask("shutdown", Value::Null);
}
