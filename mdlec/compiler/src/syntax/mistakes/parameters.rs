//! Reports mistakes in the list of a plan's parameters.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports a malformed list of parameters.
pub(super) fn parameters(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.opener_kind() != Some(Tok::ParamParen) {
        return None;
    }
    let mistakes: [fn(&Site<'_, '_>) -> Option<Diagnostic>; 3] = [default_value, condition_in_list, colon_of_type];
    mistakes.iter().find_map(|mistake| mistake(site)).or_else(|| {
        let expected = if site.before(1) == Some(Tok::Comma) { "a parameter".to_owned() } else { site.expectation() };
        let message = format!("expected {expected}, found {}", site.found_words());
        Some(site.about(site.at, message, "not expected here").help("parameters are written `(v: speed, t: time)`"))
    })
}

/// Reports a default value of a parameter, as in `(far: length = 1m)`.
fn default_value(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let value = matches!(site.kind(site.at + 1), Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_) | Tok::Name(_)));
    (site.found() == Some(Tok::Assign) && site.before(2) == Some(Tok::Colon) && value).then(|| {
        let diagnostic = site.about(site.at, "a parameter has no default value", "not expected here");
        let words = "remove it: each use of the plan gives the values of all parameters, as in `Leg(3m)`";
        diagnostic.fix(words, site.span(site.at, site.at + 1), "")
    })
}

/// Reports a condition in the list of parameters, as in `(bumper, speed: speed)`.
fn condition_in_list(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (opener, first) = (site.opener()?, site.at.checked_sub(1)?);
    let name = site.name_at(first).filter(|_| site.found() == Some(Tok::Comma) && opener + 1 == first)?;
    let end = site.end_of_group(opener);
    let rest = site.text(site.at + 1, end).filter(|_| site.kind(end) == Some(Tok::RParen))?;
    let end_of_plan = site.end_of_group(opener.checked_sub(2)?);
    let is_used = (end + 1..end_of_plan).any(|at| site.name_at(at) == Some(name));
    let diagnostic = site.about(first, format!("the parameter `{name}` has no type"), "a colon and a type are missing");
    let words = "if it is the condition of the plan, give it parentheses of its own: {}";
    Some(match is_used {
        true => diagnostic.help(format!("a type follows each name: `({name}: length, {rest}`")),
        false => diagnostic.fix(words, site.span(opener, end), format!("({rest} ({name})")),
    })
}

/// Reports a parameter without its colon, as in `(a: length, b speed)`.
fn colon_of_type(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (name, kind) = (site.name_at(site.at.checked_sub(1)?)?, site.name_at(site.at)?);
    matches!(site.before(2), Some(Tok::Comma | Tok::ParamParen)).then(|| {
        let diagnostic = site.about(site.at, format!("a colon is missing between `{name}` and its type"), "a type");
        diagnostic.fix("write {}", site.span(site.at - 1, site.at), format!("{name}: {kind}"))
    })
}
