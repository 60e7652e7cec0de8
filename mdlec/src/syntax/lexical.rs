//! What is said about text that is no token: unexpected characters, numbers that touch something, and what does not end.

use super::source::{Place, Source};
use crate::alphabet::Unit;
use crate::diagnostic::{Code, Diagnostic};

/// A run of characters that no token begins with.
pub(super) fn characters(source: Source<'_>, place: Place) -> Diagnostic {
    let found = source.slice(place);
    let (what, noun) = match found.chars().count() {
        1 => (shown(found), "character"),
        2..=12 => (shown(found), "text"),
        _ => (format!("{}…", shown(found.get(..found.char_indices().nth(8).map_or(0, |c| c.0)).unwrap_or(""))), "text"),
    };
    let diagnostic =
        Diagnostic::new(Code::E0101, format!("unexpected {noun} {what}"), source.span(place), "not part of MDLe");
    match characters_help(source, found, place) {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// What is usually meant by these characters.
fn characters_help(source: Source<'_>, found: &str, place: Place) -> Option<String> {
    let next = source.text.get(place.end..).and_then(|rest| rest.chars().next());
    Some(match found {
        "&&" | "&" => "write `AND`: `(Atom (bumper AND wait 5) stop)`".into(),
        "||" | "|" => "write `OR`: `(Atom (bumper OR wait 5) stop)`".into(),
        "!" if next == Some('=') => "write `NOT` before an equality: `NOT r 3 == r 5`".into(),
        "!" | "~" | "¬" => "write `NOT`: `(Atom (NOT bumper) stop)`".into(),
        "≠" => "write `NOT` before an equality: `NOT r 3 == r 5`".into(),
        "∧" => "write `AND`".into(),
        "∨" => "write `OR`".into(),
        "#" | "%" => "a comment begins with `//`".into(),
        "'" | "“" | "”" | "„" | "‘" | "’" | "`" => "text stands between plain double quotes: `\"path.txt\"`".into(),
        "−" | "–" | "—" => "the minus sign is a plain `-`".into(),
        "." if next.is_some_and(|c| c.is_ascii_digit()) => {
            let digits: String = source.text.get(place.end..)?.chars().take_while(char::is_ascii_digit).take(12).collect();
            format!("a number has digits on both sides of its dot: `0.{digits}`")
        }
        "-" | "+" => "a sign touches its number: `-5`".into(),
        "°" => "write `deg`, touching the number: `90deg`".into(),
        "/" => "a unit is written out and touches its number: `20cm/s`".into(),
        "\\" => "of typesetting only `\\\\`, `\\{`, `\\}`, `\\text{…}`, `\\infty`, `\\leq`, `\\geq`, `\\Gamma_{…}` and `\\sigma_{null}` are read".into(),
        _ => return None,
    })
}

/// A typesetting command that means nothing in a plan.
pub(super) fn command(source: Source<'_>, place: Place) -> Diagnostic {
    let found = source.slice(place);
    let diagnostic = Diagnostic::new(
        Code::E0101,
        format!("`{found}` has no meaning in a plan"),
        source.span(place),
        "unknown command",
    );
    let name = found.trim_start_matches('\\').to_lowercase();
    diagnostic.help(match name.as_str() {
        "gamma" => "a label is written `\\Gamma_{from}^{to}` or `Γ_from^to`",
        "sigma" => "the end of a plan is written `\\sigma_{null}` or `σ_null`",
        "le" | "leqslant" => "write `\\leq` or `<=`",
        "ge" | "geqslant" => "write `\\geq` or `>=`",
        "wedge" | "land" => "write `AND`",
        "vee" | "lor" => "write `OR`",
        "neg" | "lnot" => "write `NOT`",
        "inf" | "infinity" => "write `\\infty` or `inf`",
        _ => "of typesetting only `\\\\`, `\\{`, `\\}`, `\\text{…}`, `\\infty`, `\\leq`, `\\geq`, `\\Gamma_{…}` and `\\sigma_{null}` are read",
    })
}

/// A block comment that does not end.
pub(super) fn comment(source: Source<'_>, place: Place) -> Diagnostic {
    let opener = Place::new(place.start, place.start + 2);
    Diagnostic::new(Code::E0105, "this comment does not end", source.span(opener), "begins here")
        .help("end it with `*/`, or write `//` for a comment that ends with its line")
}

/// A string that does not end on its line.
pub(super) fn string(source: Source<'_>, place: Place) -> Diagnostic {
    let opener = Place::new(place.start, place.start + 1);
    Diagnostic::new(Code::E0105, "this text does not end on its line", source.span(opener), "begins here")
        .help("end it with `\"`")
}

/// A `\text{` whose brace does not close.
pub(super) fn text(source: Source<'_>, place: Place) -> Diagnostic {
    Diagnostic::new(Code::E0103, "this `\\text{` is never closed", source.span(place), "opened here")
        .help("close it with `}`; no braces stand inside")
}

/// A number that touches something other than a unit.
pub(super) fn number(source: Source<'_>, number: &str, tail: &str, place: Place) -> Diagnostic {
    let unit = tail.trim_start();
    let span = source.span(Place::new(place.end - unit.len(), place.end));
    if unit.len() < tail.len() {
        let message = format!("the unit `{unit}` does not touch its number");
        return Diagnostic::new(Code::E0104, message, span, "a blank too many before this")
            .help(format!("write `{number}{unit}`"));
    }
    if tail.starts_with('.') {
        return dot(number, tail, span);
    }
    if tail.starts_with(['+', '-']) {
        let message = format!("`{tail}` touches the number before it");
        return Diagnostic::new(Code::E0104, message, span, "nothing is computed here")
            .help(format!("for two numbers put a blank between them: `{number} {tail}`"));
    }
    let near = nearest_unit(tail);
    let shown = if tail.len() > 40 { "…" } else { tail };
    let message = format!("`{shown}` is not a unit");
    let mut diagnostic = Diagnostic::new(Code::E0104, message, span, format!("touches the number `{number}`"));
    if let Some(unit) = near {
        diagnostic = diagnostic.help(format!("the nearest unit is `{unit}`: `{number}{unit}`"));
    }
    if !tail.contains(['/', '.', '+', '-', '°']) {
        diagnostic = diagnostic.help(format!("if it is a name, put a blank before it: `{number} {shown}`"));
    }
    if near.is_none() {
        diagnostic = diagnostic.help(format!("the units are {}", units()));
    }
    diagnostic
}

/// A number with a dot too many, or without digits behind it.
fn dot(number: &str, tail: &str, span: crate::diagnostic::Span) -> Diagnostic {
    let diagnostic =
        Diagnostic::new(Code::E0104, format!("`{number}{tail}` is not a number"), span, "not part of a number");
    match tail.trim_start_matches('.') {
        "" => diagnostic.help(format!("a number has digits on both sides of its dot: `{number}.0`")),
        rest if Unit::from_name(rest).is_some() && !number.contains('.') => {
            diagnostic.help(format!("a number has digits on both sides of its dot: `{number}.0{rest}`"))
        }
        _ => diagnostic.help("a number has one dot at most, with digits on both sides: `0.36`"),
    }
}

/// The unit that was probably meant.
pub(super) fn nearest_unit(written: &str) -> Option<&'static str> {
    let spelled = match written.to_lowercase().as_str() {
        "°" | "degree" | "degrees" => Some("deg"),
        "radian" | "radians" => Some("rad"),
        "sec" | "secs" | "second" | "seconds" => Some("s"),
        "msec" | "millisecond" | "milliseconds" => Some("ms"),
        "minute" | "minutes" | "mins" => Some("min"),
        "hour" | "hours" | "hr" => Some("h"),
        "meter" | "meters" | "metre" | "metres" => Some("m"),
        "inch" | "inches" => Some("in"),
        "foot" | "feet" => Some("ft"),
        "volt" | "volts" => Some("V"),
        "hertz" => Some("Hz"),
        "mps" => Some("m/s"),
        _ => None,
    };
    spelled.or_else(|| {
        if written.len() > 40 {
            return None;
        }
        let names = Unit::ALL.iter().map(|unit| unit.name);
        let near = names.map(|name| (distance(written, name), name)).min_by_key(|(distance, _)| *distance)?;
        (near.0 <= (written.chars().count() / 2).max(1)).then_some(near.1)
    })
}

/// How different they are; the case of a letter counts little.
fn distance(written: &str, name: &str) -> usize {
    if written.eq_ignore_ascii_case(name) { 0 } else { strsim::damerau_levenshtein(written, name) }
}

/// All units, for a sentence.
fn units() -> String {
    let names: Vec<String> = Unit::ALL.iter().map(|unit| format!("`{}`", unit.name)).collect();
    names.join(" ")
}

/// Characters in quotes, those that cannot be seen by their number.
fn shown(text: &str) -> String {
    let shown: String = text
        .chars()
        .map(|c| if c.is_control() || c.is_whitespace() { format!("U+{:04X}", u32::from(c)) } else { c.to_string() })
        .collect();
    format!("`{shown}`")
}
