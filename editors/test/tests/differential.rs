//! Tests that tree-sitter finds an error in a text if and only if mdlec finds a syntax error.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use mdle_compiler::diagnostic::{Code, SourceId};
use mdle_compiler::syntax::{arena_for, parse};
use mdle_editors_test::LANGUAGE;
use mdle_tests::chance::{Chance, repeated};
use mdle_tests::random_plan::RandomPlan;
use mdle_tests::texts;
use tree_sitter::{Parser, Tree};

fn parser() -> Parser {
    let mut parser = Parser::new();
    parser.set_language(&LANGUAGE.into()).unwrap();
    parser
}

fn tree(parser: &mut Parser, text: &str) -> Tree {
    parser.parse(text, None).unwrap()
}

/// Returns mdlec's messages about syntax errors in a text. Errors that a grammar cannot express are omitted: the
/// nesting depth of brackets, and missing parts of a file.
fn syntax_errors(text: &str) -> Vec<String> {
    let arena = arena_for(text);
    let (_, found) = parse(SourceId(0), text, &arena);
    let is_of_notation = |code: Code| !matches!(code, Code::E0106 | Code::E0107 | Code::E0108);
    found.into_iter().filter(|found| is_of_notation(found.code)).map(|found| found.message).collect()
}

/// Describes the difference if only one of tree-sitter and mdlec finds an error in a text; returns `None` if they
/// agree.
fn difference(parser: &mut Parser, text: &str) -> Option<String> {
    let (tree, errors) = (tree(parser, text), syntax_errors(text));
    let has_error = tree.root_node().has_error();
    (has_error == errors.is_empty()).then(|| {
        let by = if has_error { tree.root_node().to_sexp() } else { errors.join("; ") };
        format!("---- only {} finds an error: {by}\n{text}", if has_error { "tree-sitter" } else { "mdlec" })
    })
}

fn assert_none(differences: &[String]) {
    assert!(differences.is_empty(), "{} differences\n{}", differences.len(), differences.join("\n"));
}

#[test]
fn kept_texts_have_errors_for_both_or_for_none() {
    let mut parser = parser();
    let texts = texts::kept();
    assert!(texts.len() > 300);
    // The lexers that tree-sitter generates end every token at a NUL, even a comment.
    let texts = texts.iter().filter(|(_, text)| !text.contains('\0'));
    let differences = texts.filter_map(|(from, text)| Some(format!("{from}: {}", difference(&mut parser, text)?)));
    assert_none(&differences.collect::<Vec<_>>());
}

#[test]
fn random_plans_have_no_errors() {
    let mut parser = parser();
    let mut differences = Vec::new();
    for seed in 0..repeated(2_000) {
        let mut chance = Chance::new(seed);
        let text = RandomPlan::new(&mut chance, 12, false).with_commas(&mut chance);
        assert_eq!(syntax_errors(&text), [""; 0], "{text}");
        differences.extend(difference(&mut parser, &text));
    }
    assert_none(&differences);
}
