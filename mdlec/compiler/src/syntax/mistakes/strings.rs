//! Reports strings of the paper outside of all plans that lack their mark, and marks without a string.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// A string of the paper, for help texts.
const EXAMPLE: &str = "`((go(20, 0), bumper)(turn(90), null), null)σ_null`";

/// Reports a string outside of all plans without `σ_null` after it, as in `((u, ξ)(u, ξ), ξ)`.
pub(super) fn string(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let end = site.end_of_group(site.at);
    let is_outer_comma = |at: usize| site.kind(at) == Some(Tok::Comma) && site.opener_of(at) == Some(site.at);
    let is_nested = site.kind(site.at + 1) == Some(Tok::LParen);
    if !is_nested && !(site.at..end).any(is_outer_comma) {
        return None;
    }
    let braces = "or a plan has braces around its atoms: `{ Name (Atom (bumper) stop) }`";
    let diagnostic = site.about(site.at, "expected a plan, found `(`", "outside of any plan");
    let (first, last) = (site.at, last_of_string(site, end));
    if site.kind(end) != Some(Tok::RParen) || !can_be_string(site, first, last) {
        return Some(diagnostic.help(format!("a string of the paper ends with its mark: {EXAMPLE}")).help(braces));
    }
    let gap = if site.kind(last) == Some(Tok::RParen) { "" } else { " " };
    let whole = site.text(first, last).map(|text| (first, text)).or_else(|| Some((last, site.text(last, last)?)));
    let (from, text) = whole?;
    let words = "a string of the paper ends with its mark: {}";
    Some(diagnostic.fix(words, site.span(from, last), format!("{text}{gap}σ_null")).help(braces))
}

/// Returns the index of the last token of the string whose first group ends at `end`: its powers and further groups
/// belong to it.
fn last_of_string(site: &Site<'_, '_>, end: usize) -> usize {
    let mut last = end;
    loop {
        last = match (site.kind(last + 1), site.kind(last + 2)) {
            (Some(Tok::Caret), Some(Tok::Number(_) | Tok::Infinity | Tok::Name(_))) => last + 2,
            (Some(Tok::LParen), _) => site.end_of_group(last + 1),
            (_, _) => return last,
        };
    }
}

/// Returns `true` if the tokens may be a string that lacks only its mark.
fn can_be_string(site: &Site<'_, '_>, first: usize, last: usize) -> bool {
    let is_other = |kind| matches!(kind, Some(Tok::SigmaNull | Tok::LBrace | Tok::RBrace | Tok::Assign));
    let is_plain = !(first..=last).any(|at| is_other(site.kind(at)));
    is_plain && matches!(site.kind(last + 1), None | Some(Tok::LBrace | Tok::Use | Tok::Label(_)))
}

/// Reports a `σ_null` outside of all plans that no string precedes.
pub(super) fn mark(site: &Site<'_, '_>) -> Diagnostic {
    let found = site.found_words();
    let diagnostic = site.about(site.at, format!("no string is before this {found}"), "not expected here");
    match site.before(1) {
        Some(Tok::RBrace) => {
            diagnostic.fix("a plan in braces needs no mark: remove it", site.span(site.at, site.at), "")
        }
        Some(_) | None => diagnostic.help(format!("it ends a string of the paper: {EXAMPLE}")),
    }
}
