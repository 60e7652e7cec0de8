//! Tests that the text of a document follows the client's edits, which count columns in UTF-16 units.

use serde_json::{Value, json};

use crate::client::{Client, codes};

const URI: &str = "file:///tmp/synchronization.mdle";
const GOOD: &str = "/// 𝒜\n{ P (Atom (bumper) stop) }\n";

fn edit(start: (u32, u32), end: (u32, u32), text: &str) -> Value {
    let at = |(line, character)| json!({ "line": line, "character": character });
    json!({ "range": { "start": at(start), "end": at(end) }, "text": text })
}

#[test]
fn edits_are_made_one_after_the_other() {
    let mut client = Client::new();
    client.open(URI, GOOD);
    assert_eq!(codes(&client.diagnostics(URI, Some(1))), [""; 0]);
    client.change(URI, 2, json!([edit((1, 11), (1, 17), "bumpr"), edit((0, 4), (0, 6), "")]));
    let found = client.diagnostics(URI, Some(2));
    assert_eq!(codes(&found), ["E0201"]);
    assert_eq!((found[0].range.start.line, found[0].range.start.character), (1, 11));
    assert_eq!((found[0].range.end.line, found[0].range.end.character), (1, 16));
    client.change(URI, 3, json!([{ "text": "{ P (Atom (bumper) stop) } // 𝒜𝒜\n{ Q (Atom (bumpr) stop) }" }]));
    assert_eq!(codes(&client.diagnostics(URI, Some(3))), ["E0201"]);
}

#[test]
fn positions_behind_a_pair_of_units_count_both() {
    let mut client = Client::new();
    client.open(URI, "/* 𝒜 */ { P (Atom (bumpr) stop) }");
    assert_eq!(client.diagnostics(URI, Some(1))[0].range.start.character, 20);
}

#[test]
fn positions_past_an_end_are_edits_at_the_end() {
    let mut client = Client::new();
    client.open(URI, "{ P (Atom (bumper) stop)");
    assert_ne!(codes(&client.diagnostics(URI, Some(1))), [""; 0]);
    client.change(URI, 2, json!([edit((7, 7), (9, 9), " }")]));
    assert_eq!(codes(&client.diagnostics(URI, Some(2))), [""; 0]);
    // The second edit ends in the middle of a surrogate pair, and its end is before its start.
    client.change(URI, 3, json!([edit((0, 0), (0, 0), "/* 𝒜 */"), edit((0, 4), (0, 3), "")]));
    assert_eq!(codes(&client.diagnostics(URI, Some(3))), [""; 0]);
}

#[test]
fn an_edit_of_an_older_version_is_ignored() {
    let mut client = Client::new();
    client.open(URI, GOOD);
    client.change(URI, 9, json!([{ "text": "{ P (Atom (bumpr) stop) }" }]));
    client.change(URI, 4, json!([{ "text": "" }]));
    assert_eq!(codes(&client.diagnostics(URI, Some(9))), ["E0201"]);
    client.change(URI, 10, json!([{ "text": GOOD }]));
    assert_eq!(codes(&client.diagnostics(URI, Some(10))), [""; 0]);
    assert!(client.notified.is_empty());
}

#[test]
fn a_document_of_ten_megabytes_is_checked() {
    let mut client = Client::new();
    let text = format!("/* {} */\n{GOOD}", "𝒜 comment ".repeat(800_000));
    assert!(text.len() > 10_000_000);
    client.open(URI, &text);
    assert_eq!(codes(&client.diagnostics(URI, Some(1))), [""; 0]);
    client.change(URI, 2, json!([edit((2, 11), (2, 17), "bumpr")]));
    assert_eq!(client.diagnostics(URI, Some(2))[0].range.start.line, 2);
}
