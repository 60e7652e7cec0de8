//! Tests definition, references and rename across files.
#![allow(clippy::disallowed_methods, reason = "a test makes files")]

use std::fs;

use lsp_types as lsp;
use serde_json::{Value, json};

use crate::client::{Client, folder};

const LEG: &str = "{ Leg(v: speed) (Atom (bumper) (go v 0)) }\n";
const MAIN: &str = "use \"leg.mdle\"\n{ Main (wait 9) a: Leg(20)\n  (Atom (after a) stop) Leg(30) }\n";

/// Writes `LEG` to a file, and opens `MAIN`; returns the client and the URIs of `LEG` and `MAIN`.
fn opened(test: &str) -> (Client, String, String) {
    let folder = folder(test);
    fs::write(folder.join("leg.mdle"), LEG).unwrap();
    let [leg, main] = ["leg.mdle", "main.mdle"].map(|name| format!("file://{}", folder.join(name).display()));
    let client = Client::new();
    client.open(&main, MAIN);
    (client, leg, main)
}

fn at(uri: &str, line: u32, character: u32) -> Value {
    json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": character } })
}

#[test]
fn a_definition_is_found_in_another_file() {
    let (mut client, leg, main) = opened("definition");
    let location: lsp::Location = client.ask("textDocument/definition", at(&main, 1, 20));
    assert_eq!((location.uri.as_str(), location.range.start.character), (leg.as_str(), 2));
    let location: lsp::Location = client.ask("textDocument/definition", at(&main, 0, 8));
    assert_eq!(location.uri.as_str(), leg);
    let location: lsp::Location = client.ask("textDocument/definition", at(&main, 2, 15));
    assert_eq!((location.range.start.line, location.range.start.character), (1, 16));
    let none: Option<lsp::Location> = client.ask("textDocument/definition", at(&main, 2, 19));
    assert!(none.is_none());
}

#[test]
fn references_are_found_in_all_files() {
    let (mut client, leg, main) = opened("references");
    let mut params = at(&main, 1, 20);
    params["context"] = json!({ "includeDeclaration": true });
    let found: Vec<lsp::Location> = client.ask("textDocument/references", params.clone());
    let places: Vec<_> = found.iter().map(|place| (place.uri.as_str(), place.range.start.line)).collect();
    assert_eq!(places, [(leg.as_str(), 0), (main.as_str(), 1), (main.as_str(), 2)]);
    params["context"] = json!({ "includeDeclaration": false });
    assert_eq!(client.ask::<Vec<lsp::Location>>("textDocument/references", params).len(), 2);
    let marked: Vec<lsp::DocumentHighlight> = client.ask("textDocument/documentHighlight", at(&main, 1, 20));
    assert_eq!(marked.len(), 2);
}

/// Edits by file; each edit is given by the line and the column of its start.
type Edits = Vec<(String, Vec<(u32, u32)>)>;

/// Returns the edits of a rename; `Err` contains the reason why it is refused.
fn rename(client: &mut Client, mut params: Value, name: &str) -> Result<Edits, String> {
    params["newName"] = json!(name);
    let request = client.request("textDocument/rename", params);
    let edit: lsp::WorkspaceEdit =
        serde_json::from_value(client.answer(request).map_err(|error| error.message)?).unwrap();
    let start = |edit: &lsp::TextEdit| (edit.range.start.line, edit.range.start.character);
    let mut changes: Vec<_> = edit
        .changes
        .unwrap()
        .into_iter()
        .map(|(uri, edits)| (uri.as_str().rsplit('/').next().unwrap().to_owned(), edits.iter().map(start).collect()))
        .collect();
    changes.sort();
    Ok(changes)
}

#[test]
fn a_rename_reaches_all_files() {
    let (mut client, _, main) = opened("rename");
    let ready: lsp::PrepareRenameResponse = client.ask("textDocument/prepareRename", at(&main, 1, 20));
    assert!(
        matches!(ready, lsp::PrepareRenameResponse::RangeWithPlaceholder { placeholder, .. } if placeholder == "Leg")
    );
    let changes = rename(&mut client, at(&main, 1, 20), "Stretch").unwrap();
    assert_eq!(changes, [("leg.mdle".to_owned(), vec![(0, 2)]), ("main.mdle".to_owned(), vec![(1, 19), (2, 24)])]);
    let changes = rename(&mut client, at(&main, 2, 15), "there").unwrap();
    assert_eq!(changes, [("main.mdle".to_owned(), vec![(1, 16), (2, 15)])]);
}

#[test]
fn a_rename_that_changes_a_meaning_is_refused() {
    let (mut client, leg, main) = opened("refused");
    client.open(&leg, "{ Leg(v: speed, w: file) (Atom (bumper) (go v 0)) (Atom (playing song OR bumper) (play w)) }\n");
    client.open(
        &main,
        "use \"leg.mdle\"\n{ Main (wait 9) a: Leg(20, \"x\") b: Leg(30, \"x\")\n  (Atom (after a) stop) }\n",
    );
    for (params, name, reason) in [
        (at(&main, 1, 20), "go", "a plan cannot be called that"),
        (at(&main, 1, 20), "Main", "contains itself"),
        (at(&main, 1, 20), "a b", "is no name"),
        (at(&main, 1, 16), "b", "there are two labels"),
        (at(&leg, 0, 6), "w", "there are two parameters"),
        (at(&main, 2, 18), "x", "only plans, parameters and labels"),
    ] {
        let refused = rename(&mut client, params, name).unwrap_err();
        assert!(refused.contains(reason), "{name}: {refused}");
    }
}
