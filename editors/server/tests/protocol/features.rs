//! Tests each language feature on a single document, through the protocol.

use lsp_types as lsp;
use serde_json::{Value, json};

use crate::client::Client;

const URI: &str = "file:///tmp/features.mdle";

/// Opens a text in a new client; `|` marks the cursor. Returns the client, and the parameters for requests at the
/// cursor.
fn at(text: &str) -> (Client, Value) {
    let client = Client::with_options(json!({ "target": "sim" }));
    let byte = text.find('|').expect("a cursor");
    let (before, text) = (&text[..byte], text.replacen('|', "", 1));
    client.open(URI, &text);
    let line = before.matches('\n').count();
    let character = before.rsplit('\n').next().unwrap_or("").encode_utf16().count();
    let position = json!({ "line": line, "character": character });
    (client, json!({ "textDocument": { "uri": URI }, "position": position }))
}

fn hover(text: &str) -> String {
    let (mut client, params) = at(text);
    let hover: Option<lsp::Hover> = client.ask("textDocument/hover", params);
    match hover.map(|hover| hover.contents) {
        None => String::new(),
        Some(lsp::HoverContents::Markup(markup)) => markup.value,
        Some(other) => panic!("{other:?}"),
    }
}

fn completions(text: &str) -> Vec<String> {
    let (mut client, params) = at(text);
    let found: Vec<lsp::CompletionItem> = client.ask("textDocument/completion", params);
    found.into_iter().map(|item| item.label).collect()
}

#[test]
fn a_quark_is_shown_with_its_signature() {
    let text = hover("{ P (Atom (bumper) (g|o 20 0)) }");
    assert!(text.starts_with("```text\nlaw go <v in cm/s>"), "{text}");
    assert!(hover("{ P (Atom (bump|er) stop) }").contains("Needs `bumper`: "));
    assert!(
        hover("{ P (Atom (r0| < 80cm) stop) }").contains("Measured in m"),
        "{}",
        hover("{ P (Atom (r0| < 80cm) stop) }")
    );
}

#[test]
fn a_keyword_is_shown_with_its_form() {
    assert_eq!(
        hover("{ P (At|om (bumper) stop) }"),
        "```text\n(Atom (interrupt) (law))\n```\nApplies the law in every turn, until the interrupt fires or the law completes."
    );
    assert!(hover("{ P (|Atom (bumper) stop) }").starts_with("```text\n(Atom"));
    assert!(hover("{ P FRAME| 90deg (Atom (bumper) stop) }").contains("counter-clockwise"));
    assert_eq!(hover("// Atom| as a word\n{ P (Atom (bumper) stop) }"), "");
}

#[test]
fn a_number_is_shown_in_the_default_unit() {
    assert_eq!(hover("{ P (Atom (wait 1.5|min) stop) }"), "1.5 min = 90 s");
    assert_eq!(
        hover("{ P (Atom (bumper) (go 2|0 0)) }"),
        "20 cm/s = 0.2 m/s\n\nA number without a unit is in cm/s here."
    );
}

#[test]
fn a_plan_is_shown_with_what_ends_and_follows_it() {
    let text = hover(
        "/// Shakes.\n{ P (wait 1min)\n  { Sha|ke (bumper OR wait 2s) (Atom (bumper) stop) }\n  (Atom (bumper) stop) }",
    );
    assert!(text.contains("or when `bumper OR wait 2s` fires"), "{text}");
    assert!(text.contains("Timers, from its own start: `wait 2s`"), "{text}");
    assert!(text.contains("Followed by `(Atom (bumper) stop)`"), "{text}");
    assert!(hover("{ P Le|g(20) }\n/// A leg.\n{ Leg(v: speed) (Atom (bumper) (go v 0)) }").contains("A leg."));
    assert!(hover("{ P a|: (Atom (bumper) stop)\n(Atom (after a bumper) stop) }").contains("in line 2"));
    assert!(
        hover("{ Leg(v: speed) (Atom (bumper) (go v| 0)) }")
            .contains("Parameter of `Leg`; a number without a unit is in cm/s")
    );
    assert_eq!(hover("{ P | (Atom (bumper) stop) }"), "");
}

