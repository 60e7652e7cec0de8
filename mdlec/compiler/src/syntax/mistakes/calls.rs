//! Reports calls of laws, interrupts and plans that are unexpected or malformed.

use super::atoms::end_of_call;
use super::spelling;
use crate::alphabet::Unit;
use crate::diagnostic::Diagnostic;
use crate::syntax::number::split;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports square brackets, as in `r[0]` and `[bumper]`.
pub(super) fn square_brackets(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.found() != Some(Tok::LBracket) {
        return None;
    }
    let end = (site.at + 1..site.at + 16).find(|at| site.kind(*at) == Some(Tok::RBracket));
    let is_inside = |end: &usize| *end > site.at + 1 && site.opener().is_some();
    let inside = end.filter(is_inside).and_then(|end| site.text(site.at + 1, end - 1));
    let diagnostic = site.about(site.at, "MDLe has no square brackets here", "not expected here");
    Some(match (end, inside, site.at.checked_sub(1)) {
        (Some(end), Some(inside), Some(name))
            if end == site.at + 2
                && site.name_at(name).is_some()
                && site.touches_next(name)
                && matches!(site.kind(end - 1), Some(Tok::Name(_) | Tok::Number(_))) =>
        {
            let name_text = site.name_at(name).unwrap_or("");
            diagnostic.fix("arguments follow the name: {}", site.span(name, end), format!("{name_text} {inside}"))
        }
        (Some(_), _, Some(before)) if names_group(site, before) => diagnostic.help(super::groups::HEAD),
        (Some(end), Some(inside), _) if site.is_call(site.at + 1, end - 1) => {
            diagnostic.fix("use parentheses: {}", site.span(site.at, end), format!("({inside})"))
        }
        _ => diagnostic.help("conditions and arguments are written in parentheses: `(Atom (bumper) go(5, 0))`"),
    })
}

/// Returns `true` if the tokens before `before` are `{ group` or `{ Group Name`, after which robots may follow.
fn names_group(site: &Site<'_, '_>, before: usize) -> bool {
    let begins = |word: usize| {
        let is_named = site.name_at(word).is_some_and(|name| name.eq_ignore_ascii_case("group"));
        let is_group = is_named || site.kind(word) == Some(Tok::Group);
        is_group && word.checked_sub(1).is_some_and(|opener| site.kind(opener) == Some(Tok::LBrace))
    };
    begins(before) || before.checked_sub(1).is_some_and(begins)
}

/// Reports a decimal comma, as in `0,5`.
pub(super) fn decimal_comma(site: &Site<'_, '_>) -> Option<Diagnostic> {
    // The parser stops at the comma or at the digits after it.
    let comma = [Some(site.at), site.at.checked_sub(1)];
    let comma = comma.into_iter().flatten().find(|at| site.kind(*at) == Some(Tok::Comma))?;
    let whole = comma.checked_sub(1)?;
    let (Some(Tok::Number(left)), Some(Tok::Number(right))) = (site.kind(whole), site.kind(comma + 1)) else {
        return None;
    };
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let touches = site.touches_next(whole) && site.touches_next(comma);
    if !touches || !is_digits(left.trim_start_matches(['-', '+'])) || !is_digits(split(right).0) {
        return None;
    }
    let diagnostic = site.about(comma, format!("`{left},{right}` is not a number"), "not part of a number");
    let diagnostic =
        diagnostic.fix("a decimal number has a dot: {}", site.span(whole, comma + 1), format!("{left}.{right}"));
    // These have a single argument, a time.
    let name = whole.checked_sub(1).and_then(|at| site.name_at(at)).filter(|name| !["wait", "stuck"].contains(name));
    Some(match name {
        Some(name) => diagnostic.help(format!("or arguments have a space between them: `{name} {left} {right}`")),
        None => diagnostic,
    })
}

/// Reports arguments that are separated from the name of their plan, as in `Leg (3m)`.
pub(super) fn apart(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let paren = site.at.checked_sub(1)?;
    let name = paren.checked_sub(1)?;
    let plan = site.name_at(name)?;
    let is_literal = matches!(site.found(), Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_)));
    if !is_literal || site.kind(paren) != Some(Tok::LParen) || site.expects_condition() {
        return None;
    }
    if site.kind(site.at + 1) == Some(Tok::Colon) {
        let value = site.text(site.at, site.at).unwrap_or("this");
        let diagnostic = site.about(site.at, format!("`{value}` is not the name of a parameter"), "not a name");
        return Some(
            diagnostic
                .help("a parameter is a name, a colon and a type: `{ Leg(d: length) (Atom (null) (advance d)) }`"),
        );
    }
    let end = site.end_of_group(paren);
    let arguments = site.text(paren, end).unwrap_or("(…)");
    let message = format!("the arguments of `{plan}` do not touch its name");
    let diagnostic = site.about(paren, message, "remove the space before this");
    let words = format!("write `{plan}{arguments}`");
    Some(diagnostic.fix(&words, site.span(name, paren), format!("{plan}(")))
}

/// Reports a unit that is separated from its number, as in `0.5 m`.
pub(super) fn unit_apart(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (Some(Tok::Name(name)), Some(Tok::Number(number))) = (site.found(), site.before(1)) else { return None };
    if !split(number).1.is_empty() {
        return None;
    }
    Unit::from_name(name)?;
    let message = format!("there is a space between `{number}` and its unit `{name}`");
    let diagnostic = site.about(site.at, message, "remove the space before this unit");
    Some(diagnostic.fix("write {}", site.span(site.at - 1, site.at), format!("{number}{name}")))
}

