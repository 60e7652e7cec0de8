//! Reports mistakes in atoms, where a condition or a law is missing or in the wrong place.

use super::commas;
use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports an atom whose condition is not in parentheses, as in `(Atom bumper stop)`.
pub(super) fn atom_condition(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.before(1) != Some(Tok::Atom) {
        return None;
    }
    if site.found() == Some(Tok::RParen) {
        let diagnostic = site.about(site.at - 1, "this atom is empty", "a condition and a law are missing");
        return Some(diagnostic.help("an atom is a condition and a law: `(Atom (bumper) stop)`"));
    }
    if let (Some(label), Some(Tok::Colon)) = (site.name_at(site.at), site.kind(site.at + 1)) {
        let message = format!("the label `{label}` is inside its atom");
        let diagnostic = site.about(site.at, message, "not expected here");
        let words = format!("a label is written before its element: `{label}: (Atom …)`");
        return Some(diagnostic.fix(&words, site.span(site.at - 2, site.at + 1), format!("{label}: (Atom")));
    }
    let last = end_of_call(site, site.at);
    let diagnostic = site.about(site.at, "the condition of an atom is written in parentheses", "expected `(`");
    let Some(call) = site.name_at(site.at).and_then(|_| site.text(site.at, last)) else {
        return Some(diagnostic.help("an atom is a condition and a law: `(Atom (bumper) stop)`"));
    };
    let group = last + 1;
    if site.kind(group) == Some(Tok::LParen) {
        let end = site.end_of_group(group);
        if let (Some(text), Some(Tok::RParen)) = (site.text(group, end), site.kind(end + 1)) {
            let both = site.span(site.at - 1, end);
            let diagnostic = diagnostic.fix("write {}", both, format!("Atom ({call}) {text}"));
            if call == "wait" || call.starts_with("wait ") {
                return Some(diagnostic);
            }
            let words = format!("or, if `{call}` is the law, put it last: {{}}");
            return Some(diagnostic.fix(&words, both, format!("Atom {text} {call}")));
        }
    }
    let span = site.span(site.at - 1, last);
    if site.name_at(site.at).is_some_and(is_law) {
        let message = format!("this atom has no condition: `{call}` is a law");
        let diagnostic = site.about(site.at, message, "a condition is missing before this");
        let both = format!("Atom ({}) {call}", condition_for(call));
        return Some(diagnostic.fix("an atom is a condition and a law: {}", span, both));
    }
    Some(diagnostic.fix("write {} and a law", span, format!("Atom ({call})")))
}

/// Two lists: laws that complete by themselves, and laws that never complete.
const LAWS: [&[&str]; 2] = [&["advance", "align", "Follow", "goAvoid", "path", "rotate", "turn"], &["go", "stop"]];

/// Returns `true` if a name is the name of a law in the paper or in `mdle-atoms`. The alphabet is not used, because the
/// parser has none.
fn is_law(name: &str) -> bool {
    LAWS.iter().any(|laws| laws.contains(&name))
}

/// Returns an example of a condition for an atom whose law is this call.
fn condition_for(call: &str) -> &'static str {
    let name = call.split(|letter: char| !letter.is_alphanumeric()).next().unwrap_or("");
    if LAWS[0].contains(&name) { "null" } else { "wait 10" }
}

/// Returns the index of the only parentheses in an atom, and the call in them; `None` if the call is not a law.
fn law_in_group<'s>(site: &Site<'_, 's>, group: usize) -> Option<(usize, &'s str)> {
    let end = site.at.checked_sub(1).filter(|end| *end > group + 1 && site.end_of_group(group) == *end)?;
    let is_only = site.kind(group) == Some(Tok::LParen) && site.name_at(group + 1).is_some_and(is_law);
    site.text(group + 1, end - 1).filter(|_| is_only).map(|law| (group, law))
}

/// Reports a law after its atom, as in `(Atom (bumper)) (go 20 0)`.
fn law_outside(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let first = site.at + 1;
    let (name, last) = match site.kind(first)? == Tok::LParen {
        true => (first + 1, site.end_of_group(first)),
        false => (first, end_of_call(site, first)),
    };
    let is_call = site.kind(first) == Some(Tok::Name(site.name_at(name)?)) || site.is_call(name, last.checked_sub(1)?);
    let law = site.text(first, last).filter(|_| is_call && site.name_at(name).is_some_and(is_law))?;
    let diagnostic = site.about(site.at, "the law of this atom is outside of its parentheses", "closes the atom");
    Some(diagnostic.fix("move this `)` after the law: {}", site.span(site.at, last), format!(" {law})")))
}

