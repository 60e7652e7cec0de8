//! The usual mistakes, each with a message of its own and something to type instead.

mod atoms;
mod calls;
mod conditions;

use super::errors::Site;
use super::foreign;
use super::token::{Tok, split};
use crate::alphabet::Kind;
use crate::diagnostic::Diagnostic;
use atoms::{atom_condition, atom_law};
use calls::{apart, bare_call, decimal_comma, element_touches, square_brackets, touching_parenthesis, unit_apart};
use conditions::condition;

/// The message about a mistake that is known; the first that fits.
pub(super) fn known(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let mistakes: [fn(&Site<'_, '_>) -> Option<Diagnostic>; 19] = [
        square_brackets,
        decimal_comma,
        at_file_level,
        element_touches,
        plan_name,
        label_and_equals,
        atom_condition,
        comma,
        atom_law,
        loop_count,
        power,
        label_behind,
        keyword_argument,
        unit_apart,
        apart,
        condition,
        parameters,
        bare_call,
        touching_parenthesis,
    ];
    let known = mistakes.iter().find_map(|mistake| mistake(site))?;
    Some(match spelling(site) {
        Some((at, keyword)) => known.fix("the keyword is {}", site.span(at, at), keyword),
        None => known,
    })
}

/// Between plans: no element, no name, no file without quotes.
fn at_file_level(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.before(1) == Some(Tok::Use) {
        let diagnostic = site.about(
            site.at,
            format!("`use` needs the name of a file, found {}", site.found_words()),
            "expected a text in quotes",
        );
        return Some(diagnostic.help("the name of a file is written between double quotes: `use \"corridors.mdle\"`"));
    }
    if !site.expects("use") {
        return None;
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are told as they are")]
    match site.found()? {
        Tok::Name(_) if site.kind(site.at + 1) == Some(Tok::LBrace) => Some(name_before_plan(site, site.at)),
        Tok::Name(name) if site.kind(site.at + 1) == Some(Tok::Assign) => Some(not_a_label(site, site.at, name)),
        Tok::Name(name) if site.kind(site.at + 1) == Some(Tok::Colon) => {
            Some(site.about(site.at, format!("the label `{name}` is outside of any plan"), "not expected here").fix(
                "remove it: a label names an element of a plan; a plan's own name is the first thing inside its braces",
                site.span(site.at, site.at + 1),
                "",
            ))
        }
        Tok::Name(keyword @ ("plan" | "Plan" | "behavior" | "Behavior"))
            if site.name_at(site.at + 1).is_some() && site.brace_after_group(site.at + 1).is_some() =>
        {
            let (brace, name) = (site.brace_after_group(site.at + 1)?, site.name_at(site.at + 1)?);
            let group = site.text(site.at + 2, brace - 1).unwrap_or("(…)");
            let message = format!("a plan begins with its brace, without `{keyword}`");
            let header = format!("{{ {name} {group}");
            let diagnostic = site.about(site.at, message, "not expected here");
            Some(diagnostic.fix("its name is the first thing inside: {} …", site.span(site.at, brace), header))
        }
        Tok::Name(name) if foreign::advice(name).is_some() => Some(
            site.about(site.at, format!("MDLe has no `{name}`"), "not expected here")
                .help(foreign::advice(name).unwrap_or_default()),
        ),
        Tok::Name(name)
            if matches!(site.kind(site.at + 1), Some(Tok::Name(_))) && site.kind(site.at + 2) == Some(Tok::LBrace) =>
        {
            let inner = site.name_at(site.at + 1).unwrap_or(name);
            let diagnostic =
                site.about(site.at, format!("expected a plan, found the name `{name}`"), "not expected here");
            Some(diagnostic.fix(
                "a plan begins with its brace: {} …",
                site.span(site.at, site.at + 2),
                format!("{{ {inner}"),
            ))
        }
        Tok::Name(name) if site.brace_after_group(site.at).is_some() => {
            let brace = site.brace_after_group(site.at)?;
            let condition = site.text(site.at + 1, brace.checked_sub(1)?).unwrap_or("(…)");
            let message = format!("the name `{name}` is before the brace of its plan");
            let words = format!("the brace comes first: `{{ {name} {condition} … }}`");
            Some(site.about(site.at, message, "put it inside the braces").fix(
                &words,
                site.span(site.at, brace),
                format!("{{ {name} {condition}"),
            ))
        }
        Tok::LParen | Tok::ExecPlan | Tok::Name(_) | Tok::Frame => Some(
            site.about(site.at, format!("expected a plan, found {}", site.found_words()), "outside of any plan").help(
                "a file consists of plans, and a plan has braces around its atoms: `{ Name (Atom (bumper) stop) }`",
            ),
        ),
        _ => None,
    }
}

fn name_before_plan(site: &Site<'_, '_>, at: usize) -> Diagnostic {
    let name = site.name_at(at).unwrap_or("Name");
    let words = format!("the name of a plan is the first thing inside: `{{ {name} … }}`");
    site.about(at, format!("the name `{name}` is before the brace of its plan"), "put it inside the braces").fix(
        &words,
        site.span(at, at + 1),
        format!("{{ {name}"),
    )
}

/// A plan whose name is missing, or something that cannot be one.
fn plan_name(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let is_single = site.kind(site.at + 1) != Some(Tok::Colon);
    if site.found() == Some(Tok::Colon) && is_single && site.before(2) == Some(Tok::LBrace) && site.expects_element() {
        let after = if site.kind(site.at + 1) == Some(Tok::LParen) { site.at + 1 } else { site.at };
        let replacement = if after == site.at { "" } else { " (" };
        let diagnostic = site.about(site.at, "no colon follows the name of a plan", "not expected here");
        return Some(diagnostic.fix("remove it", site.span(site.at, after), replacement));
    }
    if !site.is_plan_without_name() {
        return None;
    }
    let brace = site.at - 1;
    // The name of the plan around is no name for this one.
    let is_own = brace < 2 || site.kind(brace - 2) != Some(Tok::LBrace);
    if let Some(name) = brace.checked_sub(1).filter(|_| is_own).and_then(|at| site.name_at(at)) {
        let is_loop = brace >= 3 && site.kind(brace - 3) == Some(Tok::ExecPlan);
        let diagnostic = site.about(
            brace,
            format!("this `{{` after `{name}` begins a plan without a name"),
            "a name is missing after it",
        );
        let words = format!("the name of a plan is the first thing inside: `{{ {name} … }}`");
        return Some(if is_loop {
            diagnostic.help("the body of an `ExecPlan` is a plan's name or braces, not both")
        } else {
            diagnostic.fix(&words, site.span(brace - 1, brace), format!("{{ {name}"))
        });
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens cannot be meant as a name")]
    match site.found() {
        Some(Tok::Number(_)) => Some(
            site.about(site.at, format!("expected the name of a plan, found {}", site.found_words()), "not a name")
                .help("a name begins with a letter; a loop is written `ExecPlan 3 { … }`"),
        ),
        Some(
            Tok::Module | Tok::Null | Tok::After | Tok::Use | Tok::Frame | Tok::Or | Tok::And | Tok::Not | Tok::Rising,
        ) => {
            let message = format!("{} is a keyword and cannot name a plan", site.found_words());
            Some(site.about(site.at, message, "not a name").help("choose another name"))
        }
        _ => {
            Some(site.about(brace, "this plan has no name", "a name is missing after this").help(
                "a plan begins with its name: `{ Name (bumper) … }`; elements without one are grouped by `( … )`",
            ))
        }
    }
}

/// `=` without a label, a label without `=`, and `=` for `==`.
fn label_and_equals(site: &Site<'_, '_>) -> Option<Diagnostic> {
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
        if let Some(argument) = named_argument(site) {
            return Some(argument);
        }
        let name = site.at.checked_sub(1).filter(|_| site.expects_element())?;
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

fn not_a_label(site: &Site<'_, '_>, at: usize, name: &str) -> Diagnostic {
    site.about(at, format!("`{name}` is not a label"), "the label of a plan begins with `Γ_` or `Gamma_`")
        .fix("write {}", site.span(at, at), format!("Gamma_{name}"))
        .fix(&format!("or remove `{name} =`: a plan's own name is inside its braces"), site.span(at, at + 1), "")
}

/// `{ Leg (far = length) …`
fn parameter_with_equals(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let name = site.name_at(site.at.checked_sub(1)?)?;
    let kind = site.name_at(site.at + 1).filter(|kind| Kind::NAMES.contains(kind))?;
    let is_header = site.opener()?.checked_sub(2).is_some_and(|brace| site.kind(brace) == Some(Tok::LBrace));
    let diagnostic = site.about(site.at, format!("`{name} =` is not a parameter"), "expected a colon");
    let words = "a parameter is its name, a colon and its type: {}";
    is_header.then(|| diagnostic.fix(words, site.span(site.at - 1, site.at + 1), format!("{name}: {kind}")))
}

/// `Leg(d = 3m)`, `Leg(d: 3m)`
fn named_argument(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let name = site.at.checked_sub(1)?;
    let text = site.name_at(name).filter(|_| site.opener_kind() == Some(Tok::TouchParen))?;
    let (opener, plan) = (site.opener()?, site.opener()?.checked_sub(1)?);
    let sign = if site.found() == Some(Tok::Colon) { ":" } else { " =" };
    let (words, before) = (format!("remove `{text}{sign}`"), site.text(plan, name - 1));
    let is_first = opener + 1 == name;
    let diagnostic = site.about(site.at, "arguments have no names: they are given in order", "not expected here");
    Some(match before.filter(|_| is_first) {
        // The call is upset as well.
        Some(before) => diagnostic.fix(&words, site.span(plan, site.at), before),
        None => diagnostic.fix(&words, site.span(name, site.at), ""),
    })
}

/// `ExecPlan { … }` and what else is not a loop.
fn loop_count(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.before(1) == Some(Tok::ExecPlan) {
        if let (Some(Tok::LParen), Some(Tok::Number(_) | Tok::Infinity), Some(Tok::RParen), Some(Tok::LBrace)) =
            (site.found(), site.kind(site.at + 1), site.kind(site.at + 2), site.kind(site.at + 3))
        {
            let count = site.text(site.at + 1, site.at + 1).unwrap_or("3");
            let diagnostic = site.about(site.at, "the count of a loop has no parentheses", "not expected here");
            let words = format!("write `ExecPlan {count} {{ … }}`");
            return Some(diagnostic.fix(&words, site.span(site.at - 1, site.at + 3), format!("ExecPlan {count} {{")));
        }
        let message = "this loop does not say how often";
        let diagnostic = site.about(site.at - 1, message, "a count is missing after this");
        return Some(diagnostic.help("write `ExecPlan 3 { … }`, or `ExecPlan inf { … }` for ever"));
    }
    if site.before(2) != Some(Tok::ExecPlan) {
        return None;
    }
    let diagnostic = site.about(
        site.at,
        format!("expected what is to be looped, found {}", site.found_words()),
        "expected `{` or a plan's name",
    );
    Some(match (site.before(1), site.found()) {
        (Some(Tok::Name(name)), Some(Tok::Number(count))) => {
            let replacement = format!("ExecPlan {} {name}", split(count).0);
            diagnostic.fix("the count comes first: {}", site.span(site.at - 2, site.at), replacement)
        }
        (Some(Tok::Name(name)), Some(Tok::Infinity)) => {
            let replacement = format!("ExecPlan inf {name}");
            diagnostic.fix("the count comes first: {}", site.span(site.at - 2, site.at), replacement)
        }
        (Some(Tok::Name(name)), _) => {
            let replacement = format!("ExecPlan 3 {name}");
            diagnostic.fix("the count comes first: {}", site.span(site.at - 2, site.at - 1), replacement)
        }
        (_, _) => diagnostic.help("the body of a loop is in braces, `ExecPlan 3 { … }`, or a plan, `ExecPlan 3 Name`"),
    })
}

/// `^` without a count, or after a condition.
fn power(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let behind = site.at.checked_sub(1).and_then(|closer| site.partner(closer));
    if site.found() == Some(Tok::Caret) && behind == Some(Tok::ConditionParen) {
        let message = "the parenthesis before this `^` is the condition of the plan";
        let diagnostic = site.about(site.at, message, "a condition has no power");
        let has_count = matches!(site.kind(site.at + 1), Some(Tok::Number(_) | Tok::Infinity | Tok::Name(_)));
        let insertion = site.opener_of(site.at - 1).filter(|_| has_count).map(|opener| site.before_token(opener));
        let words = "if it contains elements, put {} before it: `{ Name (null) (Other)^3 }`";
        return Some(match insertion {
            Some(span) => diagnostic.fix(words, span, "(null) "),
            None => diagnostic.help("a power follows an element: `(Atom (wait 5) stop)^3`"),
        });
    }
    (site.before(1) == Some(Tok::Caret)).then(|| {
        site.about(site.at, format!("expected a count after `^`, found {}", site.found_words()), "expected a count")
            .help("write `^3` for three times, `^inf` for ever")
    })
}

/// A label with nothing after it.
fn label_behind(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let label = site.at.checked_sub(2).and_then(|at| site.name_at(at))?;
    (site.before(1) == Some(Tok::Colon) && site.expects_element()).then(|| {
        site.about(site.at - 2, format!("nothing follows the label `{label}`"), "it names what follows it")
            .help(format!("a label is written before its element: `{label}: (Atom (bumper) stop)`"))
    })
}

/// Reports a keyword without the argument that it needs.
fn keyword_argument(site: &Site<'_, '_>) -> Option<Diagnostic> {
    #[allow(clippy::wildcard_enum_match_arm, reason = "only keywords are looked at")]
    match site.before(1)? {
        Tok::Frame => Some(
            site.about(
                site.at,
                format!("expected an angle or `here` after `FRAME`, found {}", site.found_words()),
                "expected a number or `here`",
            )
            .help("write `FRAME 180deg Name`, or `FRAME here Name` for the heading at its entry"),
        ),
        Tok::After => Some(
            site.about(
                site.at,
                format!("expected a label after `after`, found {}", site.found_words()),
                "expected a name",
            )
            .help("`after` names an element: `s1: (Atom (bumper) stop) (Atom (after s1) stop)`"),
        ),
        Tok::SigmaNull => Some(
            site.about(site.at, format!("expected `}}`, found {}", site.found_words()), "after the end of the plan")
                .help("`sigma_null` is the last thing in a plan"),
        ),
        _ => None,
    }
}

/// Commas between elements.
fn comma(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let between = |at: usize| {
        site.about(at, "elements are not separated by commas", "not expected here").fix(
            "remove it: a space is enough",
            site.span(at, at),
            "",
        )
    };
    if site.found() == Some(Tok::Comma) && site.expects_element() {
        return Some(between(site.at));
    }
    let element = matches!(site.found(), Some(Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::Frame));
    if site.found() == Some(Tok::Comma)
        && let Some(found) = comma_in_atom(site)
    {
        return Some(found);
    }
    if element && site.expects_condition() {
        let back = (1..=2).find(|back| site.before(*back) == Some(Tok::Comma))?;
        return Some(between(site.at - back).help("a comma makes `(s, ξ)`: a scope and its condition"));
    }
    None
}

/// A comma in the condition of an atom, behind it, or in the parentheses of its law.
fn comma_in_atom(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (opener, span) = (site.opener()?, site.span(site.at, site.at));
    let before = opener.checked_sub(1)?;
    let diagnostic = |message: &str| site.about(site.at, message, "not expected here");
    let is_law = || {
        site.partner(before).is_some()
            && site.opener_of(opener).is_some_and(|atom| site.kind(atom + 1) == Some(Tok::Atom))
    };
    #[allow(clippy::wildcard_enum_match_arm, reason = "only parentheses of atoms are looked at")]
    match site.kind(before)? {
        Tok::Atom => Some(diagnostic("conditions are not separated by commas").fix(
            "if one of them is enough, write {}",
            span,
            " OR",
        )),
        Tok::RParen if is_law() => {
            let message = "a comma separates arguments only in parentheses that touch the name";
            let words = "remove the comma: arguments are separated by spaces, as in `go 5 0`";
            Some(
                diagnostic(message)
                    .fix(words, span, "")
                    .help("or write them in parentheses that touch the name: `go(5, 0)`"),
            )
        }
        _ if site.in_atom()
            && site.before(1) == Some(Tok::RParen)
            && site.partner(site.at - 1) == Some(Tok::LParen) =>
        {
            Some(diagnostic("no comma follows the condition of an atom").fix("remove it: a space is enough", span, ""))
        }
        _ => None,
    }
}

/// What is wrong with a list of parameters.
fn parameters(site: &Site<'_, '_>) -> Option<Diagnostic> {
    (site.opener_kind() == Some(Tok::ParamParen)).then(|| {
        let expected = if site.before(1) == Some(Tok::Comma) { "a parameter".to_owned() } else { site.expectation() };
        let message = format!("expected {expected}, found {}", site.found_words());
        site.about(site.at, message, "not expected here").help("parameters are written `(v: speed, t: time)`")
    })
}

/// A name here that is a keyword but for capitals, and that keyword.
fn spelling(site: &Site<'_, '_>) -> Option<(usize, &'static str)> {
    let places = [Some(site.at), site.at.checked_sub(1)].into_iter().flatten();
    let names = places.filter_map(|at| Some((at, site.name_at(at)?)));
    let keywords =
        ["Atom", "ExecPlan", "FRAME", "OR", "AND", "NOT", "RISING", "use", "null", "module", "after", "sigma_null"];
    let keyword = |name: &str| keywords.into_iter().find(|keyword| keyword.eq_ignore_ascii_case(name));
    names.into_iter().find_map(|(at, name)| Some((at, keyword(name)?)))
}