/// Reports a quark where an element is expected, as in `{ A go 5 0 }`, `((wait 5) stop)` or `(r0 < 1m)`.
pub(super) fn bare_call(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let formal = site.expects(",") && site.expects_argument() && site.opener_kind() == Some(Tok::LParen);
    if formal {
        return in_parentheses(site);
    }
    if site.expects_element() && is_comparison(site.found()) && site.opener_kind() == Some(Tok::LParen) {
        return in_parentheses(site);
    }
    let (Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_)), Some(Tok::Name(name))) = (site.found(), site.before(1))
    else {
        return None;
    };
    let is_header = site.before(2) == Some(Tok::LBrace) && spelling(site).is_none();
    if !site.expects_element() || is_header {
        return None;
    }
    let last = end_of_call(site, site.at - 1);
    let call = site.text(site.at - 1, last).unwrap_or(name);
    let diagnostic = site.about(site.at, format!("`{call}` is not an element by itself"), "not expected here");
    if spelling(site).is_some() {
        return Some(diagnostic);
    }
    let args = call.strip_prefix(name).unwrap_or("").trim();
    let diagnostic = element(diagnostic, site, (site.at - 1, last), call);
    if site.has_plan(name) || name == "wait" {
        return Some(diagnostic);
    }
    let call = format!("{name}({args})");
    Some(diagnostic.fix("or, if it is a plan, write {}", site.span(site.at - 1, last), call))
}

/// Reports a quark or a comparison in parentheses where an element is expected.
fn in_parentheses(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let opener = site.opener()?;
    let end = site.end_of_group(opener);
    let inside = end.checked_sub(1).filter(|last| *last > opener && site.is_call(opener + 1, *last));
    let inside = inside.and_then(|last| site.text(opener + 1, last)).filter(|_| site.kind(end) == Some(Tok::RParen));
    let call = inside.or_else(|| site.text(opener + 1, site.at.checked_sub(1)?)).unwrap_or("this");
    let diagnostic = site.about(opener + 1, format!("`{call}` is not an element by itself"), "outside of an atom");
    if let Some(joined) = inside.and_then(|second| second_condition(site, opener, end, second)) {
        return Some(joined);
    }
    Some(match inside {
        Some(call) => element(diagnostic, site, (opener, end), call),
        None => diagnostic.help("an atom is a condition and a law: `(Atom (wait 5) (go 20 0))`"),
    })
}

/// Reports a second condition of a plan, as in `{ Name (bumper) (wait 10) …`.
fn second_condition(site: &Site<'_, '_>, opener: usize, end: usize, second: &str) -> Option<Diagnostic> {
    let closer = opener
        .checked_sub(1)
        .filter(|closer| site.partner(*closer) == Some(Tok::ConditionParen) && is_condition(second))?;
    let first = site.opener_of(closer)?;
    // If the second parentheses are on another line, they are an element.
    site.text(first, end)?;
    let condition = site.text(first + 1, closer - 1)?;
    let joined = match condition.contains(" AND ") || second.contains(" AND ") {
        true => format!("(({condition}) OR ({second}))"),
        false => format!("({condition} OR {second})"),
    };
    let diagnostic = site.about(opener, "a plan has one condition", "a second one");
    Some(diagnostic.fix("if one of them is enough, join them: {}", site.span(first, end), joined))
}

/// Returns `diagnostic` with help that proposes the atom that a call probably means.
fn element(diagnostic: Diagnostic, site: &Site<'_, '_>, (first, last): (usize, usize), call: &str) -> Diagnostic {
    let name = call.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("");
    let argument = call.strip_prefix(name).unwrap_or("").trim();
    if is_condition(call) {
        let atom = format!("(Atom ({call}) stop)");
        return diagnostic.fix("an interrupt is the condition of an atom: {}", site.span(first, last), atom);
    }
    if site.has_plan(name) {
        let call = format!("{name}({argument})");
        return diagnostic.fix(
            "the arguments of a plan are in parentheses that touch its name: {}",
            site.span(first, last),
            call,
        );
    }
    let atom = format!("(Atom (wait 5) ({call}))");
    diagnostic.fix("a law runs in an atom, until its condition fires: {}", site.span(first, last), atom)
}

/// Returns `true` if a call can only be a condition.
fn is_condition(call: &str) -> bool {
    let (name, argument) = call.split_once(' ').unwrap_or((call, ""));
    let is_bits = argument.len() >= 3 && argument.bytes().all(|byte| matches!(byte, b'0' | b'1'));
    let is_joined = [" OR ", " AND ", "<", ">", "==", "NOT "].iter().any(|part| call.contains(part));
    name == "wait" || is_bits || is_joined
}

fn is_comparison(token: Option<Tok<'_>>) -> bool {
    matches!(token, Some(Tok::Equal | Tok::Less | Tok::LessOrEqual | Tok::Greater | Tok::GreaterOrEqual))
}

/// Reports a parenthesis that touches a name although it does not contain arguments of the name.
pub(super) fn touching_parenthesis(site: &Site<'_, '_>) -> Option<Diagnostic> {
    (site.found() == Some(Tok::TouchParen)).then(|| touches(site, site.at))
}

/// Reports an element in parentheses that touch the name before them.
pub(super) fn element_touches(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let element = matches!(site.found(), Some(Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::Frame));
    let opener = site.opener().filter(|_| element && site.opener_kind() == Some(Tok::TouchParen))?;
    Some(touches(site, opener))
}

fn touches(site: &Site<'_, '_>, at: usize) -> Diagnostic {
    site.about(at, "this `(` touches the name before it", "read as the arguments of that name").fix(
        "put a space before it, if it is something else",
        site.before_token(at),
        " ",
    )
}
