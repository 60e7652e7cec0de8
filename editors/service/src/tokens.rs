//! Semantic tokens: parts of a document whose role follows only from the syntax tree.

use std::ops::Range;

use mdle_compiler::alphabet::DeclarationKind;

use crate::mentions::{Role, mentions};
use crate::view::View;

/// Names of the token kinds, a subset of the names in the protocol.
pub const KINDS: &[&str] =
    &["class", "parameter", "property", "function", "event", "variable", "type", "number", "string"];

/// A token with its kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// Byte range of the token.
    pub range: Range<usize>,
    /// Index of the token's kind in [`KINDS`].
    pub kind: usize,
    /// `true` if the token defines its name.
    pub is_definition: bool,
}

/// Returns the tokens of a document in order of position; each token is on one line.
#[must_use]
pub fn tokens(view: &View<'_>) -> Vec<Token> {
    let mentions = mentions(view.files, view.alphabet);
    let tokens = mentions.iter().filter_map(|mention| {
        let kind = match mention.role {
            Role::Plan => 0,
            Role::Parameter => 1,
            Role::Label => 2,
            Role::Quark(DeclarationKind::Control) => 3,
            Role::Quark(DeclarationKind::Interrupt) => 4,
            Role::Quark(DeclarationKind::Signal) => 5,
            Role::Type => 6,
            Role::Number(_) => 7,
            Role::Text => 8,
        };
        Some(Token { range: view.range(mention.span)?, kind, is_definition: mention.is_definition() })
    });
    let mut tokens: Vec<_> = tokens.collect();
    tokens.retain(|token| view.text.get(token.range.clone()).is_some_and(|text| !text.contains(['\n', '\r'])));
    tokens.sort_by_key(|token| (token.range.start, token.range.end));
    // A place that occurs twice has the meaning of its first occurrence.
    let mut end = 0;
    tokens.retain(|token| {
        let is_free = token.range.start >= end;
        end = end.max(token.range.end);
        is_free
    });
    tokens
}
