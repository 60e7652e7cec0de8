//! Writes messages about arithmetic, which MDLe does not have. The messages contain the result of the calculation;
//! values in foreign units are converted to units of MDLe.

use super::number::split;
use super::source::{FileText, TextRange};
use crate::alphabet::Unit;
use crate::diagnostic::{Code, Diagnostic};

/// Units that MDLe does not have. Each entry contains the names of the unit, its size in a unit of MDLe, and the name
/// of this MDLe unit.
const FOREIGN: &[(&[&str], f64, &str)] = &[
    (&["km/h", "kmh", "kph", "kmph"], 1.0 / 3.6, "m/s"),
    (&["mph", "mi/h"], 0.447_04, "m/s"),
    (&["m/min"], 100.0 / 60.0, "cm/s"),
    (&["ft/s", "fps"], 0.304_8, "m/s"),
    (&["dm/s"], 10.0, "cm/s"),
    (&["km"], 1000.0, "m"),
    (&["dm"], 10.0, "cm"),
    (&["yd", "yards"], 0.914_4, "m"),
    (&["mi", "miles"], 1609.344, "m"),
    (&["rpm"], 6.0, "deg/s"),
    (&["turns", "turn", "rev"], 360.0, "deg"),
    (&["us", "µs", "μs"], 0.001, "ms"),
    (&["d", "day", "days"], 24.0, "h"),
    (&["mV", "mv"], 0.001, "V"),
    (&["kHz", "khz"], 1000.0, "Hz"),
];

/// Names of pi.
const PI: [&str; 4] = ["pi", "PI", "Pi", "π"];

/// Converts a number with a foreign unit to a number with a unit of MDLe; `None` if the unit is unknown.
pub(super) fn foreign_unit(number: &str, unit: &str) -> Option<String> {
    let (_, factor, ours) = FOREIGN.iter().find(|(names, _, _)| names.contains(&unit))?;
    Some(format!("{}{ours}", rounded(number.parse::<f64>().ok()? * factor)?))
}

/// Returns the result of an operation on two numbers; `None` if MDLe cannot express it. MDLe can express it if at most
/// one number has a unit, or if both numbers of a sum or difference have the same unit.
pub(super) fn computed(left: &str, operator: &str, right: &str) -> Option<String> {
    let ((left, left_unit), (right, right_unit)) = (split(left), split(right));
    let is_unit = |unit: &str| unit.is_empty() || Unit::from_name(unit).is_some();
    if !is_unit(left_unit) || !is_unit(right_unit) {
        return None;
    }
    let (a, b) = (left.parse::<f64>().ok()?, right.parse::<f64>().ok()?);
    let (value, unit) = match operator {
        "+" if left_unit == right_unit => (a + b, left_unit),
        "-" if left_unit == right_unit => (a - b, left_unit),
        "*" if right_unit.is_empty() => (a * b, left_unit),
        "*" if left_unit.is_empty() => (a * b, right_unit),
        "/" if right_unit.is_empty() => (a / b, left_unit),
        _ => return None,
    };
    Some(format!("{}{unit}", rounded(value)?))
}

/// Adds up a number with several units of one kind, such as `1h30min`. The result has the last of the units.
pub(super) fn sum_of_units(number: &str, tail: &str) -> Option<String> {
    let text = format!("{number}{tail}");
    let (mut rest, mut sum, mut last): (&str, f64, Option<Unit>) = (&text, 0.0, None);
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let (value, after) = rest.split_at(digits);
        let (name, after) = after.split_at(after.find(|c: char| c.is_ascii_digit()).unwrap_or(after.len()));
        let unit = Unit::from_name(name).filter(|unit| last.is_none_or(|last| last.kind == unit.kind))?;
        sum += unit.to_si(value.parse().ok()?);
        (rest, last) = (after, Some(unit));
    }
    let unit = last?;
    Some(format!("{}{}", rounded(sum / unit.to_si(1.0))?, unit.name))
}

/// Rounds a value to four decimals; returns `None` if a small value becomes zero, or if the value is 10⁹ or more.
fn rounded(value: f64) -> Option<String> {
    let rounded = (value * 1e4).round() / 1e4;
    (value.abs() < 1e9 && (rounded != 0.0 || value == 0.0)).then(|| rounded.to_string())
}

