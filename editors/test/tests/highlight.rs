//! Tests the highlighting of the example plans by tree-sitter.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;

use mdle_editors_test::LANGUAGE;
use mdle_tests::repository::{files, root};
use tree_sitter::{Language, Query};
use tree_sitter_highlight::{HighlightConfiguration, HighlightEvent, Highlighter};

fn query(name: &str) -> String {
    std::fs::read_to_string(root().join("editors/tree-sitter/queries").join(name)).unwrap()
}

/// Returns a text in which each highlighted part is written as `⟨NAME part⟩`, where `NAME` is the name of its colour.
fn highlighted(text: &str) -> String {
    let mut config =
        HighlightConfiguration::new(LANGUAGE.into(), "mdle", &query("highlights.scm"), "", &query("locals.scm"))
            .unwrap();
    let names: Vec<String> = config.names().iter().map(|name| (*name).to_owned()).collect();
    config.configure(&names);
    let mut highlighter = Highlighter::new();
    let events = highlighter.highlight(&config, text.as_bytes(), None, None, |_| None).unwrap();
    let (mut shown, mut open) = (String::new(), Vec::new());
    for event in events {
        match event.unwrap() {
            HighlightEvent::HighlightStart(highlight) => open.push(names[highlight.0].clone()),
            HighlightEvent::HighlightEnd => drop(open.pop()),
            HighlightEvent::Source { start, end } => {
                let part = &text[start..end];
                match open.last() {
                    Some(name) => write!(shown, "⟨{name} {part}⟩").unwrap(),
                    None => shown += part,
                }
            }
        }
    }
    shown
}

#[test]
fn plans_are_highlighted() {
    let plans: Vec<_> = files(&[".mdle"]).into_iter().filter(|file| file.path.starts_with("plans/")).collect();
    assert!(plans.len() > 10);
    let shown = plans.iter().map(|plan| format!("==== {}\n{}", plan.path, highlighted(&plan.text)));
    insta::assert_snapshot!(shown.collect::<String>());
}

#[test]
fn queries_name_nodes_of_the_grammar() {
    let language: Language = LANGUAGE.into();
    for name in ["highlights.scm", "folds.scm", "indents.scm", "locals.scm"] {
        assert!(Query::new(&language, &query(name)).unwrap().pattern_count() > 0, "{name}");
    }
}
