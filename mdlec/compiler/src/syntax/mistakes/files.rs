//! Reports mistakes between plans: elements outside of plans, names before the brace of their plan, and mistakes in
//! `use`.

use super::plan_names::{name_before_plan, not_a_label};
use super::strings;
use crate::diagnostic::Diagnostic;
use crate::syntax::foreign;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports an element, a name or a file name without quotes that is outside of all plans.
pub(super) fn at_file_level(site: &Site<'_, '_>) -> Option<Diagnostic> {
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
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are reported as they are")]
    match site.found()? {
        Tok::Str(_) | Tok::Comma | Tok::Name("as") if site.before(2) == Some(Tok::Use) => after_used_file(site),
        Tok::LParen if plan_in_parentheses(site).is_some() => plan_in_parentheses(site),
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
        Tok::Comma => Some(site.about(site.at, "plans are not separated by commas", "not expected here").fix(
            "remove it",
            site.span(site.at, site.at),
            "",
        )),
        Tok::LParen if strings::string(site).is_some() => strings::string(site),
        Tok::SigmaNull => Some(strings::mark(site)),
        Tok::LParen | Tok::ExecPlan | Tok::Name(_) | Tok::Frame => Some(
            site.about(site.at, format!("expected a plan, found {}", site.found_words()), "outside of any plan").help(
                "a file consists of plans, and a plan has braces around its atoms: `{ Name (Atom (bumper) stop) }`",
            ),
        ),
        _ => None,
    }
}

/// Reports more than one file after `use`, as in `use "a.mdle" "b.mdle"`, or another name for the file, as in `use
/// "a.mdle" as a`.
fn after_used_file(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let first = if site.found() == Some(Tok::Comma) { site.at + 1 } else { site.at };
    if let Some(Tok::Str(_)) = site.kind(first) {
        let diagnostic = site.about(site.at, "each file has a `use` of its own", "not expected here");
        let file = site.text(first, first)?;
        return Some(diagnostic.fix("write {}", site.span(site.at, first), format!("use {file}")));
    }
    let diagnostic = site.about(site.at, "a file that is used has no other name", "not expected here");
    let words = "remove this; its plans are called by their names alone";
    let last = if site.name_at(site.at + 1).is_some() { site.at + 1 } else { site.at };
    (first == site.at).then(|| diagnostic.fix(words, site.span(site.at, last), ""))
}

/// Reports a plan in parentheses instead of braces, as in `( Tour (bumper) …`.
fn plan_in_parentheses(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let name = site.name_at(site.at + 1).filter(|_| site.kind(site.at + 2) == Some(Tok::LParen))?;
    let diagnostic = site.about(site.at, format!("the plan `{name}` begins with `(`"), "expected a `{`");
    Some(diagnostic.help(format!("a plan has braces: `{{ {name} … }}`")))
}