/// Returns the message about an arithmetic operator; `None` if `found` is not such an operator.
pub(super) fn arithmetic(source: FileText<'_>, found: &str, place: TextRange) -> Option<Diagnostic> {
    let operator = if matches!(found, "+" | "-" | "*" | "/" | "**") { found } else { return None };
    let before = source.text.get(..place.start)?.trim_end_matches([' ', '\t']);
    let after = source.text.get(place.end..)?.trim_start_matches([' ', '\t']);
    let report = |message: String| Diagnostic::new(Code::E0101, message, source.span(place), "MDLe has no arithmetic");
    if let Some(angle) = part_of_pi(source, place) {
        return Some(angle);
    }
    if operator.starts_with('*') && before.ends_with([')', '}']) {
        return Some(power(source, place, after));
    }
    if let Some(negative) = negative_name(source, operator, place) {
        return Some(negative);
    }
    let left = word(before);
    let left_start = before.len() - left.len();
    let right = after.get(..after.find(|c: char| !is_in_word(c)).unwrap_or(after.len()))?;
    let right_end = source.text.len() - after.len() + right.len();
    if left.is_empty() || !(right.starts_with(char::is_alphanumeric) || after.starts_with('(')) {
        return None;
    }
    let is_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit());
    if operator == "*" && is_number(left) && right.is_empty() {
        let message = format!("`{left} {operator}` does not repeat what follows");
        return Some(
            report(message).help(format!("the count follows what it repeats: `((Atom (wait 5) stop))^{left}`")),
        );
    }
    if !is_number(left) || !is_number(right) {
        // In `go 5 - 3` the operator is a sign; the meaning of `Dock / 2` is unknown.
        if let Some(name) = hyphenated(source, left, operator, right, place) {
            let whole = source.span(TextRange::new(left_start, right_end));
            let message = format!("`{left}-{right}` is not a name");
            let diagnostic = Diagnostic::new(Code::E0101, message, source.span(place), "not part of a name");
            return Some(diagnostic.fix("a name has letters, digits and `_`: {}", whole, name));
        }
        let is_sum = matches!(operator, "+" | "*") || !is_number(right);
        let message = format!("`{operator}` cannot be used here: nothing is computed in a plan");
        let help = match operator {
            "*" => "a comparison has one signal on each side, without a factor: `r0 < r4`",
            _ => "a comparison has one signal on each side: `r0 < 1m AND r1 < 1m`",
        };
        return is_sum.then(|| report(message).help(help));
    }
    let diagnostic = report(format!("`{left} {operator} {right}` is not computed"));
    let whole = source.span(TextRange::new(left_start, right_end));
    Some(match computed(left, operator, right) {
        Some(result) if matches!(operator, "+" | "-") => diagnostic.fix("write the result: {}", whole, result).fix(
            "or, for two numbers, let the sign touch its number: {}",
            whole,
            format!("{left} {operator}{right}"),
        ),
        Some(result) => diagnostic.fix("write the result: {}", whole, result),
        None => diagnostic.help("write the result as one number"),
    })
}

/// Reports a sign before a name, such as `-far`.
fn negative_name(source: FileText<'_>, operator: &str, place: TextRange) -> Option<Diagnostic> {
    let (before, after) = (source.text.get(..place.start)?, source.text.get(place.end..)?);
    let name = after.get(..after.find(|c: char| !is_in_word(c)).unwrap_or(after.len()))?;
    let follows = after.get(name.len()..)?.trim_start();
    let is_sign = operator == "-" && before.ends_with([' ', '(', ',']) && name.starts_with(char::is_alphabetic);
    // In a comparison, the operator is a difference of signals.
    (is_sign && !follows.starts_with(['<', '>', '=', '≤', '≥'])).then(|| {
        if is_pi(name) {
            let whole = source.span(TextRange::new(place.start, place.end + name.len()));
            let found = Diagnostic::new(Code::E0101, "there are no constants", whole, "not part of MDLe");
            return found.fix("for an angle write {}", whole, "-180deg");
        }
        let message = format!("`-` cannot be used here: `{name}` has no sign");
        Diagnostic::new(Code::E0101, message, source.span(place), "MDLe has no arithmetic")
            .help("give a parameter its negative value where the plan is used, as in `Leg(-90)`")
    })
}