/// Returns the index of the last token of a call: a name and the numbers that follow it.
pub(super) fn end_of_call(site: &Site<'_, '_>, name: usize) -> usize {
    if site.kind(name + 1) == Some(Tok::TouchParen) {
        return site.end_of_group(name + 1);
    }
    let is_literal = |at: &usize| matches!(site.kind(*at), Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_)));
    (name + 1..).take_while(is_literal).last().unwrap_or(name)
}

/// Reports several laws in an atom, as in `(Atom (wait 5) ((go 20 0) (turn 90)))`.
fn several_laws(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (group, is_law) = (site.opener()?, site.expects("name") && !site.expects_condition());
    let in_atom = site.kind(site.opener_of(group)? + 1) == Some(Tok::Atom) && site.kind(group - 1) == Some(Tok::RParen);
    (site.found() == Some(Tok::LParen) && site.before(1) == Some(Tok::LParen) && is_law && in_atom).then(|| {
        let diagnostic = site.about(site.at, "the law of an atom has one pair of parentheses", "not expected here");
        diagnostic.help("an atom has one law; a second law needs an atom of its own: `(Atom (bumper) stop)`")
    })
}

/// Reports an atom without a law, or with text after the law.
pub(super) fn atom_law(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if let Some(laws) = several_laws(site) {
        return Some(laws);
    }
    if !site.in_atom() || site.before(1) == Some(Tok::Atom) {
        return None;
    }
    let atom = site.opener()? + 1;
    if site.found() == Some(Tok::RParen) {
        if let Some((group, law)) = law_in_group(site, atom + 1) {
            let message = format!("this atom has no condition: `{law}` is a law");
            let diagnostic = site.about(group, message, "a condition is missing before this");
            let words = "an atom is a condition and a law: {}";
            let both = format!("({}) ({law})", condition_for(law));
            return Some(diagnostic.fix(words, site.span(group, site.at - 1), both));
        }
        if let Some(outside) = law_outside(site) {
            return Some(outside);
        }
        let diagnostic = site.about(site.at, "this atom has no law", "a law is missing before this");
        return Some(
            site.also(diagnostic, atom, "in this atom")
                .help("an atom is a condition and a law: `(Atom (bumper) stop)`"),
        );
    }
    if let Some(law) = law_in_braces(site) {
        return Some(law);
    }
    if site.found() == Some(Tok::LBrace) {
        let diagnostic = site.about(site.at, "an atom runs a law, not a plan", "not expected here");
        let help = "a behavior has a name and an interrupt of its own, and no `Atom`: `{ Inner (wait 5) (Atom (bumper) stop) }`";
        return Some(site.also(diagnostic, atom, "in this atom").help(help));
    }
    if !site.expects(")") {
        return None;
    }
    let diagnostic = site.about(
        site.at,
        format!("expected the `)` of this atom, found {}", site.found_words()),
        "not expected here",
    );
    let diagnostic = site.also(diagnostic, atom, "in this atom");
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens need no other hint")]
    Some(match site.found()? {
        Tok::Caret => diagnostic.help("a power follows the atom's parenthesis: `(Atom (wait 5) stop)^3`"),
        Tok::Comma => commas::in_law(site, diagnostic),
        _ => {
            let law = second_law(site).unwrap_or_else(|| "(Atom (bumper) stop)".to_owned());
            let words = "an atom is one condition and one law; a second law needs an atom of its own";
            diagnostic.help(format!("{words}: `{law}`"))
        }
    })
}

/// Returns the text of a new atom for a second law, such as `(turn 90)`, that follows the law of an atom.
fn second_law(site: &Site<'_, '_>) -> Option<String> {
    let (first, last) = (site.at + 1, site.end_of_group(site.at).checked_sub(1)?);
    let is_law = site.found() == Some(Tok::LParen) && site.name_at(first).is_some_and(is_law);
    let law = site.text(first, last).filter(|_| is_law && site.is_call(first, last))?;
    Some(format!("(Atom ({}) {law})", condition_for(law)))
}

/// Reports a law in braces, as in `(Atom (wait 5s) { go 20 0 })`.
fn law_in_braces(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (first, end) = (site.at + 1, site.end_of_group(site.at));
    let last = end.checked_sub(1).filter(|last| *last >= first && site.kind(end) == Some(Tok::RBrace))?;
    let is_law = site.found() == Some(Tok::LBrace) && site.name_at(first).is_some_and(is_law);
    let law = site.text(first, last).filter(|_| is_law && site.is_call(first, last))?;
    let diagnostic = site.about(site.at, "the law of an atom is written in parentheses", "no brace is expected here");
    Some(diagnostic.fix("write {}", site.span(site.at, end), format!("({law})")))
}
