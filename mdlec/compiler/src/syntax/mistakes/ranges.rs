//! Reports ranges as functions of time where a law has its arguments, as in `align r_7(t) r_9(t)`.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports the range of a sonar that a law has as an argument, if the range is written as a function of time.
pub(super) fn range_of_time(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let range = site.at.checked_sub(1).filter(|range| is_range(site, *range))?;
    if !is_time(site, site.at) || in_condition(site) {
        return None;
    }
    let (first, last) = call(site, range)?;
    let written = site.text(first, last)?.replace("(t)", "");
    let written = if written.ends_with(')') { written } else { written.replace(',', "") };
    let message = format!("the arguments of `{}` are sonars, not functions of time", site.name_at(first)?);
    let diagnostic = site.about(site.at, message, "not expected here");
    Some(diagnostic.fix("write {}", site.span(first, last), written))
}

/// Returns the indices of the first and the last token of the call that has the range at `range` as an argument.
fn call(site: &Site<'_, '_>, range: usize) -> Option<(usize, usize)> {
    let opener = site.opener()?;
    if site.kind(opener) == Some(Tok::TouchParen) {
        let last = site.end_of_group(opener);
        return (last > range && site.kind(last) == Some(Tok::RParen)).then_some((opener.checked_sub(1)?, last));
    }
    let is_word = |at: &usize| matches!(site.kind(*at), Some(Tok::Name(_) | Tok::Number(_)));
    let first = (opener + 1..range).rev().take_while(is_word).last()?;
    let mut last = range;
    loop {
        last = match site.kind(last + 1) {
            Some(Tok::Name(_) | Tok::Number(_)) => last + 1,
            Some(Tok::TouchParen) if is_range(site, last) && is_time(site, last + 1) => last + 3,
            Some(Tok::Comma) if is_range(site, last + 2) => last + 2,
            Some(_) | None => return Some((first, last)),
        };
    }
}

/// Returns `true` if the token at `at` is the name of a range, such as `r_7` or `r7`.
pub(super) fn is_range(site: &Site<'_, '_>, at: usize) -> bool {
    let digits = site.name_at(at).and_then(|name| name.strip_prefix('r'));
    let digits = digits.map(|digits| digits.strip_prefix('_').unwrap_or(digits)).unwrap_or_default();
    !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
}

/// Returns `true` if `(t)` begins at `at`.
fn is_time(site: &Site<'_, '_>, at: usize) -> bool {
    site.kind(at) == Some(Tok::TouchParen) && site.text(at, at + 2) == Some("(t)")
}

/// Returns `true` if the site is in the condition of an atom.
fn in_condition(site: &Site<'_, '_>) -> bool {
    let openers = std::iter::successors(site.opener(), |opener| site.opener_of(*opener));
    openers
        .take_while(|opener| site.kind(*opener) != Some(Tok::LBrace))
        .any(|opener| opener.checked_sub(1).is_some_and(|before| site.kind(before) == Some(Tok::Atom)))
}
