//! Reports mistakes with labels, colons and equals signs.

use super::plan_names::{name_before_plan, not_a_label};
use super::ranges::is_range;
use crate::alphabet::ParameterKind;
use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports `=` without a label, a label without `=`, and `=` instead of `==`.
pub(super) fn label_and_equals(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.found() == Some(Tok::Colon)
        && let Some(argument) = named_argument(site)
    {
        return Some(argument);
    }
    if site.found() == Some(Tok::Assign) {
        if let Some(parameter) = parameter_with_equals(site) {
            return Some(parameter);
        }
        if site.expects("==") {
            return Some(site.about(site.at, "`=` does not compare", "names a plan").fix(
                "to compare, write {}",
                site.span(site.at, site.at),
                "==",
            ));
        }
        if let Some(argument) = named_argument(site).or_else(|| named_arguments_of_law(site)) {
            return Some(argument);
        }
        let name = site.at.checked_sub(1).filter(|_| site.expects_element())?;
        let begins = matches!(site.kind(site.at + 1), Some(Tok::LParen | Tok::LBrace | Tok::ExecPlan | Tok::Frame));
        // The first name in braces is the name of the plan.
        let is_first = site.before(2) == Some(Tok::LBrace);
        if let (Some(text), true, Some(_)) = (site.name_at(name), begins && !is_first, site.opener()) {
            let diagnostic = site.about(site.at, format!("`{text} =` is not a label"), "expected a colon");
            let words = "a label has a colon: {}";
            return Some(diagnostic.fix(words, site.span(name, site.at), format!("{text}:")));
        }
        if let (Some(text), Some(_)) = (site.name_at(name), site.opener()) {
            let help = "a plan may take parameters: `{ Leg(d: length) (Atom (null) (goAvoid 0 d)) }`";
            let message = format!("`{text} =` is written in a plan, which has no variables");
            return Some(site.about(site.at, message, "not expected here").help(help));
        }
        return site.name_at(name).map(|text| not_a_label(site, name, text));
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "only labels and what follows them is looked at")]
    match site.before(1)? {
        Tok::Label(label) => {
            let message = format!("expected `=` after the label, found {}", site.found_words());
            let diagnostic = site.about(site.at, message, "not expected here");
            Some(if site.opener().is_some() {
                diagnostic.help(format!("a plan is used by the name inside its braces, not by its label `{label}`"))
            } else {
                diagnostic.help(format!("a label names the plan that follows: `{label} = {{ Name … }}`"))
            })
        }
        Tok::Assign if site.name_at(site.at).is_some() && site.kind(site.at + 1) == Some(Tok::LBrace) => {
            Some(name_before_plan(site, site.at))
        }
        Tok::Assign if site.expects("{") => Some(
            site.about(site.at, format!("expected `{{` after `=`, found {}", site.found_words()), "not expected here")
                .help("a label names a plan in braces: `Γ_from^to = { Name … }`"),
        ),
        _ => None,
    }
}

/// Reports `=` instead of a colon in a parameter, as in `{ Leg (far = length) …`.
fn parameter_with_equals(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let name = site.name_at(site.at.checked_sub(1)?)?;
    let kind = site.name_at(site.at + 1).filter(|kind| ParameterKind::NAMES.contains(kind))?;
    let is_header = site.opener()?.checked_sub(2).is_some_and(|brace| site.kind(brace) == Some(Tok::LBrace));
    let diagnostic = site.about(site.at, format!("`{name} =` is not a parameter"), "expected a colon");
    let words = "a parameter is its name, a colon and its type: {}";
    is_header.then(|| diagnostic.fix(words, site.span(site.at - 1, site.at + 1), format!("{name}: {kind}")))
}

