//! The usual mistakes, each with a message of its own and something to type instead.

use super::errors::Site;
use super::token::{Tok, split};
use crate::alphabet::Unit;
use crate::diagnostic::Diagnostic;

/// The message about a mistake that is known; the first that fits.
pub(super) fn known(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let mistakes: [fn(&Site<'_, '_>) -> Option<Diagnostic>; 16] = [
        at_file_level,
        element_touches,
        plan_name,
        label_and_equals,
        atom_condition,
        atom_law,
        loop_count,
        power,
        label_behind,
        keyword_argument,
        unit_apart,
        comma,
        condition,
        parameters,
        bare_call,
        touching_parenthesis,
    ];
    let known = mistakes.iter().find_map(|mistake| mistake(site))?;
    Some(match spelling(site) {
        Some(keyword) => known.help(format!("the keyword is spelled `{keyword}`")),
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
        return Some(diagnostic.help("the name of the file stands in quotes: `use \"corridors.mdle\"`"));
    }
    if !site.expects("use") {
        return None;
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are told as they are")]
    match site.found()? {
        Tok::Name(_) if site.kind(site.at + 1) == Some(Tok::LBrace) => Some(name_before_plan(site, site.at)),
        Tok::Name(name) if site.kind(site.at + 1) == Some(Tok::Assign) => Some(not_a_label(site, site.at, name)),
        Tok::Name(name) if site.kind(site.at + 1) == Some(Tok::Colon) => Some(
            site.about(site.at, format!("the label `{name}` stands outside of any plan"), "not expected here")
                .help("a label names an element of a plan; a plan's own name is the first thing inside its braces"),
        ),
        Tok::LParen | Tok::ExecPlan | Tok::Name(_) | Tok::Frame => Some(
            site.about(site.at, format!("expected a plan, found {}", site.found_words()), "outside of any plan")
                .help("atoms, loops and names stand inside of a plan: `{ Name (Atom (bumper) stop) }`"),
        ),
        _ => None,
    }
}

fn name_before_plan(site: &Site<'_, '_>, at: usize) -> Diagnostic {
    let name = site.name_at(at).unwrap_or("Name");
    site.about(at, format!("the name `{name}` stands before its plan"), "put it inside the braces")
        .help(format!("the name of a plan is the first thing inside: `{{ {name} … }}`"))
}

/// A plan whose name is missing, or something that cannot be one.
fn plan_name(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if !site.is_plan_without_name() {
        return None;
    }
    let brace = site.at - 1;
    if let Some(name) = brace.checked_sub(1).and_then(|at| site.name_at(at)) {
        let is_loop = brace >= 3 && site.kind(brace - 3) == Some(Tok::ExecPlan);
        let diagnostic = site.about(
            brace,
            format!("this `{{` begins a plan without a name, behind `{name}`"),
            "a name is missing behind it",
        );
        return Some(if is_loop {
            diagnostic.help("the body of an `ExecPlan` is a plan's name or braces, not both")
        } else {
            diagnostic.help(format!("the name of a plan is the first thing inside: `{{ {name} … }}`"))
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
            Some(site.about(brace, "this plan has no name", "a name is missing behind this").help(
                "a plan begins with its name: `{ Name (bumper) … }`; elements without one are grouped by `( … )`",
            ))
        }
    }
}

/// `=` without a label, a label without `=`, and `=` for `==`.
fn label_and_equals(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.found() == Some(Tok::Assign) {
        if site.expects("==") {
            return Some(
                site.about(site.at, "`=` does not compare", "names a plan")
                    .help("values are compared by `==`: `(r 3 == r 5)`"),
            );
        }
        let name = site.at.checked_sub(1).filter(|_| site.expects_element())?;
        return site.name_at(name).map(|text| not_a_label(site, name, text));
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "only labels and what follows them is looked at")]
    match site.before(1)? {
        Tok::Label(label) => {
            let message = format!("expected `=` behind the label, found {}", site.found_words());
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
            site.about(site.at, format!("expected `{{` behind `=`, found {}", site.found_words()), "not expected here")
                .help("a label names a plan in braces: `Γ_from^to = { Name … }`"),
        ),
        _ => None,
    }
}

fn not_a_label(site: &Site<'_, '_>, at: usize, name: &str) -> Diagnostic {
    site.about(at, format!("`{name}` is not a label"), "the label of a plan begins with `Γ_` or `Gamma_`").help(
        format!(
            "write `Gamma_{name} = {{ … }}`, or leave out `{name} =`: the plan's own name stands inside its braces"
        ),
    )
}

/// `(Atom bumper stop)`: the condition of an atom without its parentheses.
fn atom_condition(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.before(1) != Some(Tok::Atom) {
        return None;
    }
    if site.found() == Some(Tok::RParen) {
        let diagnostic = site.about(site.at - 1, "this atom is empty", "a condition and a law are missing");
        return Some(diagnostic.help("an atom is a condition and a law: `(Atom (bumper) stop)`"));
    }
    if let (Some(label), Some(Tok::Colon)) = (site.name_at(site.at), site.kind(site.at + 1)) {
        let message = format!("the label `{label}` stands inside of its atom");
        let diagnostic = site.about(site.at, message, "not expected here");
        return Some(diagnostic.help(format!("a label stands before what it names: `{label}: (Atom …)`")));
    }
    let last = end_of_call(site, site.at);
    let diagnostic = site.about(site.at, "the condition of an atom stands in parentheses", "expected `(`");
    let Some(call) = site.name_at(site.at).and_then(|_| site.text(site.at, last)) else {
        return Some(diagnostic.help("an atom is a condition and a law: `(Atom (bumper) stop)`"));
    };
    let group = last + 1;
    if site.kind(group) == Some(Tok::LParen) {
        let end = site.end_of_group(group);
        if let (Some(text), Some(Tok::RParen)) = (site.text(group, end), site.kind(end + 1)) {
            let diagnostic = diagnostic.help(format!("write `(Atom ({call}) {text})`"));
            return Some(diagnostic.help(format!("or, if `{call}` is the law, put it last: `(Atom {text} {call})`")));
        }
    }
    Some(diagnostic.help(format!("write `(Atom ({call}) …)`")))
}

/// The last token of a name with numbers behind it.
fn end_of_call(site: &Site<'_, '_>, name: usize) -> usize {
    if site.kind(name + 1) == Some(Tok::TouchParen) {
        return site.end_of_group(name + 1);
    }
    let is_literal = |at: &usize| matches!(site.kind(*at), Some(Tok::Number(_) | Tok::Infinity | Tok::Str(_)));
    (name + 1..).take_while(is_literal).last().unwrap_or(name)
}

/// An atom without its law, or with something behind it.
fn atom_law(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if !site.in_atom() || site.before(1) == Some(Tok::Atom) {
        return None;
    }
    let atom = site.opener()? + 1;
    if site.found() == Some(Tok::RParen) {
        let diagnostic = site.about(site.at, "this atom has no law", "a law is missing before this");
        return Some(
            site.also(diagnostic, atom, "in this atom")
                .help("an atom is a condition and a law: `(Atom (bumper) stop)`"),
        );
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
        Tok::Caret => diagnostic.help("a power stands behind the atom's parenthesis: `(Atom (wait 5) stop)^3`"),
        Tok::Comma => diagnostic.help(
            "arguments are separated by blanks, `go 5 0`, or stand in parentheses that touch the name, `go(5, 0)`",
        ),
        _ => diagnostic.help("an atom is one condition and one law: `(Atom (bumper) stop)`"),
    })
}

/// `ExecPlan { … }` and what else is not a loop.
fn loop_count(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.before(1) == Some(Tok::ExecPlan) {
        let message = "this loop does not say how often";
        let diagnostic = site.about(site.at - 1, message, "a count is missing behind this");
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
            diagnostic.help(format!("the count comes first: `ExecPlan {} {name}`", split(count).0))
        }
        (Some(Tok::Name(name)), _) => {
            diagnostic.help(format!("`{name}` stands where the count is; the count comes first: `ExecPlan 3 {name}`"))
        }
        (_, _) => diagnostic.help("the body of a loop is in braces, `ExecPlan 3 { … }`, or a plan, `ExecPlan 3 Name`"),
    })
}

