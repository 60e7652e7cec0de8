//! Reports mistakes in conditions: operators without an operand, and text that is not a condition.

use crate::diagnostic::Diagnostic;
use crate::syntax::site::Site;
use crate::syntax::token::Tok;

/// Reports text that is not a condition, where a condition is expected.
pub(super) fn condition(site: &Site<'_, '_>) -> Option<Diagnostic> {
    if !site.expects_condition() {
        return not_joined(site);
    }
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens are reported as they are")]
    match (site.before(1)?, site.found()?) {
        (Tok::LParen | Tok::ConditionParen, Tok::RParen) => Some(
            site.about(site.at, "this condition is empty", "an interrupt is missing before this")
                .help("write an interrupt, such as `(bumper)`, or `(null)` for one that never fires"),
        ),
        (before @ (Tok::Or | Tok::And | Tok::Not | Tok::Rising), found) => {
            let operator = operator(before);
            let message = format!("expected a condition after `{operator}`, found {}", site.found_words());
            let diagnostic = site.about(site.at, message, "expected an interrupt, such as `bumper`");
            Some(match found {
                Tok::Not | Tok::Rising => {
                    diagnostic.help(format!("put it in parentheses: `{operator} ({} bumper)`", self::operator(found)))
                }
                Tok::RParen if matches!(before, Tok::Or | Tok::And) => diagnostic.fix(
                    &format!("write a second condition after it, or remove `{operator}`"),
                    site.span(site.at - 1, site.at - 1),
                    "",
                ),
                Tok::RParen => diagnostic.help(format!("it is written before a condition: `{operator} bumper`")),
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
        (Tok::Comma, Tok::RParen) => Some(
            site.about(site.at, "expected a condition after `,`, found `)`".to_owned(), "a condition is missing")
                .help("say when it ends, as in `(turn(90), bumper)` and `(turn(90), null)`, or remove the comma"),
        ),
        (_, Tok::Number(_)) if turned(site).is_some() => turned(site),
        (_, Tok::Number(_)) => Some(
            site.about(site.at, format!("expected a condition, found {}", site.found_words()), "not a condition")
                .help("a comparison begins with its signal: `(r 3 < 0.5m)`; a time is waited for: `(wait 5)`"),
        ),
        _ => None,
    }
}

/// Reports a comparison in which the signal is not first, such as `1m > r0` and `0.5 < r0 < 1`.
fn turned(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let (number, signal) = (site.text(site.at, site.at)?, site.at + 2);
    #[allow(clippy::wildcard_enum_match_arm, reason = "all other tokens do not compare")]
    let opposite = match site.kind(site.at + 1)? {
        Tok::Less => ">",
        Tok::LessOrEqual => ">=",
        Tok::Greater => "<",
        Tok::GreaterOrEqual => "<=",
        Tok::Equal => "==",
        _ => return None,
    };
    let last = match site.kind(signal + 1) {
        Some(Tok::Number(_)) => signal + 1,
        Some(Tok::TouchParen) => site.end_of_group(signal + 1),
        _ => signal,
    };
    site.name_at(signal)?;
    let name = site.text(signal, last)?;
    let first = format!("{name} {opposite} {number}");
    let is_comparison = matches!(
        site.kind(last + 1),
        Some(Tok::Less | Tok::LessOrEqual | Tok::Greater | Tok::GreaterOrEqual | Tok::Equal)
    );
    let (end, replacement) = match site.kind(last + 2) {
        Some(Tok::Number(_)) if is_comparison => {
            (last + 2, format!("{first} AND {name} {}", site.text(last + 1, last + 2)?))
        }
        _ => (last, first),
    };
    let diagnostic = site.about(site.at, "a comparison begins with its signal", "not expected here");
    Some(diagnostic.fix("write {}", site.span(site.at, end), replacement))
}

/// Reports two conditions without an operator between them, such as `(r0 < 50cm wait 5s)`.
fn not_joined(site: &Site<'_, '_>) -> Option<Diagnostic> {
    let next = site.name_at(site.at).filter(|_| site.expects("OR") && site.expects("AND"))?;
    let is_compared =
        matches!(site.before(2)?, Tok::Equal | Tok::Less | Tok::LessOrEqual | Tok::Greater | Tok::GreaterOrEqual);
    is_compared.then(|| {
        let message = format!("nothing joins `{next}` to the condition before it");
        let diagnostic = site.about(site.at, message, "a second condition");
        diagnostic.fix("if one of them is enough, write {} before it", site.before_token(site.at), "OR ").fix(
            "if both are needed, {}",
            site.before_token(site.at),
            "AND ",
        )
    })
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
