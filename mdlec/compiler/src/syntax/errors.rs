//! Converts the parser's errors to messages; each region gets one message. Common mistakes have their own messages; all
//! other messages name the expected and the unexpected tokens.

use std::cell::OnceCell;

use lalrpop_util::ParseError;

use super::mistakes;
use super::nodes::Recovery;
use super::regions::Regions;
use super::site::Site;
use super::source::FileText;
use super::token::{Tok, Token};
use crate::diagnostic::{Diagnostic, Edit};

/// Returns the messages about the errors from which the parser recovered.
pub(super) fn diagnostics(
    source: FileText<'_>,
    tokens: &[Token<'_>],
    regions: &mut Regions,
    recoveries: Vec<Recovery<'_>>,
) -> Vec<Diagnostic> {
    if recoveries.is_empty() {
        return Vec::new();
    }
    let end = tokens.len();
    let mut errors: Vec<_> = recoveries.into_iter().map(|recovery| place_of(recovery, end)).collect();
    errors.sort_by_key(|(at, _)| *at);
    let openers = openers(tokens);
    let plans = OnceCell::new();
    let mut diagnostics = Vec::new();
    for (at, expected) in errors {
        let site = Site { source, tokens, openers: &openers, plans: &plans, at, expected };
        if site.in_nameless_head() {
            // The missing name of the plan has been reported.
            continue;
        }
        if !regions.is_spoiled_once(site.decisive()) {
            let diagnostic = mistakes::known(&site).unwrap_or_else(|| site.unexpected());
            rewritten(source, tokens, &diagnostic).for_each(|token| regions.spoil_at(token));
            diagnostics.push(diagnostic);
        }
    }
    diagnostics
}

/// Returns the indices of the tokens that a message's edits replace.
fn rewritten(source: FileText<'_>, tokens: &[Token<'_>], diagnostic: &Diagnostic) -> impl Iterator<Item = usize> {
    let edits = diagnostic.help.iter().filter_map(|help| help.edit.as_ref());
    let first = |edit: &Edit| {
        let range = edit.span.within(source.id);
        let first = tokens.partition_point(|token| token.place.start < range.start);
        first..tokens.partition_point(|token| token.place.start < range.end)
    };
    edits.flat_map(first).collect::<Vec<_>>().into_iter()
}

/// Returns the index of the token at which the parser stopped, and the terminals that it expected.
fn place_of(recovery: Recovery<'_>, end: usize) -> (usize, Vec<String>) {
    match recovery.error {
        ParseError::UnrecognizedToken { token: (at, _, _), expected } => (at.token as usize, expected),
        ParseError::InvalidToken { location } => (location.token as usize, Vec::new()),
        ParseError::ExtraToken { token: (at, _, _) } => (at.token as usize, Vec::new()),
        ParseError::UnrecognizedEof { expected, .. } => (end, expected),
        ParseError::User { error } => match error {},
    }
}

/// Returns, for each token and for the end of the text, the index of the innermost open bracket before it; `None` if no
/// bracket is open.
fn openers(tokens: &[Token<'_>]) -> Vec<Option<usize>> {
    let mut open = Vec::new();
    let mut openers = Vec::with_capacity(tokens.len() + 1);
    for (at, token) in tokens.iter().enumerate() {
        openers.push(open.last().copied());
        #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are no brackets")]
        match token.kind {
            Tok::LBrace | Tok::LParen | Tok::TouchParen | Tok::ParamParen | Tok::ConditionParen => open.push(at),
            Tok::RBrace | Tok::RParen => drop(open.pop()),
            _ => {}
        }
    }
    openers.push(open.last().copied());
    openers
}