/// `^` without a count, or behind what is a condition.
fn power(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let behind = site.at.checked_sub(1).and_then(|closer| site.partner(closer));
    if site.found() == Some(Tok::Caret) && behind == Some(Tok::ConditionParen) {
        let message = "the parenthesis before this `^` is the condition of the plan";
        let diagnostic = site.about(site.at, message, "a condition has no power");
        return Some(diagnostic.help("if it holds elements, put `(null)` before it: `{ Name (null) (Other)^3 }`"));
    }
    (site.before(1) == Some(Tok::Caret)).then(|| {
        site.about(site.at, format!("expected a count behind `^`, found {}", site.found_words()), "expected a count")
            .help("write `^3` for three times, `^inf` for ever")
    })
}

/// A label with nothing behind it.
fn label_behind(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let label = site.at.checked_sub(2).and_then(|at| site.name_at(at))?;
    (site.before(1) == Some(Tok::Colon) && site.expects_element()).then(|| {
        site.about(site.at - 2, format!("nothing stands behind the label `{label}`"), "it names what follows it")
            .help(format!("a label stands before what it names: `{label}: (Atom (bumper) stop)`"))
    })
}

/// What some keywords need behind them.
fn keyword_argument(site: &Site<'_, '_>) -> Option<Diagnostic> {
    #[allow(clippy::wildcard_enum_match_arm, reason = "only keywords are looked at")]
    match site.before(1)? {
        Tok::Frame => Some(
            site.about(
                site.at,
                format!("expected an angle behind `FRAME`, found {}", site.found_words()),
                "expected a number",
            )
            .help("write `FRAME 180deg Name`"),
        ),
        Tok::After => Some(
            site.about(
                site.at,
                format!("expected a label behind `after`, found {}", site.found_words()),
                "expected a name",
            )
            .help("`after` names an element: `s1: (Atom (bumper) stop) (Atom (after s1) stop)`"),
        ),
        Tok::SigmaNull => Some(
            site.about(site.at, format!("expected `}}`, found {}", site.found_words()), "behind the end of the plan")
                .help("`sigma_null` is the last thing in a plan"),
        ),
        _ => None,
    }
}

