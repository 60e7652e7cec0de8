//! Writes messages about common mistakes. Each message proposes a text to type instead.

mod atoms;
mod calls;
mod commas;
mod conditions;
mod files;
mod groups;
mod labels;
mod parameters;
mod plan_names;
mod ranges;
mod strings;

use super::number::split;
use super::site::Site;
use super::token::Tok;
use crate::diagnostic::Diagnostic;
use atoms::{atom_condition, atom_law};
use calls::{apart, bare_call, decimal_comma, element_touches, square_brackets, touching_parenthesis, unit_apart};
use conditions::condition;
use files::at_file_level;
use groups::head_of_group;
use labels::{label_and_equals, label_behind, label_in_quotes, label_of_after};
use parameters::parameters;
use ranges::range_of_time;

/// Returns the message about the first common mistake that is found at the site.
pub(super) fn known(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let mistakes: [fn(&Site<'_, '_>) -> Option<Diagnostic>; 23] = [
        head_of_group,
        square_brackets,
        commas::bits,
        decimal_comma,
        at_file_level,
        element_touches,
        plan_name,
        label_and_equals,
        atom_condition,
        range_of_time,
        comma,
        atom_law,
        loop_count,
        power,
        label_in_quotes,
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

/// Reports a plan that has no name, or has a text in place of its name that cannot be a name.
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
    // The name of the enclosing plan is not the name of this plan.
    let is_own = brace < 2 || site.kind(brace - 2) != Some(Tok::LBrace);
    if let Some(name) = brace.checked_sub(1).filter(|_| is_own).and_then(|at| site.name_at(at)) {
        let is_loop = brace >= 3 && site.kind(brace - 3) == Some(Tok::ExecPlan);
        let diagnostic = site.about(
            brace,
            format!("this `{{` after `{name}` begins a plan without a name"),
            "a name is missing after it",
        );
        let words = format!("the name of a plan is the first thing inside: `{{ {name} … }}`");
        if is_loop && matches!(name, "times" | "Times" | "TIMES" | "x" | "time" | "loops" | "passes") {
            let diagnostic =
                site.about(brace - 1, format!("no `{name}` follows the count of a loop"), "not expected here");
            return Some(diagnostic.fix("remove it", site.span(brace - 1, brace - 1), ""));
        }
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

/// Reports a loop without a count, such as `ExecPlan { … }`, and other malformed loops.
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
        let message = "this loop has no count";
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

/// Reports `^` without a count, or after a condition.
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

/// Reports a keyword without the argument that it needs.
fn keyword_argument(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.found() == Some(Tok::Colon) && site.before(2) == Some(Tok::After) && site.name_at(site.at - 1).is_some() {
        let diagnostic = site.about(site.at, "no colon follows the label of `after`", "not expected here");
        return Some(diagnostic.fix("remove it: a space is enough", site.span(site.at, site.at), ""));
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "only keywords are looked at")]
    match site.before(1)? {
        Tok::Frame => {
            let message = format!("expected an angle or `here` after `FRAME`, found {}", site.found_words());
            let diagnostic = site.about(site.at, message, "expected a number or `here`");
            let help = "write `FRAME 180deg Name`, or `FRAME here Name` for the heading at its entry";
            Some(match site.name_at(site.at) {
                Some(_) => diagnostic.help("the angle of a frame is a number, and cannot be a parameter").help(help),
                None => diagnostic.help(help),
            })
        }
        Tok::After if label_of_after(site).is_some() => label_of_after(site),
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

/// Reports a comma that is not between two elements.
fn comma(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if site.found() != Some(Tok::Comma) {
        return None;
    }
    if site.expects_element() {
        let diagnostic = site.about(site.at, "this comma is not between two elements", "not expected here");
        return Some(diagnostic.fix("remove it", site.span(site.at, site.at), ""));
    }
    comma_in_atom(site)
}

/// Reports a comma in an atom: inside its condition, after its condition, or in the parentheses of its law.
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
        Tok::Atom => {
            let diagnostic = diagnostic("conditions are not separated by commas");
            let joins = |kind| matches!(kind, None | Some(Tok::Or | Tok::And | Tok::Comma));
            let begins = |kind| matches!(kind, Some(Tok::LParen | Tok::TouchParen | Tok::Not | Tok::Rising));
            let (left, right) = (site.before(1), site.kind(site.at + 1));
            let is_between = !joins(left) && !begins(left) && !joins(right) && right != Some(Tok::RParen);
            let (words, text) =
                if is_between { ("if one of them is enough, write {}", " OR") } else { ("remove it", "") };
            Some(diagnostic.fix(words, span, text))
        }
        Tok::RParen if is_law() => {
            let message = "a comma separates arguments only in parentheses that touch the name";
            Some(commas::in_law(site, diagnostic(message)))
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

/// Returns the index of a name that equals a keyword except for upper and lower case, and the keyword.
fn spelling(site: &Site<'_, '_>) -> Option<(usize, &'static str)> {
    let places = [Some(site.at), site.at.checked_sub(1)].into_iter().flatten();
    let names = places.filter_map(|at| Some((at, site.name_at(at)?)));
    let keywords =
        ["Atom", "ExecPlan", "FRAME", "OR", "AND", "NOT", "RISING", "use", "null", "module", "after", "sigma_null"];
    let keyword = |name: &str| keywords.into_iter().find(|keyword| keyword.eq_ignore_ascii_case(name));
    names.into_iter().find_map(|(at, name)| Some((at, keyword(name)?)))
}