/// Reports parts and multiples of pi, such as `pi/2`, `2*pi` and `pi*0.5`, and proposes the angles that they mean.
fn part_of_pi(source: FileText<'_>, place: TextRange) -> Option<Diagnostic> {
    if source.slice(place) == "-" {
        // The sign and the operator after `pi` have the same message, which is reported once.
        let after = source.text.get(place.end..)?;
        let rest = PI.iter().find_map(|name| after.strip_prefix(name))?.trim_start();
        let operator = source.text.len() - rest.len();
        let is_operator = rest.starts_with(['*', '/']);
        return is_operator.then(|| part_of_pi(source, TextRange::new(operator, operator + 1))).flatten();
    }
    let before = source.text.get(..place.start)?.trim_end_matches([' ', '\t']);
    let after = source.text.get(place.end..)?.trim_start_matches([' ', '\t']);
    let left = word(before);
    let right = after.get(..after.find(|c: char| !is_in_word(c)).unwrap_or(after.len()))?;
    let part = match source.slice(place) {
        "/" if is_pi(left) => 1.0 / right.parse::<f64>().ok()?,
        "*" if is_pi(left) => right.parse::<f64>().ok()?,
        "*" if is_pi(right) => left.parse::<f64>().ok()?,
        _ => return None,
    };
    let start = before.len() - left.len();
    let sign = if before.get(..start)?.ends_with('-') { "-" } else { "" };
    let whole = source.span(TextRange::new(start - sign.len(), source.text.len() - after.len() + right.len()));
    let angle = |factor: f64, unit: &str| Some(format!("{sign}{}{unit}", rounded(part * factor)?));
    let message = "nothing is computed in a plan, and there are no constants";
    let found = Diagnostic::new(Code::E0101, message, source.span(place), "MDLe has no arithmetic");
    let found = found.fix("for an angle write {}", whole, angle(180.0, "deg")?);
    Some(found.fix("or {}", whole, angle(std::f64::consts::PI, "rad")?))
}

fn is_pi(text: &str) -> bool {
    PI.contains(&text)
}

/// Returns a name without hyphens that can replace a plan's name with hyphens, such as `Return-Home`.
fn hyphenated(source: FileText<'_>, left: &str, operator: &str, right: &str, place: TextRange) -> Option<String> {
    let before = source.text.get(..place.start)?;
    let touches = before.ends_with(left) && source.text.get(place.end..)?.starts_with(right);
    let is_header = before.get(..before.len() - left.len())?.trim_end().ends_with('{');
    let is_name = |text: &str| text.starts_with(char::is_alphabetic) && !text.contains('.');
    (operator == "-" && touches && is_header && is_name(left) && is_name(right)).then(|| format!("{left}_{right}"))
}

/// Reports a multiplied string, such as `(…)*3`, which is not a loop in MDLe.
fn power(source: FileText<'_>, place: TextRange, after: &str) -> Diagnostic {
    let message = format!("`{}` does not repeat", source.slice(place));
    let diagnostic = Diagnostic::new(Code::E0101, message, source.span(place), "not part of MDLe");
    let (count, _) = split(after);
    if count.is_empty() || !count.bytes().all(|byte| byte.is_ascii_digit()) {
        return diagnostic.help("a count follows `^`: `((Atom (wait 5) stop))^3`");
    }
    let end = source.text.len() - after.len() + count.len();
    let span = source.span(TextRange::new(place.start, end));
    diagnostic.fix("to repeat what is before it, write {}", span, format!("^{count}"))
}

/// Returns the word at the end of a text.
pub(super) fn word(text: &str) -> &str {
    let start = text.char_indices().rev().take_while(|(_, c)| is_in_word(*c)).last().map_or(text.len(), |(at, _)| at);
    text.get(start..).unwrap_or("")
}

/// Returns `true` if a character can be part of a number or a name; `/` cannot, because `10/2` is two numbers.
fn is_in_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '.')
}