/// `0.5 m`: a unit that does not touch its number.
fn unit_apart(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (Some(Tok::Name(name)), Some(Tok::Number(number))) = (site.found(), site.before(1)) else { return None };
    if !split(number).1.is_empty() {
        return None;
    }
    Unit::from_name(name)?;
    let diagnostic =
        site.about(site.at, format!("the unit `{name}` does not touch its number"), "a blank too many before this");
    Some(diagnostic.help(format!("write `{number}{name}`")))
}

/// Commas between elements.
fn comma(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let between = |at: usize| {
        site.about(at, "elements are not separated by commas", "not expected here")
            .help("leave it out: a blank is enough")
    };
    if site.found() == Some(Tok::Comma) && site.expects_element() {
        return Some(between(site.at));
    }
    let element = matches!(site.found(), Some(Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::Frame));
    if element && site.expects_condition() {
        let back = (1..=2).find(|back| site.before(*back) == Some(Tok::Comma))?;
        return Some(between(site.at - back).help("a comma makes `(s, ξ)`: a scope and its condition"));
    }
    None
}

/// Something else where a condition could stand.
fn condition(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if !site.expects_condition() {
        return None;
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are told as they are")]
    match (site.before(1)?, site.found()?) {
        (Tok::LParen | Tok::ConditionParen, Tok::RParen) => Some(
            site.about(site.at, "this condition is empty", "an interrupt is missing before this")
                .help("write an interrupt, such as `(bumper)`, or `(null)` for one that never fires"),
        ),
        (before @ (Tok::Or | Tok::And | Tok::Not | Tok::Rising), found) => {
            let operator = operator(before);
            let message = format!("expected a condition behind `{operator}`, found {}", site.found_words());
            let diagnostic = site.about(site.at, message, "expected an interrupt, such as `bumper`");
            Some(match found {
                Tok::Not | Tok::Rising => diagnostic
                    .help(format!("put it in parentheses: `{operator} ({} bumper)`", super::mistakes::operator(found))),
                _ => diagnostic,
            })
        }
        (_, Tok::Or | Tok::And) => Some(
            site.about(
                site.at,
                format!("expected a condition before {}", site.found_words()),
                "nothing to join before this",
            )
            .help("it joins two conditions: `(bumper OR wait 5)`"),
        ),
        (_, Tok::Number(_)) => Some(
            site.about(site.at, format!("expected a condition, found {}", site.found_words()), "not a condition")
                .help("a comparison begins with its signal: `(r 3 < 0.5m)`; a time is waited for: `(wait 5)`"),
        ),
        _ => None,
    }
}

fn operator(token: Tok<'_>) -> &'static str {
    #[allow(clippy::wildcard_enum_match_arm, reason = "called for operators only")]
    match token {
        Tok::Or => "OR",
        Tok::And => "AND",
        Tok::Rising => "RISING",
        _ => "NOT",
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

/// A quark where an element should be: `{ A go 5 0 }`, `((wait 5) stop)`.
fn bare_call(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let formal = site.expects(",") && site.expects_argument() && site.opener_kind() == Some(Tok::LParen);
    if formal {
        let name = site.opener()? + 1;
        let call = site.text(name, site.at.checked_sub(1)?).unwrap_or("this");
        let diagnostic =
            site.about(name, format!("`{call}` is not an element by itself"), "a quark outside of an atom");
        return Some(diagnostic.help(format!("an interrupt is the condition of an atom: `(Atom ({call}) stop)`")));
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
    let diagnostic =
        site.about(site.at, format!("`{name}` takes no arguments without parentheses here"), "not expected here");
    Some(if spelling(site).is_some() {
        diagnostic
    } else {
        let args = call.strip_prefix(name).unwrap_or("").trim();
        diagnostic
            .help(format!("a law runs in an atom: `(Atom (bumper) ({call}))`"))
            .help(format!("a plan's arguments stand in parentheses that touch its name: `{name}({args})`"))
    })
}

/// A parenthesis that touches a name but is not its arguments.
fn touching_parenthesis(site: &Site<'_, '_>) -> Option<Diagnostic> {
    (site.found() == Some(Tok::TouchParen)).then(|| touches(site, site.at))
}

/// An element in parentheses that touch a name.
fn element_touches(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let element = matches!(site.found(), Some(Tok::Atom | Tok::ExecPlan | Tok::LBrace | Tok::Frame));
    let opener = site.opener().filter(|_| element && site.opener_kind() == Some(Tok::TouchParen))?;
    Some(touches(site, opener))
}

fn touches(site: &Site<'_, '_>, at: usize) -> Diagnostic {
    site.about(at, "this `(` touches the name before it", "read as the arguments of that name")
        .help("put a blank before it, if it is something else")
}

/// The keyword that a name here was meant to be.
fn spelling(site: &Site<'_, '_>) -> Option<&'static str> {
    let names = [Some(site.at), site.at.checked_sub(1)].into_iter().flatten().filter_map(|at| site.name_at(at));
    let keywords =
        ["Atom", "ExecPlan", "FRAME", "OR", "AND", "NOT", "RISING", "use", "null", "module", "after", "sigma_null"];
    names.into_iter().find_map(|name| keywords.into_iter().find(|keyword| keyword.eq_ignore_ascii_case(name)))
}