#[test]
fn completion_proposes_what_fits() {
    let operands = completions("{ P (Atom (bu|");
    assert!(operands.contains(&"bumper".to_owned()) && operands.contains(&"r0".to_owned()), "{operands:?}");
    assert!(!operands.contains(&"go".to_owned()));
    let laws = completions("{ P (Atom (bumper) (|");
    assert!(laws.contains(&"go".to_owned()) && !laws.contains(&"bumper".to_owned()), "{laws:?}");
    assert_eq!(completions("{ P (Atom (bumper) (go 20|"), ["m/s", "cm/s", "mm/s", "in/s"]);
    assert_eq!(completions("{ P a: (Atom (bumper) stop) (Atom (after |) stop) }"), ["a"]);
    assert!(completions("{ P | }\n{ Leg (Atom (bumper) stop) }").contains(&"Leg".to_owned()));
    assert_eq!(completions("|"), ["plan", "use"]);
    assert_eq!(completions("// |"), [""; 0]);
}

#[test]
fn a_snippet_is_a_valid_element() {
    let (mut client, params) = at("{ P (bumper) A| }");
    let found: Vec<lsp::CompletionItem> = client.ask("textDocument/completion", params);
    let atom = found.iter().find(|item| item.label == "Atom").unwrap();
    assert_eq!(atom.insert_text_format, Some(lsp::InsertTextFormat::SNIPPET));
    let Some(lsp::CompletionTextEdit::Edit(edit)) = &atom.text_edit else { panic!("{atom:?}") };
    assert_eq!((edit.range.start.character, edit.range.end.character), (13, 14));
    assert_eq!(edit.new_text, "(Atom (${1:interrupt}) (${2:law}))");
}

#[test]
fn signature_help_marks_the_parameter() {
    let (mut client, params) = at("{ P (Atom (bumper) (go 20 |");
    let help: lsp::SignatureHelp = client.ask("textDocument/signatureHelp", params);
    assert_eq!(help.active_parameter, Some(1));
    assert_eq!(help.signatures[0].parameters.as_ref().unwrap().len(), 2);
    let (mut client, params) = at("{ P Leg(|) }\n{ Leg(v: speed) (Atom (bumper) (go v 0)) }");
    let help: lsp::SignatureHelp = client.ask("textDocument/signatureHelp", params);
    assert_eq!(help.signatures[0].label, "Leg(v: speed)");
}

#[test]
fn formatting_is_that_of_mdlec_fmt() {
    let (mut client, params) = at("|{ P  (Atom (bumper) stop)\n\n\n(Atom (bumper)   stop)}\n");
    let edits: Vec<lsp::TextEdit> = client.ask("textDocument/formatting", params);
    assert_eq!(edits.len(), 1);
    let (mut client, params) = at("|{ P (Atom (bumper stop) }");
    assert!(client.ask::<Option<Vec<lsp::TextEdit>>>("textDocument/formatting", params).is_none());
}

#[test]
fn a_range_is_formatted_beside_errors() {
    let (mut client, mut params) = at("{ A  (Atom (bumper)   stop) }|\n{ B (Atom (bumper stop) }\n");
    let start = json!({ "line": 0, "character": 0 });
    params["range"] = json!({ "start": start, "end": start });
    let edits: Vec<lsp::TextEdit> = client.ask("textDocument/rangeFormatting", params);
    let [edit] = edits.as_slice() else { panic!("{edits:?}") };
    assert_eq!((edit.range.start.line, edit.range.end.line), (0, 0));
}