/// Reports an argument with its name, as in `Leg(d = 3m)` and `Leg(d: 3m)`.
fn named_argument(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let name = site.at.checked_sub(1)?;
    let text = site.name_at(name).filter(|_| site.opener_kind() == Some(Tok::TouchParen))?;
    let (opener, plan) = (site.opener()?, site.opener()?.checked_sub(1)?);
    let sign = if site.found() == Some(Tok::Colon) { ":" } else { " =" };
    let (words, before) = (format!("remove `{text}{sign}`"), site.text(plan, name - 1));
    let is_first = opener + 1 == name;
    let diagnostic = site.about(site.at, "arguments have no names: they are given in order", "not expected here");
    Some(match before.filter(|_| is_first) {
        // The error affects the call as well, so the edit also covers the beginning of the call.
        Some(before) => diagnostic.fix(&words, site.span(plan, site.at), before),
        None => diagnostic.fix(&words, site.span(name, site.at), ""),
    })
}

/// Reports arguments of a law with their names, as in `(go v=20 omega=0)`.
fn named_arguments_of_law(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let first = site.at.checked_sub(1).filter(|_| site.expects_argument())?;
    let names = (first..).step_by(3).take_while(|at| {
        let is_value = matches!(site.kind(at + 2), Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_) | Tok::Name(_)));
        site.name_at(*at).is_some() && site.kind(at + 1) == Some(Tok::Assign) && is_value
    });
    let values = names.map(|at| site.text(at + 2, at + 2)).collect::<Option<Vec<_>>>()?;
    let last = (first + 3 * values.len()).checked_sub(1).filter(|last| *last > site.at)?;
    if is_range(site, first) {
        // An equation between two ranges, as in `align r_7 = r_9`, whose arguments are both sides.
        let text = site.text(first, last)?.replace('=', " ");
        let both = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let message = "arguments are given in order, without `=`";
        let diagnostic = site.about(site.at, message, "not expected here");
        return Some(diagnostic.fix("write {}", site.span(first, last), both));
    }
    let diagnostic = site.about(site.at, "arguments have no names: they are given in order", "not expected here");
    Some(diagnostic.fix("write the values alone: {}", site.span(first, last), values.join(" ")))
}

/// Reports a label in quotes, as in `"there": (Atom …)`.
pub(super) fn label_in_quotes(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let Some(Tok::Str(text)) = site.found() else { return None };
    let is_name = text.starts_with(char::is_alphabetic) && text.chars().all(|c| c.is_alphanumeric() || c == '_');
    let is_label = site.kind(site.at + 1) == Some(Tok::Colon) && site.expects_element();
    (is_name && is_label).then(|| {
        let diagnostic = site.about(site.at, "a label is a name, and has no quotes", "not expected here");
        diagnostic.fix("write {}", site.span(site.at, site.at + 1), format!("{text}:"))
    })
}

/// Reports a label without an element after it.
pub(super) fn label_behind(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let label = site.at.checked_sub(2).and_then(|at| site.name_at(at))?;
    (site.before(1) == Some(Tok::Colon) && site.expects_element()).then(|| {
        site.about(site.at - 2, format!("nothing follows the label `{label}`"), "it names what follows it")
            .help(format!("a label is written before its element: `{label}: (Atom (bumper) stop)`"))
    })
}

/// Reports parentheses or quotes around the label of an `after`, as in `after (ahead)` and `after "ahead"`.
pub(super) fn label_of_after(site: &Site<'_, '_>) -> Option<Diagnostic> {
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens hold no name")]
    let (label, last) = match site.found()? {
        Tok::Str(text) => (text, site.at),
        Tok::LParen if site.kind(site.at + 2) == Some(Tok::RParen) => (site.name_at(site.at + 1)?, site.at + 2),
        _ => return None,
    };
    let is_name = label.starts_with(char::is_alphabetic) && label.chars().all(|c| c.is_alphanumeric() || c == '_');
    is_name.then(|| {
        let diagnostic = site.about(site.at, "the label after `after` is a plain name", "expected a name");
        diagnostic.fix("write {}", site.span(site.at - 1, last), format!("after {label}"))
    })
}