#[test]
fn each_help_that_proposes_text_is_a_fix() {
    let (mut client, mut params) = at("{ P (Atom (bum|pr) stop) }");
    params["range"] = json!({ "start": params["position"], "end": params["position"] });
    params["context"] = json!({ "diagnostics": [] });
    let actions: Vec<lsp::CodeAction> = client.ask("textDocument/codeAction", params.clone());
    let [action] = actions.as_slice() else { panic!("{actions:?}") };
    let edits = action.edit.as_ref().unwrap().changes.as_ref().unwrap().values().next().unwrap();
    assert_eq!((edits[0].new_text.as_str(), edits[0].range.end.character), ("bumper", 16));
    assert_eq!(action.is_preferred, Some(true));
    params["context"] = json!({ "diagnostics": [], "only": ["refactor"] });
    assert!(client.ask::<Vec<lsp::CodeAction>>("textDocument/codeAction", params).is_empty());
}

#[test]
fn symbols_folds_and_selections_follow_the_tree() {
    let (mut client, mut params) = at("{ P (bumper)\n  { Q\n    a: (Atom (bum|per) stop)\n  }\n}\n");
    let symbols: Vec<lsp::DocumentSymbol> = client.ask("textDocument/documentSymbol", params.clone());
    assert_eq!((symbols[0].name.as_str(), symbols[0].detail.as_deref()), ("P", Some("(bumper)")));
    let inner = &symbols[0].children.as_ref().unwrap()[0];
    assert_eq!((inner.name.as_str(), inner.children.as_ref().unwrap()[0].name.as_str()), ("Q", "a"));
    let folds: Vec<lsp::FoldingRange> = client.ask("textDocument/foldingRange", params.clone());
    assert_eq!(folds.iter().map(|fold| (fold.start_line, fold.end_line)).collect::<Vec<_>>(), [(0, 4), (1, 3)]);
    params["positions"] = json!([params["position"]]);
    let chains: Vec<lsp::SelectionRange> = client.ask("textDocument/selectionRange", params);
    let mut widths = Vec::new();
    let mut next = chains.first();
    while let Some(selection) = next {
        widths.push((selection.range.start.line, selection.range.start.character));
        next = selection.parent.as_deref();
    }
    assert_eq!(widths, [(2, 14), (2, 13), (2, 4), (1, 2), (0, 0), (0, 0)]);
}

#[test]
fn hints_lenses_and_colours_are_shown() {
    let text = "|{ P\n  ExecPlan inf { (Atom (null) turn 90) }\n}\n{ Q P }\n";
    let (mut client, mut params) = at(text);
    params["range"] = json!({ "start": params["position"], "end": { "line": 9, "character": 0 } });
    let hints: Vec<lsp::InlayHint> = client.ask("textDocument/inlayHint", params.clone());
    let label = |hint: &lsp::InlayHint| match &hint.label {
        lsp::InlayHintLabel::String(label) => label.clone(),
        lsp::InlayHintLabel::LabelParts(parts) => panic!("{parts:?}"),
    };
    let hints: Vec<_> = hints.iter().map(|hint| (hint.position.character, label(hint))).collect();
    let expected = [(14, "never ends"), (34, "completes"), (37, "deg")];
    assert_eq!(hints, expected.map(|(character, label)| (character, label.to_owned())));
    let lenses: Vec<lsp::CodeLens> = client.ask("textDocument/codeLens", params.clone());
    let commands: Vec<_> = lenses.into_iter().map(|lens| lens.command.unwrap()).collect();
    assert_eq!(commands.iter().map(|command| command.title.as_str()).collect::<Vec<_>>(), ["Run", "Draw"]);
    for (command, expected) in commands.into_iter().zip(["mdlec", "<svg"]) {
        let answer: Value = client
            .ask("workspace/executeCommand", json!({ "command": command.command, "arguments": command.arguments }));
        assert!(answer.to_string().contains(expected), "{answer}");
    }
    let tokens: lsp::SemanticTokens = client.ask("textDocument/semanticTokens/full", params);
    let tokens: Vec<_> = tokens.data.iter().map(|token| (token.delta_line, token.length, token.token_type)).collect();
    assert_eq!(tokens, [(0, 1, 0), (1, 4, 3), (0, 2, 7), (2, 1, 0), (0, 1, 0)]);
}
